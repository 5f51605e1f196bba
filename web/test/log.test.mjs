// Logs in every form on the page: results, questions, and messages about damaged logs.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { fixture, giveLog, logIsDone, LOGS, SHORT, STATED, warming } from "./logs.mjs";
import { staticHome } from "./static.mjs";
import { bars, becomes, open, recorded, without } from "./world.mjs";

let page, context, faults;
const home = staticHome(async ({ browser, site }) => {
  ({ page, context, faults } = await open(browser, `${site.url}#log`));
});

const give = (name, buffer) => giveLog(page, name, buffer);

/** Checks that the page refuses a log, asks about it or warns of it, in words of the program. */
async function isSaid(name, bytes) {
  const said = await give(name, bytes);
  const warned = await page.locator(".log .warnings li, .log .doubt:not(:empty)").count();
  assert.ok(!/done/.test(said) || warned > 0, `${name}: ${said}`);
  assert.ok(said.length > 9 && !/RuntimeError|unreachable|panicked/.test(said), said);
}

async function answer(answers) {
  for (const [key, value] of Object.entries(answers)) await page.fill(`#log-${key}`, value);
  await page.click(".questions button.primary");
  await logIsDone(page);
  return page.textContent(".log .doing");
}

test("a log that warms: its bias over temperature, and the files", async () => {
  assert.match(await give("warming.csv", warming()), /done/);
  const card = page.locator(".log .bias");
  assert.match(await card.locator("pre").textContent(), /20\.0 to 50\.0 °C[^]*gyro_x_dps: bias/);
  assert.ok(await page.$eval(".bias img", (image) => image.decode().then(() => image.naturalWidth > 100)));
  const names = await card.locator(".downloads button").allTextContents();
  assert.deepEqual(names, ["bias-report.html", "bias-curve.csv", "calibration.toml", "ardupilot.param"]);
  assert.match(await card.locator(".note").textContent(), /^px4\.params: .*device_id/);
  const saving = page.waitForEvent("download");
  await card.getByText("calibration.toml").click();
  const text = readFileSync(await (await saving).path(), "utf8");
  assert.match(text, /method = "tempcal"[^]*warming\.csv/);
  assert.deepEqual(await bars(page), []);
  await give("rest.csv", LOGS["rest.csv"].bytes());
  assert.equal(await card.isVisible(), false);
});

for (const [name, { bytes, answers }] of Object.entries(LOGS)) {
  test(`${name}: its axes, coefficients, pictures`, async () => {
    let said = await give(name, bytes());
    if (answers) {
      assert.match(said, /does not say enough/);
      said = await answer(answers);
    }
    assert.match(said, /done/);
    assert.equal(await page.locator(".axes-of-log > section").count(), 3);
    const found = await page.$$eval(".axes-of-log .coefficients tbody tr:first-child", (rows) =>
      rows.map((row) => row.textContent),
    );
    // 0.1 °/s at 100 Hz is N = 0.01 °/√s, which is 0.6 °/√h
    for (const row of found) assert.match(row, /^N.*(0\.59|0\.6|0\.0099|0\.0100|0\.0101)/);
    assert.ok((await page.locator(".pictures img").count()) > 0);
    assert.ok(await page.$eval(".pictures img", (image) => image.decode().then(() => image.naturalWidth > 100)));
    assert.deepEqual(await bars(page), []);
    await page.setViewportSize({ width: 1440, height: 900 });
    const cut = await page.$$eval(".axes-of-log .card", (cards) =>
      cards.map((card) =>
        [card, ...card.querySelectorAll(".coefficients")].some((one) => one.scrollWidth > one.clientWidth),
      ),
    );
    await page.setViewportSize({ width: 1280, height: 900 });
    assert.deepEqual(cut, [false, false, false]);
  });

  test(`${name}, damaged and cut off: said, not hidden`, async () => {
    const damaged = bytes();
    damaged.fill(0x5a, Math.floor(damaged.length / 3), Math.floor(damaged.length / 2));
    await isSaid(name, damaged);
    // half of a text file is only a shorter text file, not a damaged one
    if (!name.endsWith(".csv")) await isSaid(name, bytes().subarray(0, Math.floor(damaged.length / 2)));
  });
}

