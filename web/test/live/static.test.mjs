// The page of a static site: the session runs in a worker of the browser.
import assert from "node:assert/strict";
import { test } from "node:test";
import { giveLog, LOGS } from "../logs.mjs";
import { serveFolder, staticHome } from "../static.mjs";
import { beginCalibration, downloads, everyPage, finishCalibration, liveBench, PAGES } from "../suite.mjs";
import { bars, becomes, firstTrace, open, PAGE, recorded, twinOf, visit, without } from "../world.mjs";

const home = staticHome();

test("every page in both themes, readable by everybody", () => everyPage(home.browser, home.site.url));

test("the twin is on view without a click, and soon", async () => {
  const { page, context, faults } = await open(home.browser, home.site.url);
  await liveBench(page);
  await context.close();
  // another visit, whose time is only printed
  const again = await open(home.browser, home.site.url);
  console.log(`page to first picture: ${Math.round(await firstTrace(again.page))} ms`);
  assert.deepEqual([faults, again.faults], [[], []]);
  await again.context.close();
});

test("the policy is in force, and nothing comes from elsewhere", async () => {
  const hosts = new Set();
  const { page, context } = await open(home.browser, home.site.url, {
    prepare: (page) => page.on("request", (request) => hosts.add(new URL(request.url()).origin)),
  });
  for (const name of PAGES) await page.click(`nav a[href="#${name}"]`);
  // the script is an element of the page, because a script that page.evaluate runs bypasses the policy
  const refused = await page.evaluate(
    () =>
      new Promise((done) => {
        document.addEventListener("securitypolicyviolation", (event) => done(event.effectiveDirective));
        document.head.append(Object.assign(document.createElement("script"), { textContent: "window.bad = 1" }));
      }),
  );
  assert.equal(refused, "script-src-elem");
  assert.equal(await page.evaluate(() => window.bad), undefined);
  assert.deepEqual([...hosts], [new URL(home.site.url).origin]);
  await context.close();
});

test("nothing jumps while it is live", async (t) => {
  const { page } = await visit(t, home.browser, home.site.url);
  await liveBench(page);
  await page.evaluate(() => {
    window.shifts = 0;
    new PerformanceObserver((list) => {
      for (const entry of list.getEntries()) if (!entry.hadRecentInput) window.shifts += entry.value;
    }).observe({ type: "layout-shift", buffered: true });
  });
  const frames = await page.textContent(".tile.ledger .value");
  await page.waitForFunction(
    (before) => document.querySelector(".tile.ledger .value").textContent !== before,
    frames,
  );
  await page.waitForTimeout(2000);
  const shifts = await page.evaluate(() => window.shifts);
  console.log(`layout shift of the bench: ${shifts.toFixed(4)}`);
  assert.ok(shifts < 0.02, `layout shift ${shifts}`);
});

test("the twin is seen before the session has come, which goes on in its place", async () => {
  let come = () => {};
  const coming = new Promise((done) => (come = done));
  const slow = await serveFolder(PAGE, "/", async (name) => name === "zerorate_live_bg.wasm" && coming);
  const { page, context, faults } = await open(home.browser, slow.url);
  const samples = async () => Number((await page.textContent(".tile.ledger .value")).replace(/\D/g, ""));
  await becomes(page, ".tile.raw .value", /\d/);
  await becomes(page, ".tile.ledger .value", /\d.?\d{3}/);
  // the first module cannot answer requests, so the session must answer them later
  await page.getByLabel("max", { exact: true }).check();
  const before = await samples();
  assert.match(await page.textContent(".coefficients"), /angle random walk · not yet/);
  come();
  await becomes(page, ".coefficients", /angle random walk(?! · not yet)/);
  assert.ok((await samples()) > before);
  assert.deepEqual(faults, []);
  await context.close();
  slow.stop();
});

test("a whole calibration, over a reload and in two windows, and its files", async (t) => {
  const { page, context } = await visit(t, home.browser, home.site.url);
  await beginCalibration(page);
  await page.waitForSelector(".run .steps [data-state=done]");
  assert.deepEqual(await bars(page), []);
  await page.reload();
  await page.waitForSelector(".calibrate .run, .calibrate .result");
  const second = await open(home.browser, `${home.site.url}#calibrate`, { context });
  await second.page.waitForSelector(".calibrate .run, .calibrate .result");
  await finishCalibration(page);
  assert.deepEqual(await bars(page), []);
  await becomes(second.page, ".result button.primary", /^Applied$/);
  await downloads(page);
  await page.click('nav a[href="#bench"]');
  await becomes(page, ".tile.corrected .value", /\d/);
  await second.page.close();

  // the browser stores the calibration: a window without the session still has it
  await page.click('nav a[href="#device"]');
  await becomes(page, ".on-file", /T-1.*Applied/);
  const stored = await page.evaluate(() => JSON.parse(localStorage.getItem("zerorate.calibrations")));
  assert.equal(stored.calibrations.length, 1);
  assert.match(stored.calibrations[0], /T-1/);
  const other = await open(home.browser, home.site.url, {
    prepare: (page) =>
      page.addInitScript((stored) => {
        localStorage.setItem("zerorate.calibrations", JSON.stringify(stored));
      }, stored),
  });
  await becomes(other.page, ".tile.corrected .value", /\d/);
  await other.context.close();
});

