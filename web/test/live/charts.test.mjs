// The charts, compared with the truth of the twin or with the samples of a recording.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { staticHome } from "../static.mjs";
import { liveBench } from "../suite.mjs";
import { becomes, PATIENCE, recorded, twinOf, visit, without } from "../world.mjs";

const home = staticHome();

/** Value and half width of `a ± b`. */
function numbers(text) {
  const [, value, u] = /([−\d.]+) ± ([\d.]+)/.exec(text);
  return [Number(value.replace("−", "-")), Number(u)];
}

/** Number of pixels of a strip that have about the strip's colour. */
function drawn(page, strip) {
  return page.$eval(`.strip.${strip} canvas`, (canvas, name) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    const own = [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16));
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let found = 0;
    for (let k = 0; k < data.length; k += 4) {
      if (data[k + 3] > 60 && own.every((part, of) => Math.abs(part - data[k + of]) < 60)) found += 1;
    }
    return found;
  }, strip);
}

test("a part that is slower than the bins is on the strips", { skip: without.program }, async (t) => {
  // about 220 samples per second in bins of 1 ms: seven of nine bins are empty
  const path = recorded(`${home.folder}/slow.arrows`, "seed=7", "--duration", "2m");
  const { page } = await visit(t, home.browser, `${home.site.url}#device`);
  await page.setInputFiles('.openers input[type="file"]', path);
  await becomes(page, ".device .name", /slow\.arrows/);
  await page.click('nav a[href="#bench"]');
  await page.getByLabel("1 s", { exact: true }).check();
  await becomes(page, ".tile.raw .value", /\d/);
  await becomes(page, ".tile.ledger .below", /for ([2-9]|\d\d) s|min/);
  for (const strip of ["raw", "temp"]) assert.ok((await drawn(page, strip)) > 150, `${strip} is blank`);
});

test("the time on view, by choice and by the pointer", async (t) => {
  const { page } = await visit(t, home.browser, home.site.url);
  await liveBench(page);
  await page.click(".hold");
  const over = page.locator(".strip.raw .u-over");
  const { width, height } = await over.boundingBox();
  const at = (share) => ({ x: share * width, y: height / 2 });
  /** The displayed span, s, from cursors at a tenth and at nine tenths of the width. */
  const span = async () => {
    await over.click({ position: at(0.1) });
    await over.click({ position: at(0.9), modifiers: ["Shift"] });
    await becomes(page, ".cursors", /B − A: [\d.]+ s/);
    await page.waitForTimeout(100);
    const [, text] = /B − A: ([\d.]+) s/.exec(await page.textContent(".cursors"));
    return Number(text) / 0.8;
  };
  const spans = { "1 s": 1, "10 s": 10, "1 min": 60, "10 min": 600, "1 h": 3600 };
  for (const [words, seconds] of Object.entries(spans)) {
    await page.getByLabel(words, { exact: true }).check();
    assert.ok(Math.abs((await span()) / seconds - 1) < 0.02, words);
  }
  await page.getByLabel("10 s", { exact: true }).check();
  const box = await over.boundingBox();
  await page.mouse.move(box.x + 0.25 * width, box.y + height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.75 * width, box.y + height / 2, { steps: 4 });
  await page.mouse.up();
  const zoomed = await span();
  assert.ok(Math.abs(zoomed / 5 - 1) < 0.03, `a drag over half of 10 s leaves ${zoomed} s`);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, 100);
  await page.keyboard.up("Control");
  await page.waitForTimeout(100);
  assert.ok((await span()) > 1.1 * zoomed, "Ctrl and wheel zoom out");
});

