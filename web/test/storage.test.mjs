// The data that the browser keeps between visits, tested without a browser.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { bundled } from "./bundle.mjs";

const KEY = "zerorate.calibrations";
const store = new Map();
globalThis.localStorage = {
  getItem: (key) => store.get(key) ?? null,
  setItem: (key, value) => store.set(key, value),
};
const { storage } = await bundled({ entryPoints: ["src/storage.ts"] });

beforeEach(() => store.clear());

test("calibrations that the session refused stay, and its own are added once", () => {
  store.set(KEY, JSON.stringify({ calibrations: ["damaged", "one"], applied: "1" }));
  const entries = [
    { id: "1", toml: "one", applied: false },
    { id: "2", toml: "two", applied: true },
  ];
  storage.keepCalibrations(entries);
  storage.keepCalibrations(entries);
  assert.deepEqual(storage.calibrations(), { calibrations: ["damaged", "one", "two"], applied: "2" });
});

test("two windows with a session each keep what both have", () => {
  storage.keepCalibrations([{ id: "1", toml: "one", applied: false }]);
  storage.keepCalibrations([{ id: "2", toml: "two", applied: false }]);
  assert.deepEqual(storage.calibrations().calibrations, ["one", "two"]);
});

test("a removed calibration leaves the storage", () => {
  storage.keepCalibrations([
    { id: "1", toml: "one", applied: true },
    { id: "2", toml: "two", applied: false },
  ]);
  storage.forgetCalibration("two");
  assert.deepEqual(storage.calibrations(), { calibrations: ["one"], applied: "1" });
});
