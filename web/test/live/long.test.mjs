// Long tests: memory over minutes at high speed, and a log of 20 million samples.
import assert from "node:assert/strict";
import { closeSync, openSync, writeSync } from "node:fs";
import { test } from "node:test";
import { giveLog, logIsDone, npyHead } from "../logs.mjs";
import { staticHome } from "../static.mjs";
import { liveBench } from "../suite.mjs";
import { PATIENCE, visit } from "../world.mjs";

/** Time for which the heap is observed, s. */
const LOOK_S = 45;
const SAMPLES = 20_000_000;
const RATE_HZ = 1000;
const SD_DPS = 0.1;

const home = staticHome();

test("the heap of the page does not grow, however fast the samples come", async (t) => {
  const { page, context } = await visit(t, home.browser, home.site.url);
  await liveBench(page);
  await page.getByLabel("max", { exact: true }).check();
  const chromium = await context.newCDPSession(page);
  const heap = async () => {
    await chromium.send("HeapProfiler.collectGarbage");
    return (await chromium.send("Runtime.getHeapUsage")).usedSize;
  };
  await page.waitForTimeout(15_000);
  const before = await heap();
  await page.waitForTimeout(1000 * LOOK_S);
  const grown = (await heap()) - before;
  const mb = (bytes) => `${(bytes / 1e6).toFixed(2)} MB`;
  console.log(`heap of the page: ${mb(before)}, ${mb(grown)} more after ${LOOK_S} s`);
  assert.ok(grown < 3e6, `${grown} bytes more`);
});

/** Writes white noise as an NPY file of one column, the same on every machine (xorshift, Box–Muller transform). */
function writeNoise(path) {
  const file = openSync(path, "w");
  writeSync(file, npyHead(SAMPLES, 1));
  const block = new Float64Array(1 << 20);
  let [a, b] = [123_456_789, 362_436_069];
  const uniform = () => {
    a ^= a << 13;
    a ^= a >>> 17;
    a ^= a << 5;
    b = (Math.imul(b, 1_664_525) + 1_013_904_223) | 0;
    return (((a + b) >>> 0) + 0.5) / 2 ** 32;
  };
  for (let left = SAMPLES; left > 0; left -= block.length) {
    for (let k = 0; k < block.length; k += 2) {
      const [radius, angle] = [SD_DPS * Math.sqrt(-2 * Math.log(uniform())), 2 * Math.PI * uniform()];
      block[k] = radius * Math.cos(angle);
      block[k + 1] = radius * Math.sin(angle);
    }
    writeSync(file, new Uint8Array(block.buffer, 0, 8 * Math.min(left, block.length)));
  }
  closeSync(file);
}

test("20 million samples: the page stays alive, and finds the noise that they were made of", async (t) => {
  const path = `${home.folder}/long.npy`;
  writeNoise(path);
  const { page } = await visit(t, home.browser, `${home.site.url}#log`);
  assert.match(await giveLog(page, "long.npy", path), /does not say enough/);
  await page.evaluate(() => {
    window.longest = 0;
    let before = performance.now();
    const tick = (now) => {
      window.longest = Math.max(window.longest, now - before);
      before = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  });
  await page.fill("#log-rate_hz", String(RATE_HZ));
  await page.fill("#log-gyro_unit", "dps");
  await page.fill("#log-columns", "0");
  const begun = Date.now();
  await page.click(".questions button.primary");
  await logIsDone(page, 6 * PATIENCE);
  const longest = await page.evaluate(() => window.longest);
  const took_s = (Date.now() - begun) / 1000;
  console.log(`20 million samples in ${took_s} s; longest gap between frames ${Math.round(longest)} ms`);
  assert.match(await page.textContent(".log .doing"), /done/);
  assert.ok(longest < 1000, `${longest} ms without a frame`);
  // 0.1 per sample at 1 kHz is N = 0.1 · √0.001 s; an unnamed column has no unit
  const found = await page.textContent(".axes-of-log .coefficients tbody tr:first-child");
  const [, value, lo, hi] = /walk([\d.]+) \[([\d.]+), ([\d.]+)\] unit·√s/.exec(found) ?? assert.fail(found);
  assert.ok(Math.abs(Number(value) / 0.003_162_3 - 1) < 0.005, found);
  assert.ok(Number(lo) <= 0.003_17 && Number(hi) >= 0.003_16, found);
});
