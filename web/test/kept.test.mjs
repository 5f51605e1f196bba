// What the browser keeps between visits, without a browser.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { bundled } from "./bundle.mjs";

const KEY = "zerorate.calibrations";
const store = new Map();
globalThis.localStorage = {
  getItem: (key) => store.get(key) ?? null,
  setItem: (key, value) => store.set(key, value),
};
const { kept } = await bundled({ entryPoints: ["src/kept.ts"] });

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