test("a calibration that is dropped, one that is damaged, and a device of other keys", async (t) => {
  const { page } = await visit(t, home.browser, `${home.site.url}#device`);
  const toml =
    'schema = 1\npart = "ADIS16130"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n';
  const drop = async (name, text) => {
    const dataTransfer = await page.evaluateHandle(
      ([name, text]) => {
        const data = new DataTransfer();
        data.items.add(new File([text], name));
        return data;
      },
      [name, text],
    );
    await page.dispatchEvent('[aria-label="Calibrations on file"] .drop', "drop", { dataTransfer });
  };
  await drop("unit.toml", toml);
  await becomes(page, ".on-file", /PBC −0\.25/);
  await drop("broken.toml", toml.replace("schema = 1", "schema = "));
  await becomes(page, ".toast", /./);
  assert.equal(await page.locator(".on-file li").count(), 1);
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  await page.getByRole("button", { name: "Keep it" }).click();
  assert.equal(await page.locator(".on-file .row").count(), 1);
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  await page.getByRole("button", { name: "Remove it" }).click();
  await becomes(page, ".on-file", /None yet/);
  await page.waitForFunction(() => !localStorage.getItem("zerorate.calibrations").includes("pbc_dps"));
  await page.fill("#keys", "seed=3,bias_dps=2.5,noise=0");
  await page.getByRole("button", { name: "Open the twin" }).click();
  await becomes(page, ".device .name", /bias_dps=2\.5/);
  await page.click('nav a[href="#bench"]');
  await becomes(page, ".tile.raw .value", /^2\.\d/);
});

test("a recording that is dropped is played", { skip: without.program }, async (t) => {
  const path = recorded(`${home.folder}/twin.arrows`, "seed=7,bias_dps=1.5", "--duration", "2m");
  const { page } = await visit(t, home.browser, `${home.site.url}#device`);
  await page.setInputFiles('.openers input[type="file"]', path);
  await becomes(page, ".device .name", /twin\.arrows/);
  await page.getByLabel("max", { exact: true }).check();
  await becomes(page, "header .state", /ended/);
  await page.click('nav a[href="#bench"]');
  await becomes(page, ".tile.raw .value", /^1\.\d/);
});

test("a chamber by hand: a plan that is dropped and refused, and the profile of the facts", async (t) => {
  const prepare = twinOf("seed=5,profile=oven,hysteresis=0");
  const { page } = await visit(t, home.browser, `${home.site.url}#calibrate`, { prepare });
  await page.check('input[value="chamber"]');
  await becomes(page, ".plan-choice .twin", /profile=oven/);
  const plan = { name: "bad.toml", mimeType: "text/plain", buffer: Buffer.from("schema = 1\nsteps = 3\n") };
  await page.setInputFiles(".plan-choice input[type=file]", plan);
  await becomes(page, ".plan-file", /bad\.toml is taken/);
  await page.click(".choosing button.primary");
  await becomes(page, ".toast", /steps/);
  await page.check('input[value="f57"]');
  assert.deepEqual(await bars(page), []);
  await page.getByLabel("max", { exact: true }).check();
  await page.click(".choosing button.primary");
  await becomes(page, ".run .advice", /^Step 2 of 4: set the chamber to -40\.0 °C/);
  assert.equal(await page.$$eval(".run .steps li", (all) => all.length), 4);
  assert.match(await page.textContent(".run .steps [data-state=now] .time"), /min.* left|until it is settled/);
  assert.ok(await page.isHidden(".run .watch"));
  assert.deepEqual(await bars(page), []);
});

test("a set point that nobody sets: its step goes on when the time that it takes at least is over", async (t) => {
  const { page } = await visit(t, home.browser, `${home.site.url}#calibrate`);
  await page.check('input[value="chamber"]');
  await page.getByLabel("max", { exact: true }).check();
  await page.click(".choosing button.primary");
  await becomes(page, ".run .steps [data-state=now] .time", /until it is settled/);
  assert.equal(await page.getAttribute(".run .steps li", "data-state"), "now");
  assert.match(await page.textContent(".run .left"), /^at least /);
});

test("without shared workers the bench comes", async (t) => {
  const prepare = (page) => page.addInitScript(() => delete globalThis.SharedWorker);
  const { page } = await visit(t, home.browser, home.site.url, { prepare });
  await liveBench(page);
});

