// What the browser keeps between visits, without a browser.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { build } from "esbuild";

const KEY = "zerorate.calibrations";
const { outputFiles } = await build({ entryPoints: ["src/kept.ts"], bundle: true, format: "esm", write: false });
const store = new Map();
globalThis.localStorage = {
  getItem: (key) => store.get(key) ?? null,
  setItem: (key, value) => store.set(key, value),
};
const { kept } = await import(
  `data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`
);

beforeEach(() => store.clear());

test("what the session did not take stays, and what it has is added once", () => {
  store.set(KEY, JSON.stringify({ calibrations: ["damaged", "one"], applied: "1" }));
  const entries = [
    { id: "1", toml: "one", applied: false },
    { id: "2", toml: "two", applied: true },
  ];
  kept.keepCalibrations(entries);
  kept.keepCalibrations(entries);
  assert.deepEqual(kept.calibrations(), { calibrations: ["damaged", "one", "two"], applied: "2" });
});

test("two windows with a session each keep what both have", () => {
  kept.keepCalibrations([{ id: "1", toml: "one", applied: false }]);
  kept.keepCalibrations([{ id: "2", toml: "two", applied: false }]);
  assert.deepEqual(kept.calibrations().calibrations, ["one", "two"]);
});

test("what was removed is not kept", () => {
  kept.keepCalibrations([
    { id: "1", toml: "one", applied: true },
    { id: "2", toml: "two", applied: false },
  ]);
  kept.forgetCalibration("two");
  assert.deepEqual(kept.calibrations(), { calibrations: ["one"], applied: "1" });
});
