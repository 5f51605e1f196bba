// The worker of the static page, between windows and a fake session that records its calls.
import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, beforeEach, test } from "node:test";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";

/** Replaces the modules. Devices and applied calibrations are in `said`. A recording "broken" cannot be opened. */
const SESSION = `
  export default async () => {};
  export class LiveSession {
    static of_twin(keys) { return new LiveSession("twin " + keys); }
    static of_replay(name) {
      if (name === "broken") throw new Error("it is damaged");
      return new LiveSession("replay " + name);
    }
    constructor(name) { said.push(name); this.tomls = []; }
    use_twin(keys) { said.push("twin " + keys); }
    use_bridge() { said.push("bridge"); }
    calibrations() { return this.tomls; }
    add_calibration(toml) { this.tomls.push(toml); }
    apply(id) { if (id === "unfit") throw new Error("of another part"); this.id = id; said.push("apply " + id); }
    applied() { return this.id; }
    is_calibrating() { return false; }
    cannot_open(why) { said.push("cannot open: " + why); }
    received(bytes) { said.push("received " + bytes); }
    unplugged(why) { said.push("unplugged: " + why); }
    ask() { return "{}"; }
    turn() {}
    frame() {}
    snapshot() { return new Uint8Array(4); }
    to_send() { return new Uint8Array(0); }
    catch_up() {}
    free() {}
  }
  export class FirstLook {
    turn() {}
    frame() {}
    snapshot() { return new Uint8Array(4); }
    shown_s() { return 0; }
    free() {}
  }`;

const folder = await mkdtemp(join(tmpdir(), "zerorate-worker-"));
const standIn = {
  name: "stand-in",
  setup(bundle) {
    bundle.onResolve({ filter: /gen\/zerorate_/ }, ({ path }) => ({ path, namespace: "stand-in" }));
    bundle.onLoad({ filter: /.*/, namespace: "stand-in" }, () => ({ contents: SESSION }));
  },
};
const { outputFiles } = await build({
  entryPoints: ["src/worker/live.ts"],
  bundle: true,
  format: "esm",
  write: false,
  plugins: [standIn],
});
const said = (globalThis.said = []);
Object.assign(globalThis, { self: globalThis, SharedWorkerGlobalScope: class {}, FileReaderSync: class {} });
let worker = 0;

after(() => rm(folder, { recursive: true }));
beforeEach(async () => {
  said.length = 0;
  const path = join(folder, `live${(worker += 1)}.mjs`);
  await writeFile(path, outputFiles[0].contents);
  const { setInterval } = globalThis;
  globalThis.setInterval = () => {};
  await import(pathToFileURL(path));
  globalThis.setInterval = setInterval;
});

/** Opens a window that has said hello; `heard` has the worker's messages except frames. */
async function opened(calibrations = [], applied = null) {
  const port = { heard: [], postMessage: (told) => told.is !== "frame" && port.heard.push(told) };
  globalThis.onconnect({ ports: [port] });
  const say = async (data) => {
    port.onmessage({ data });
    await new Promise((done) => setTimeout(done, 5));
  };
  await say({ do: "hello", calibrations, applied, open: { is: "twin", keys: "" } });
  return { say, heard: port.heard };
}

const bytes = new Uint8Array([7]);

test("only the window that reads the port may send bytes, and loses it when another opens a device", async () => {
  const [one, other] = [await opened(), await opened()];
  await one.say({ do: "open", what: { is: "serial" } });
  said.length = 0;
  await other.say({ do: "serial-bytes", bytes });
  await other.say({ do: "serial-gone", why: "pulled" });
  await one.say({ do: "serial-bytes", bytes });
  assert.deepEqual(said, ["received 7"]);
  await other.say({ do: "open", what: { is: "twin", keys: "seed=2" } });
  await one.say({ do: "serial-bytes", bytes });
  assert.deepEqual([said.slice(1), one.heard, other.heard], [["twin seed=2"], [{ is: "serial-release" }], []]);
});

test("a window that leaves takes its port along", async () => {
  const one = await opened();
  await one.say({ do: "open", what: { is: "serial" } });
  await one.say({ do: "bye" });
  assert.equal(said.at(-1), "unplugged: its window was closed");
});

test("a recording keeps what is applied, and one that is broken leaves the one before it", async () => {
  const one = await opened(["toml"], "fit");
  const before = (globalThis.zerorate = { readAt: () => 0 });
  await one.say({ do: "open", what: { is: "capture", file: { name: "broken", size: 1 } } });
  assert.equal(globalThis.zerorate, before);
  assert.match(said.at(-1), /cannot open: it is damaged/);
  await one.say({ do: "open", what: { is: "capture", file: { name: "good", size: 1 } } });
  assert.notEqual(globalThis.zerorate, before);
  assert.deepEqual(said.slice(-2), ["replay good", "apply fit"]);
});