test("who leaves a calibration is asked by the browser, who ends it by the page, which goes on", async (t) => {
  const { page } = await visit(t, home.browser, `${home.site.url}#calibrate`);
  await becomes(page, ".before", /Keep this page open/);
  await page.click(".choosing button.primary");
  await page.waitForSelector(".calibrate .run");
  const [dialog] = await Promise.all([
    page.waitForEvent("dialog"),
    page.evaluate(() => void setTimeout(() => location.reload())),
  ]);
  assert.equal(dialog.type(), "beforeunload");
  await dialog.dismiss();
  await becomes(page, ".run .left", /left/);
  const more = [];
  page.on("dialog", (dialog) => {
    more.push(dialog.type());
    void dialog.accept();
  });
  await page.getByRole("button", { name: "Abort" }).click();
  await page.waitForSelector("dialog[open]");
  // the rest of the page is inert while the dialog is open
  assert.deepEqual(await bars(page, 5), []);
  const done = await page.textContent(".run .left");
  await page.waitForFunction((done) => document.querySelector(".run .left").textContent !== done, done);
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog", { state: "detached" });
  assert.ok(await page.$(".calibrate .run"));
  await page.getByRole("button", { name: "Abort" }).click();
  await page.getByRole("button", { name: "End it" }).click();
  await page.waitForSelector(".calibrate .ended");
  await page.reload();
  await page.waitForSelector("body[data-ready]");
  assert.deepEqual(more, []);
});

test("the tiles of the bench stand in full rows at every width", async (t) => {
  const { page } = await visit(t, home.browser, home.site.url);
  const widths = [[1920, [6]], [1280, [6]], [1180, [3, 3]], [768, [3, 3]], [390, [2, 2, 2]]];
  for (const [width, expected] of widths) {
    await page.setViewportSize({ width, height: 800 });
    const rows = await page.$$eval(".bench .tile", (all) => {
      const tops = all.map((tile) => tile.getBoundingClientRect().top);
      return [...new Set(tops)].map((top) => tops.filter((other) => other === top).length);
    });
    assert.deepEqual(rows, expected, `${width} px`);
    const cut = await page.$$eval(".bench .tile", (all) =>
      all.filter((tile) => tile.scrollWidth > tile.clientWidth).map((tile) => tile.textContent),
    );
    assert.deepEqual(cut, [], `${width} px`);
  }
});

test("charts by keyboard: hold, zoom, cursors, unit", async (t) => {
  const { page } = await visit(t, home.browser, home.site.url);
  await liveBench(page);
  await page.focus(".strips");
  await page.keyboard.press("Space");
  await becomes(page, ".hold", /Follow/);
  await page.keyboard.press("a");
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("b");
  await becomes(page, ".cursors", /A .*B .*B − A/);
  await page.keyboard.press("+");
  await page.keyboard.press("Escape");
  await becomes(page, ".hold", /Hold/);
  await page.getByLabel("°/h").check();
  await becomes(page, ".tile.raw .unit", /°\/h/);
  await becomes(page, ".strip.raw .name", /°\/h/);
  await page.keyboard.press("2");
  await page.waitForTimeout(100);
  await page.focus("main");
  await page.keyboard.press("2");
  await page.waitForSelector(".page.calibrate");
});

test("phone, forced colours, less motion", async () => {
  const phone = { viewport: { width: 360, height: 740 }, isMobile: true, deviceScaleFactor: 2 };
  for (const more of [phone, { forcedColors: "active" }, { reducedMotion: "reduce" }]) {
    const { page, context, faults } = await open(home.browser, home.site.url, { look: more });
    for (const name of PAGES) {
      await page.click(`nav a[href="#${name}"]`);
      await page.waitForSelector(`.page.${name}`);
      const over = await page.evaluate(
        () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
      );
      assert.equal(over, 0, `${name} is ${over} px too wide`);
      assert.deepEqual(await bars(page), [], name);
    }
    assert.deepEqual(faults, []);
    await context.close();
  }
});

test("from a subfolder, and offline after the first visit", async () => {
  const below = await serveFolder(PAGE, "/some/folder/");
  const { page, context } = await open(home.browser, below.url);
  await page.evaluate(() => navigator.serviceWorker.ready);
  assert.deepEqual(
    below.asked.filter((path) => !path.startsWith("/some/folder/")),
    [],
  );
  assert.ok(below.asked.some((path) => path.endsWith("live_bg.wasm")));
  const reader = below.asked.filter((path) => path.endsWith("log_bg.wasm"));
  assert.deepEqual(reader, [], "the reader of logs came with the first visit");
  await page.click('nav a[href="#log"]');
  await giveLog(page, "rest.csv", LOGS["rest.csv"].bytes());
  below.stop();
  const offline = await open(home.browser, below.url, { context });
  await liveBench(offline.page);
  await page.close();
  await offline.page.click('nav a[href="#log"]');
  assert.match(await giveLog(offline.page, "rest.csv", LOGS["rest.csv"].bytes()), /done/);
  await context.close();
});
