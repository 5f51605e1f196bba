// A bridge behind Web Serial: firmware in QEMU, connected to a fake port in the page.
import assert from "node:assert/strict";
import { test } from "node:test";
import { proxy, staticHome } from "../static.mjs";
import { liveBench } from "../suite.mjs";
import { becomes, BRIDGE, freePort, open, PATIENCE, start, visit, without } from "../world.mjs";

const home = staticHome();

async function emulated() {
  const port = await freePort();
  const serial = `tcp:127.0.0.1:${port},server=on,wait=off,nodelay=on`;
  const semihosting = "enable=on,target=native,arg=bridge,arg=7";
  const machine = ["-M", "mps2-an386", "-nographic", "-monitor", "none", "-serial", serial];
  const child = start("qemu-system-arm", [...machine, "-semihosting-config", semihosting, "-kernel", BRIDGE], {
    stdio: "ignore",
  });
  return { port, child };
}

test(
  "a part behind the bridge: its samples, its registers, and its unplugging",
  { skip: without.bridge },
  async () => {
    const { port, child } = await emulated();
    const sockets = proxy(home.site.server, "/serial", port);
    const { page, context, faults } = await open(home.browser, `${home.site.url}#device`, {
      prepare: async (page, context) => {
        await context.addInitScript(`window.__serialProxy = "${home.site.url.replace("http", "ws")}serial";`);
        await context.addInitScript({ path: new URL("../fake-serial.js", import.meta.url).pathname });
      },
    });
    await page.getByRole("button", { name: "Choose its port" }).click();
    await becomes(page, ".device .name", /bridge/);
    await becomes(page, ".device .registers", /RATECONV/);
    await page.click('nav a[href="#bench"]');
    await liveBench(page);
    assert.deepEqual(faults, []);
    child.kill();
    // the page reads the remaining bytes first, which takes a while on a busy machine
    await becomes(page, "header .state", /cannot be read/, 3 * PATIENCE);
    sockets.close();
    await context.close();
  },
);

test("a browser without Web Serial says so", async (t) => {
  const { page } = await visit(t, home.browser, `${home.site.url}#device`, {
    prepare: (page) =>
      page.addInitScript(() => {
        delete Navigator.prototype.serial;
      }),
  });
  await becomes(page, ".openers", /does not give pages a serial port/);
  assert.ok(await page.getByRole("button", { name: "Choose its port" }).isDisabled());
});
