// Guided calibrations, with and without a result.
import assert from "node:assert/strict";
import { test } from "node:test";
import { staticHome } from "../static.mjs";
import { beginCalibration, finishCalibration } from "../suite.mjs";
import { becomes, PATIENCE, twinOf, visit } from "../world.mjs";

const home = staticHome();

test("by every sample, until somebody says that this is enough", async (t) => {
  // the part warms itself by 20 °C in the 5 min before the oven cools by 2 °C/min (F-57)
  const prepare = twinOf("seed=7,profile=oven,warmup_c=20,warmup_s=60");
  const { page } = await visit(t, home.browser, `${home.site.url}#calibrate`, { prepare });
  await beginCalibration(page, "cycle", 1200);
  await page.waitForSelector(".run .actions button:not(.primary)[disabled]");
  await becomes(page, ".run .left", /left, (1[89]|[2-9]\d) min.* done/, 4 * PATIENCE);
  await page.waitForSelector(".run button.primary:not([disabled])");
  await page.getByRole("button", { name: "Finish now" }).click();
  await finishCalibration(page);
  assert.equal(await page.textContent(".result h1"), "Warm and cool: done");
});

test("a part that does not warm is refused, with what to do, and nothing is on file", async (t) => {
  const prepare = twinOf("seed=7,warmup_c=0");
  const { page } = await visit(t, home.browser, `${home.site.url}#calibrate`, { prepare });
  await beginCalibration(page);
  await page.waitForSelector(".calibrate .ended", { timeout: 3 * PATIENCE });
  assert.match(await page.textContent(".ended h1"), /refused/);
  assert.match(await page.textContent(".ended .why"), /°C/);
  await page.click('nav a[href="#device"]');
  await becomes(page, ".on-file", /None yet/);
  await page.click('nav a[href="#calibrate"]');
  await page.getByRole("button", { name: "Back to the methods" }).click();
  await page.waitForSelector(".choosing");
});
