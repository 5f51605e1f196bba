// Shared by the tests of the page: the browser, the static and the served page, and a window that collects its errors.
//
//   ZERORATE_PAGE       the folder of the static page (dist)
//   ZERORATE_PROGRAM    the program with the page inside (../target/debug/zerorate)
//   ZERORATE_BRIDGE     the image of the bridge for QEMU; without the image or QEMU, its test is skipped
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { chromium } from "playwright-core";

const require = createRequire(import.meta.url);
const here = new URL("..", import.meta.url).pathname;
export const PAGE = process.env.ZERORATE_PAGE ?? `${here}dist`;
export const PROGRAM = process.env.ZERORATE_PROGRAM ?? `${here}../target/debug/zerorate`;
export const BRIDGE = process.env.ZERORATE_BRIDGE ?? "";

/** The reason why a test cannot run on this machine; undefined if it can. */
export const without = {
  program: existsSync(PROGRAM) ? undefined : `no program at ${PROGRAM}`,
  bridge:
    existsSync(BRIDGE) && spawnSync("qemu-system-arm", ["--version"]).status === 0
      ? undefined
      : "no QEMU, or no image of the bridge",
};

/** Timeout for a busy machine, ms. */
export const PATIENCE = 60_000;

const FLAGS = [
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

export function launch() {
  const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
  return chromium.launch({ executablePath, headless: true, args: FLAGS });
}

/** Opens a window. `faults` has all errors of its scripts and violations of its policy. */
export async function open(browser, url, options = {}) {
  const {
    prepare,
    context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options.look }),
  } = options;
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") faults.push(message.text());
  });
  await prepare?.(page, context);
  await page.goto(url);
  await page.waitForSelector(options.ready ?? "body[data-ready]");
  return { page, context, faults };
}

/** Opens a window for a test, at whose end no script may have failed. */
export async function visit(test, browser, url, options) {
  const { page, context, faults } = await open(browser, url, options);
  test.after(async () => {
    await context.close();
    assert.deepEqual(faults, []);
  });
  return { page, context };
}

/** Prepares a window whose twin has these keys. */
export function twinOf(keys) {
  const text = JSON.stringify(keys);
  return (page) => page.addInitScript((text) => localStorage.setItem("zerorate.twin", text), text);
}

/** Records the twin of these keys at every 50th data-ready edge, 223 samples per second (F-56). Returns the path. */
export function recorded(path, keys, ...more) {
  const wish = ["capture", "--device", `twin:${keys}`, "--divider", "50", ...more, "-o", path];
  const { status, stderr } = spawnSync(PROGRAM, wish);
  assert.equal(status, 0, String(stderr));
  return path;
}

export async function becomes(page, selector, pattern, timeout = PATIENCE) {
  await page.waitForFunction(
    ([where, source]) => new RegExp(source, "s").test(document.querySelector(where)?.textContent ?? ""),
    [selector, pattern.source],
    { timeout },
  );
}

/** Returns the accessibility problems that axe finds. Checks that axe tests more than `fewest` rules. */
export async function bars(page, fewest = 15) {
  await page.evaluate(readFileSync(require.resolve("axe-core/axe.min.js"), "utf8"));
  const { violations, passes } = await page.evaluate(() => window.axe.run());
  assert.ok(passes.length > fewest, "axe looked at too little");
  return violations.map(
    ({ id, nodes }) =>
      `${id}: ${nodes
        .slice(0, 3)
        .map((node) => node.target.join(" "))
        .join(", ")}`,
  );
}

/** Time at which the raw rate is drawn, ms since the page began. Axes and grid are grey and do not count. */
export async function firstTrace(page, timeout = PATIENCE) {
  const isDrawn = () => {
    const canvas = document.querySelector(".strip.raw canvas");
    if (!canvas || canvas.width === 0) return false;
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    let coloured = 0;
    for (let k = 0; k < pixels.length; k += 4) {
      const most = Math.max(pixels[k], pixels[k + 1], pixels[k + 2]);
      const least = Math.min(pixels[k], pixels[k + 1], pixels[k + 2]);
      if (pixels[k + 3] > 200 && most - least > 60) coloured += 1;
    }
    return coloured > 50 && performance.now();
  };
  return (await page.waitForFunction(isDrawn, null, { timeout })).jsonValue();
}

export function freePort() {
  return new Promise((done) => {
    const server = createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => done(port));
    });
  });
}

const children = new Set();

/** Starts a child process that ends with the tests. */
export function start(command, args, options) {
  const child = spawn(command, args, options);
  children.add(child);
  child.on("exit", () => children.delete(child));
  return child;
}

export function stopAll() {
  for (const child of children) child.kill("SIGKILL");
}

/** Starts `zerorate serve`, and waits until it prints its address. */
export async function serve(args = [], port = undefined) {
  const listen = `127.0.0.1:${port ?? (await freePort())}`;
  const child = start(PROGRAM, ["serve", "--listen", listen, ...args], { stdio: ["ignore", "pipe", "pipe"] });
  let said = "";
  await new Promise((done, fail) => {
    const hear = (bytes) => {
      said += bytes;
      if (said.includes("http://")) done();
    };
    child.stderr.on("data", hear);
    child.stdout.on("data", hear);
    child.on("exit", (code) => fail(new Error(`serve ended (${code}): ${said}`)));
  });
  const ended = new Promise((done) => child.on("exit", done));
  return {
    url: `http://${listen}/`,
    port: Number(listen.split(":")[1]),
    stop: () => {
      child.kill("SIGINT");
      return ended;
    },
  };
}