test("marks of the spectrum, and when a coefficient will be identified", async (t) => {
  const { page } = await visit(t, home.browser, home.site.url, { prepare: twinOf("seed=7") });
  await page.getByLabel("max", { exact: true }).check();
  await becomes(page, ".marks", /bandwidth 300 Hz.*half of the sample rate, \d{4}/);
  const marks = await page.textContent(".marks");
  const [, folded, half] = /appears at ([\d.]+) Hz.*half of the sample rate, ([\d.]+) Hz/s.exec(marks);
  // 14.3 kHz (F-07) is between 2.5 and 3 times the sample rate (F-31), and aliases to 3 times the rate minus itself
  assert.ok(Math.abs(Number(folded) - (6 * Number(half) - 14_300)) < 0.5, marks);
  await becomes(page, ".coefficients", /N.*identified/);
  await becomes(page, ".coefficients tbody tr:nth-child(3)", /identified in \d+/);
});

test("the rate over temperature has the slope of the twin", async (t) => {
  const prepare = twinOf("seed=7,tempco_dps_per_c=0.08,curvature=0,hysteresis=0,flicker_hz=10");
  const { page } = await visit(t, home.browser, home.site.url, { prepare });
  await page.getByLabel("max", { exact: true }).check();
  await becomes(page, ".tile.ledger .below", /for ([2-9]|\d\d) min/);
  const scatter = page.locator("figure", { hasText: "Rate over temperature" });
  const [slope, u] = numbers(await scatter.locator(".note").textContent());
  assert.ok(u < 0.008 && Math.abs(slope - 0.08) < Math.max(2.5 * u, 0.004), `${slope} ± ${u}`);
  assert.match(await scatter.locator(".unseen").first().textContent(), /^Rate at \d+ temperatures/);
});

test("several axes: each has its own rate, by the switch", { skip: without.program }, async (t) => {
  const path = recorded(`${home.folder}/axes.csv`, "seed=7,axes=3", "--duration", "20s");
  const lines = readFileSync(path, "utf8").split(/\r?\n/).filter((line) => /^\d/.test(line));
  const rows = lines.map((line) => line.split(",").map(Number));
  const last = rows.filter(([t_ns]) => t_ns > rows.at(-1)[0] - 1e9);
  // columns t_ns, edge_seq and the codes; 1 °/s is 23 488 codes, and 0 °/s is 2²³ (F-40)
  const mean = (axis) => last.reduce((sum, row) => sum + row[axis], 0) / last.length;
  const truth = [2, 3, 4].map((axis) => (mean(axis) - 2 ** 23) / 23_488);
  const { page } = await visit(t, home.browser, `${home.site.url}#device`);
  await page.setInputFiles('.openers input[type="file"]', path);
  await becomes(page, ".device .name", /axes\.csv/);
  await page.getByLabel("max", { exact: true }).check();
  await becomes(page, "header .state", /ended/);
  await page.click('nav a[href="#bench"]');
  const choice = page.locator(".bench .axes label");
  await choice.nth(2).waitFor();
  assert.equal(await choice.count(), 3);
  for (const [axis, expected] of truth.entries()) {
    await choice.nth(axis).locator("input").check();
    await page.waitForFunction(
      ([expected]) => {
        const text = document.querySelector(".tile.raw .value").textContent.replace("−", "-");
        return Math.abs(Number(text) - expected) < 0.05;
      },
      [expected],
      { timeout: PATIENCE },
    );
  }
});

test("what was said stays where it stands, and is not read out again", async (t) => {
  const { page } = await visit(t, home.browser, `${home.site.url}#device`);
  const openWrong = async (keys) => {
    await page.click('nav a[href="#device"]');
    await page.fill("#keys", keys);
    await page.getByRole("button", { name: "Open the twin" }).click();
    await page.click('nav a[href="#bench"]');
  };
  await openWrong("no_such_key=1");
  await becomes(page, ".notices", /no_such_key/);
  await page.$eval(".notices li", (row) => {
    row.dataset.seen = "";
  });
  await openWrong("nor_this_one=1");
  await becomes(page, ".notices", /nor_this_one.*× 2/);
  assert.equal(await page.locator(".notices li[data-seen]").count(), 1);
});
