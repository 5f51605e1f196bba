// node test/pictures.mjs [FOLDER]: makes the pictures of the page for the book and the README. With FOLDER, makes
// every page in both themes, and two on a phone. The device is the twin, so that anybody can repeat the pictures.
import { mkdirSync, writeFileSync } from "node:fs";
import { LOGS } from "./logs.mjs";
import { serveFolder } from "./static.mjs";
import { beginCalibration, liveBench } from "./suite.mjs";
import { becomes, launch, open, PAGE, PATIENCE } from "./world.mjs";

const toLookAt = process.argv[2];
const folder = toLookAt ?? new URL("../../docs/pictures/page", import.meta.url).pathname;

mkdirSync(folder, { recursive: true });
const browser = await launch();
const site = await serveFolder(PAGE);

/** Largest height of a picture, px. The rest of a long page is cut off. */
const TALLEST = 1500;

async function take(page, name) {
  const path = `${folder}/${name}.png`;
  const { width, height } = await page.evaluate(() => ({
    width: innerWidth,
    height: document.documentElement.scrollHeight,
  }));
  const clip = { x: 0, y: 0, width, height: Math.min(height, TALLEST), scale: 1 };
  await page.evaluate(() => scrollTo(0, 0));
  const chromium = await page.context().newCDPSession(page);
  const { data } = await chromium.send("Page.captureScreenshot", { format: "png", clip, captureBeyondViewport: true });
  writeFileSync(path, Buffer.from(data, "base64"));
  console.log(path);
}

/** Lets the twin's time pass until the text below the count of samples matches `pattern`. */
async function until(page, pattern) {
  await page.click('nav a[href="#bench"]');
  await page.getByLabel("max", { exact: true }).check();
  await becomes(page, ".tile.ledger .below", pattern);
  await page.getByLabel("1 ×", { exact: true }).check();
  await page.waitForTimeout(1500);
}

for (const theme of toLookAt ? ["light", "dark"] : ["light"]) {
  const look = { colorScheme: theme, viewport: { width: 1180, height: 700 } };
  const { page, context: own } = await open(browser, site.url, { look });
  await liveBench(page);
  await page.click('nav a[href="#calibrate"]');
  if (toLookAt) await take(page, `calibrate-${theme}`);
  await page.check('input[value="chamber"]');
  await take(page, `calibrate-chamber-${theme}`);
  await beginCalibration(page, "warmup");
  await becomes(page, ".run .left", /min .*done/);
  await page.getByLabel("1 ×", { exact: true }).check();
  await page.waitForTimeout(500);
  await take(page, `calibrate-run-${theme}`);
  await page.getByLabel("max", { exact: true }).check();
  await page.waitForSelector(".result", { timeout: 3 * PATIENCE });
  await page.click(".result button.primary");
  await becomes(page, ".result button.primary", /Applied/);
  await take(page, `calibrate-result-${theme}`);
  await until(page, /for (1\d|[2-9]\d) min|for \d+ h/);
  await take(page, `bench-${theme}`);
  await page.click('nav a[href="#device"]');
  await becomes(page, ".on-file", /Applied/);
  await take(page, `device-${theme}`);
  await page.click('nav a[href="#log"]');
  await page.setInputFiles(".intake input[type=file]", {
    name: "rest.csv",
    mimeType: "text/csv",
    buffer: LOGS["rest.csv"].bytes(),
  });
  await becomes(page, ".log .doing", /done/);
  await page.waitForTimeout(300);
  await take(page, `log-${theme}`);
  await own.close();
}

if (toLookAt) {
  const look = { viewport: { width: 390, height: 800 }, colorScheme: "dark", isMobile: true };
  const { page } = await open(browser, site.url, { look });
  await liveBench(page);
  await page.waitForTimeout(12_000);
  await take(page, "bench-phone");
  await page.click('nav a[href="#calibrate"]');
  await beginCalibration(page, "warmup");
  await page.getByLabel("max", { exact: true }).check();
  await page.waitForSelector(".result", { timeout: 3 * PATIENCE });
  await take(page, "calibrate-result-phone");
}
await browser.close();
site.stop();