test("of two logs the first is read, and named", async () => {
  const two = await page.evaluateHandle(() => {
    const transfer = new DataTransfer();
    for (const name of ["one.csv", "two.csv"]) transfer.items.add(new File(["gx_dps\n1\n2\n"], name));
    return transfer;
  });
  await page.dispatchEvent(".intake .drop", "drop", { dataTransfer: two });
  await page.getByText("One file at a time: one.csv.").waitFor();
  await logIsDone(page);
});

test("a picture opens large, and closes", async () => {
  await give("rest.csv", LOGS["rest.csv"].bytes());
  await page.click(".pictures .larger");
  assert.ok(await page.$eval(".large img", (image) => image.clientWidth > 1.5 * 600));
  assert.deepEqual(await bars(page, 5), []);
  await page.keyboard.press("Escape");
  await page.locator(".large").waitFor({ state: "detached" });
});

test("a file for a filter", async () => {
  await give("rest.csv", LOGS["rest.csv"].bytes());
  await page.check("#accept-rejected");
  const formats = { kalibr: /\ngyroscope_noise_density/, openvins: /\nimu0:.*\n {2}gyroscope_noise_density/ };
  for (const [format, text] of Object.entries(formats)) {
    await page.selectOption("#format", format);
    await page.click(".noise button.primary");
    await becomes(page, ".noise pre", text);
  }
  await give("short.csv", LOGS["rest.csv"].bytes().subarray(0, 20_000));
  await page.click(".noise button.primary");
  await becomes(page, ".noise pre", /# warning: short-record: gyro_x_dps: /);
});

for (const name of SHORT) {
  test(`${name} is recognised, and a broken one is told from it`, async () => {
    const said = await give(name, fixture(name));
    const words = `${said} ${await page.textContent(".log > .below")}`;
    assert.match(words, /samples|short|few|too|column|rate|topic/i);
    const broken = fixture(name);
    broken.fill(0x5a, Math.floor(broken.length / 3));
    assert.ok((await give(name, broken)).length > 20);
  });
}

/** N of a capture, °/√s, from differences of adjacent samples, in which white noise dominates. */
function walkOf(csv) {
  const lines = csv.split("\n").filter((line) => /^\d/.test(line));
  const rows = lines.map((line) => line.split(",").map(Number));
  // columns t_ns, edge_seq, rate_code; scale by F-40
  const squares = rows.slice(1).map(([, , code], k) => ((code - rows[k][2]) / 23_488) ** 2);
  const mean = squares.reduce((sum, one) => sum + one, 0) / squares.length;
  const between_s = (rows.at(-1)[0] - rows[0][0]) / 1e9 / squares.length;
  return Math.sqrt((mean / 2) * between_s);
}

test("captures of this program, whole and cut off", { skip: without.program }, async () => {
  const captured = (name) => readFileSync(recorded(`${home.folder}/${name}`, "seed=7", "--duration", "2m"));
  const csv = captured("twin.csv");
  const walk = walkOf(String(csv));
  for (const name of ["twin.csv", "twin.parquet", "twin.arrows"]) {
    const bytes = name === "twin.csv" ? csv : captured(name);
    assert.match(await give(name, bytes), /done/);
    const found = await page.textContent(".axes-of-log .coefficients tbody tr:first-child");
    const [, value] = /^N.*°\/√h([\d.]{5,}) \[[\d., ]+\] °\/√s.*identified/.exec(found) ?? assert.fail(found);
    assert.ok(Math.abs(Number(value) / walk - 1) < 0.03, `${name}: ${found}, and not ${walk}`);
    const said = await give(name, bytes.subarray(0, Math.floor(bytes.length / 2)));
    assert.ok(!/RuntimeError|unreachable/.test(said), said);
  }
});

test("a log is dropped, cancelled, and never leaves the machine", async () => {
  const before = home.site.asked.length;
  const dataTransfer = await page.evaluateHandle((head) => {
    const data = new DataTransfer();
    data.items.add(new File([`${head}\n`, "0,1,2,3\n".repeat(10_000_000)], "long.csv"));
    return data;
  }, STATED);
  await page.dispatchEvent(".log", "drop", { dataTransfer });
  await page.click(".log .work button");
  await becomes(page, ".log .doing", /Cancelled/);
  await give("rest.csv", LOGS["rest.csv"].bytes());
  assert.ok(
    home.site.asked.slice(before).every((path) => /\.(js|wasm)$/.test(path)),
    "something was asked of the server",
  );
  assert.match(await page.textContent(".intake"), /never leaves this machine/);
  assert.deepEqual(faults, []);
  await context.close();
});
