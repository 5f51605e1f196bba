// node test/bench.mjs DATA: measures the page for `cargo xtask bench-web`. DATA has f64 numbers, little endian.
import { existsSync, readFileSync } from "node:fs";
import { brotliCompressSync, constants } from "node:zlib";
import init, { oadev } from "../gen/zerorate_log.js";
import { serveFolder } from "./static.mjs";
import { firstTrace, launch, PAGE } from "./world.mjs";

const RUNS = 5;

/** Returns the seconds of the best run, and the deviations. The samples are in JavaScript, as if read from a file. */
async function deviations(file) {
  await init({ module_or_path: readFileSync(new URL("../gen/zerorate_log_bg.wasm", import.meta.url)) });
  const bytes = readFileSync(file);
  const rate = new Float64Array(bytes.buffer, bytes.byteOffset, bytes.length / 8);
  let seconds = Infinity;
  let found;
  for (let run = 0; run < RUNS; run += 1) {
    const [took, ...all] = oadev(rate);
    seconds = Math.min(seconds, took / 1000);
    found = all;
  }
  return { seconds, found };
}

/** Returns the seconds until the first chart is drawn, best of three first visits, and the files loaded by then. */
async function firstPicture() {
  const site = await serveFolder(PAGE);
  const browser = await launch();
  let best = Infinity;
  for (let visit = 0; visit < 3; visit += 1) {
    const page = await (await browser.newContext({ viewport: { width: 1280, height: 900 }, serviceWorkers: "block" })).newPage();
    await page.goto(site.url, { waitUntil: "commit" });
    best = Math.min(best, (await firstTrace(page)) / 1000);
    await page.context().close();
  }
  await browser.close();
  site.stop();
  const files = new Set(site.asked.map((path) => path.slice(1) || "index.html"));
  return { best, files: [...files].filter((name) => existsSync(`${PAGE}/${name}`)) };
}

/** Size of files compressed with brotli, as a server sends them, bytes. */
function packed(files) {
  const size = (name) => brotliCompressSync(readFileSync(`${PAGE}/${name}`), { params: { [constants.BROTLI_PARAM_QUALITY]: 11 } }).length;
  return files.map(size).reduce((all, one) => all + one, 0);
}

const { seconds, found } = await deviations(process.argv[2]);
const { best, files } = await firstPicture();
/** True for a file that the first picture does not need: the session, and files for later. */
const isLater = (name) => /zerorate_(live|log|replay)|licence|^sw\./.test(name);
console.log(JSON.stringify({
  seconds,
  dev: found,
  first_picture_s: best,
  first_load_bytes: packed(files.filter((name) => !isLater(name))),
  session_bytes: packed(["zerorate_live_bg.wasm"]),
  readers_bytes: packed(["zerorate_log_bg.wasm"]),
  recordings_bytes: packed(["zerorate_replay_bg.wasm"]),
}));
