// The page of `zerorate serve`: the session runs in the program.
import assert from "node:assert/strict";
import { mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { after, before, test } from "node:test";
import { giveLog, LOGS } from "./logs.mjs";
import { beginCalibration, downloads, everyPage, finishCalibration, liveBench } from "./suite.mjs";
import { becomes, freePort, launch, open, PROGRAM, serve, start, stopAll, visit, without } from "./world.mjs";

const TWIN = ["--device", "twin:seed=7"];
const skip = without.program;
let browser, server, folder;

before(async () => {
  if (skip) return;
  browser = await launch();
  folder = mkdtempSync(`${tmpdir()}/zerorate-page-`);
  server = await serve([...TWIN, "--folder", folder]);
});
after(async () => {
  await browser?.close();
  stopAll();
  if (folder) rmSync(folder, { recursive: true });
});

test("every page in both themes, readable by everybody", { skip }, () => everyPage(browser, server.url));

test("a whole calibration, over a reload and in two windows; its file is in the folder", { skip }, async (t) => {
  const { page } = await visit(t, browser, server.url);
  await beginCalibration(page, "warmup");
  await page.waitForSelector(".calibrate .run");
  await page.reload();
  await page.waitForSelector(".calibrate .run, .calibrate .result");
  const second = await open(browser, `${server.url}#calibrate`);
  await second.page.waitForSelector(".calibrate .run, .calibrate .result");
  await finishCalibration(page);
  await becomes(second.page, ".result button.primary", /^Applied$/);
  await downloads(page);
  assert.equal(readdirSync(folder).filter((name) => name.endsWith(".toml")).length, 1);
  await page.getByLabel("1 ×", { exact: true }).check();
  await page.click('nav a[href="#bench"]');
  await becomes(page, ".tile.corrected .value", /\d/);
  await second.context.close();
});

test("a server that goes within a calibration and comes again: live, and another can begin", { skip }, async () => {
  const first = await serve(TWIN);
  const { page, context } = await open(browser, first.url);
  await page.click('nav a[href="#calibrate"]');
  await becomes(page, ".before", /The page may be closed meanwhile/);
  await page.click(".choosing button.primary");
  await becomes(page, ".run .left", /left/);
  await first.stop();
  await becomes(page, ".banner", /cannot be reached/);
  const again = await serve(TWIN, first.port);
  await becomes(page, ".banner", /^$/);
  await page.waitForSelector(".choosing");
  await page.click(".choosing button.primary");
  await becomes(page, ".run .left", /left/);
  await page.click('nav a[href="#bench"]');
  await liveBench(page);
  await again.stop();
  await context.close();
});

test("a log, which never comes to the server, on a page that asks no other", { skip }, async (t) => {
  const sent = new Set();
  const { page } = await visit(t, browser, `${server.url}#log`, {
    prepare: (page) =>
      page.on("request", (request) => sent.add(`${request.method()} ${new URL(request.url()).origin}`)),
  });
  assert.match(await giveLog(page, "rest.csv", LOGS["rest.csv"].bytes()), /done/);
  assert.match(await page.textContent(".axes-of-log .coefficients tbody tr:first-child"), /^N.*(0\.59|0\.6)/);
  assert.deepEqual([...sent], [`GET ${new URL(server.url).origin}`]);
});

test("a token, where one is needed: in the form, wrong and right, and in the address", { skip }, async () => {
  const token = "0123456789abcdef0123456789abcdef";
  const file = `${folder}/token`;
  writeFileSync(file, `${token}\n`);
  const port = await freePort();
  const child = start(PROGRAM, ["serve", ...TWIN, "--listen", `0.0.0.0:${port}`, "--token-file", file], {
    stdio: "pipe",
  });
  await new Promise((done) => child.stderr.on("data", (bytes) => String(bytes).includes("http://") && done()));
  const url = `http://127.0.0.1:${port}/`;
  const { page, context } = await open(browser, url, { ready: ".lock #token" });
  await page.fill("#token", "wrong-wrong-wrong-wrong");
  await page.click(".lock button");
  await becomes(page, ".lock .wrong", /not the token/);
  await page.fill("#token", token);
  await page.click(".lock button");
  await page.waitForSelector("body[data-ready]");
  await liveBench(page);
  await page.reload();
  await page.waitForSelector("body[data-ready]");
  await context.close();
  const other = await open(browser, `${url}#token=${token}`);
  assert.ok(!other.page.url().includes(token));
  await other.context.close();
  child.kill();
});
