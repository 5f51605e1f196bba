// Tests that the page must pass both on a static site and from `zerorate serve`.
import assert from "node:assert/strict";
import { bars, becomes, firstTrace, open, PATIENCE } from "./world.mjs";

export const PAGES = ["bench", "calibrate", "log", "device"];

/** Selects the end of a guided calibration, with or without a result. */
const ENDED = ".calibrate .result, .calibrate .ended";

/** Opens all pages in both themes: each shows its content, is accessible, and violates no policy. */
export async function everyPage(browser, url) {
  for (const colorScheme of ["light", "dark"]) {
    const { page, context, faults } = await open(browser, url, { look: { colorScheme } });
    for (const name of PAGES) {
      await page.click(`nav a[href="#${name}"]`);
      await page.waitForSelector(`.page.${name}`);
      assert.equal(await page.getAttribute(`nav a[href="#${name}"]`, "aria-current"), "page");
      if (name === "bench") await becomes(page, ".tile.ledger .value", /\d{3}/);
      if (name === "device") await becomes(page, ".device .name", /ADIS16130/);
      assert.deepEqual(await bars(page), [], `${name}, ${colorScheme}`);
    }
    assert.deepEqual(faults, []);
    await context.close();
  }
}

export async function liveBench(page) {
  await becomes(page, ".tile.raw .value", /^−?\d+\.\d+$/);
  await becomes(page, ".tile.temp .value", /^2\d\.\d+$/);
  await becomes(page, ".coefficients", /angle random walk/);
  await firstTrace(page);
}

/** Begins a calibration that is short in the part's time, at the highest speed. */
export async function beginCalibration(page, method = "an1042", settle_s = 120) {
  await page.click('nav a[href="#calibrate"]');
  await page.getByLabel("max", { exact: true }).check();
  await page.check(`input[value="${method}"]`);
  await page.click(".settings summary");
  await page.fill("#serial", "T-1");
  await page.fill("#settle_s", String(settle_s));
  await page.fill("#offset_s", "60");
  await page.click(".choosing button.primary");
}

/** Waits for a result, which is on file, and applies it. */
export async function finishCalibration(page, timeout = 3 * PATIENCE) {
  await page.waitForSelector(ENDED, { timeout });
  const why = await page.$eval(".calibrate", (element) => element.textContent);
  assert.ok(await page.$(".calibrate .result"), why);
  const [pbc, btc] = await page.$$eval(".result .tile .value", (all) => all.map((one) => one.textContent));
  assert.match(pbc, /^−?\d\.\d+ ± \d\.\d+$/);
  assert.match(btc, /^−?0\.\d+ ± \d\.\d+$/);
  await page.click(".result button.primary");
  await becomes(page, ".result button.primary", /^Applied$/);
}

export async function downloads(page) {
  const forms = {
    TOML: /pbc_dps/,
    C: /#include|static/,
    Rust: /const/,
    CSV: /,/,
    JSON: /"pbc_dps"/,
    Report: /<html/i,
  };
  for (const [form, pattern] of Object.entries(forms)) {
    const [download] = await Promise.all([
      page.waitForEvent("download"),
      page
        .getByRole("button", { name: `Download as ${form}` })
        .first()
        .click(),
    ]);
    const stream = await download.createReadStream();
    let text = "";
    for await (const part of stream) text += part;
    assert.match(text, pattern, form);
  }
}
