// Failures around the page: the page reports each and continues if it can.
import assert from "node:assert/strict";
import { test } from "node:test";
import { giveLog, LOGS } from "../logs.mjs";
import { staticHome } from "../static.mjs";
import { liveBench } from "../suite.mjs";
import { becomes, open, visit } from "../world.mjs";

const home = staticHome();

/** Number of canvases in the page's memory, visible or not. */
async function canvases(page) {
  const chromium = await page.context().newCDPSession(page);
  const { result } = await chromium.send("Runtime.evaluate", { expression: "HTMLCanvasElement.prototype" });
  const { objects } = await chromium.send("Runtime.queryObjects", { prototypeObjectId: result.objectId });
  const counted = await chromium.send("Runtime.callFunctionOn", {
    objectId: objects.objectId,
    functionDeclaration: "function () { return this.length; }",
    returnByValue: true,
  });
  for (const { objectId } of [objects, result]) await chromium.send("Runtime.releaseObject", { objectId });
  await chromium.detach();
  return counted.result.value;
}

test("a part of the page that is not there any more: said, and the rest goes on", async () => {
  let isGone = false;
  const { page, context, faults } = await open(home.browser, home.site.url, {
    look: { serviceWorkers: "block" },
    prepare: (_, context) => context.route(/part-.*\.js$/, (route) => (isGone ? route.abort() : route.continue())),
  });
  await liveBench(page);
  isGone = true;
  await page.click('nav a[href="#log"]');
  await becomes(page, ".missing [role=alert]", /could not be loaded/);
  await page.click('nav a[href="#bench"]');
  await liveBench(page);
  assert.deepEqual(faults.filter((fault) => !/ERR_FAILED/.test(fault)), []);
  await page.click('nav a[href="#log"]');
  await becomes(page, ".missing [role=alert]", /could not be loaded/);
  isGone = false;
  await page.getByRole("button", { name: "Load the page again" }).click();
  await page.waitForSelector(".page.log");
  await context.close();
});

test("a session that breaks down answers what is asked of it", async () => {
  const { page, context } = await open(home.browser, home.site.url, {
    // a worker that fails at the first request
    prepare: (page) =>
      page.addInitScript(() => {
        const Real = SharedWorker;
        globalThis.SharedWorker = class {
          constructor(...args) {
            const { port } = new Real(...args);
            const own = {
              postMessage: (message, transfer) => {
                if (message.do !== "ask") return port.postMessage(message, transfer);
                port.onmessage = null;
                setTimeout(() => own.onmessage({ data: { is: "failed", why: "it broke" } }), 100);
              },
            };
            port.onmessage = (event) => own.onmessage?.(event);
            this.port = own;
          }
        };
      }),
  });
  await liveBench(page);
  await page.getByRole("button", { name: "Zero the angle" }).click();
  await becomes(page, ".toast", /it broke/);
  await becomes(page, ".banner", /it broke/);
  await context.close();
});

test("a file that falls beside its place takes no page away", async (t) => {
  const { page } = await visit(t, home.browser, home.site.url);
  const kept = await page.evaluate(() => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File(["1,2"], "rest.csv"));
    return ["dragover", "drop"].map((kind) => {
      const event = new DragEvent(kind, { bubbles: true, cancelable: true, dataTransfer });
      document.querySelector("main").dispatchEvent(event);
      return event.defaultPrevented;
    });
  });
  assert.deepEqual(kept, [true, true]);
});

test("charts that are gone are not kept", async (t) => {
  const { page } = await visit(t, home.browser, `${home.site.url}#log`);
  const bytes = LOGS["rest.csv"].bytes().subarray(0, 60_000);
  const stage = async () => {
    await page.click('nav a[href="#calibrate"]');
    await page.click(".choosing button.primary");
    // waitForSelector would keep the canvas in memory
    await page.waitForFunction(() => document.querySelector(".run .trace canvas") !== null);
    await page.getByRole("button", { name: "Abort" }).click();
    await page.getByRole("button", { name: "End it" }).click();
    await page.getByRole("button", { name: "Back to the methods" }).click();
    await page.waitForSelector(".choosing");
    await page.click('nav a[href="#log"]');
    await giveLog(page, "short.csv", bytes);
  };
  await stage();
  const before = await canvases(page);
  for (let again = 0; again < 3; again += 1) await stage();
  assert.ok(before >= 3, `${before} canvases`);
  // a queued animation frame may keep a removed chart for a moment
  let after = await canvases(page);
  for (let look = 0; look < 50 && after !== before; look += 1) {
    await page.waitForTimeout(100);
    after = await canvases(page);
  }
  assert.equal(after, before);
});
