// Numbers as text, compared with figures that were rounded by hand.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundled } from "./bundle.mjs";

const digits = await bundled({ entryPoints: ["src/digits.ts"] });

test("a value has the digits that its uncertainty warrants", () => {
  const cases = [
    [0.284519, 0.0088, "0.2845"],
    [0.284519, 0.088, "0.285"],
    [-0.6650123, 0.00271, "−0.6650"],
    [12345.6, 1234, "12300"],
    [1.25, 0.0996, "1.25"],
    [-0.00004, 0.01, "0.000"],
    [3, 1e-9, "3.0000000000"],
    [24.9838, 0.02, "24.984"],
  ];
  for (const [value, u, text] of cases) assert.equal(digits.value(value, u), text, `${value} ± ${u}`);
  assert.equal(digits.both(0.284519, 0.0088), "0.2845 ± 0.0088");
  assert.equal(digits.both(0.284519, 0.00996), "0.285 ± 0.010");
  assert.ok(Math.abs(digits.half(1) - 1.96) < 1e-4 && digits.half(0) === null && digits.half(null) === null);
});

test("without an uncertainty there are four digits, and nothing is a dash", () => {
  assert.equal(digits.value(0.123456), "0.1235");
  for (const nothing of [null, undefined, NaN, Infinity]) assert.equal(digits.value(nothing, 1), "–");
  assert.equal(digits.value(1.5, 0), "1.500");
});

test("significant digits, with powers of ten where nobody would count the zeros", () => {
  assert.equal(digits.significant(0.00856, 3), "0.00856");
  assert.equal(digits.significant(7.74e-8, 3), "7.74 × 10⁻⁸");
  assert.equal(digits.significant(-1234567, 3), "−1.23 × 10⁶");
  assert.equal(digits.significant(0, 3), "0");
});

test("durations as people say them", () => {
  const cases = [
    [0.25, "0.25 s"],
    [1, "1 s"],
    [45.2, "45 s"],
    [59.7, "1 min"],
    [200, "3 min 20 s"],
    [7800, "2 h 10 min"],
    [3600, "1 h"],
    [176_400, "2 d 1 h"],
  ];
  for (const [seconds, text] of cases) assert.equal(digits.duration(seconds), text, String(seconds));
  assert.equal(digits.duration(null), "–");
});

test("points of time", () => {
  assert.equal(digits.moment(59.9996, 3), "1 min 0.000 s");
  assert.equal(digits.moment(59.9994, 3), "59.999 s");
  assert.equal(digits.moment(3723, 0), "1 h 2 min 3 s");
  assert.equal(digits.moment(-2.5, 1), "−2.5 s");
  assert.equal(digits.count(1234567), "1\u2009234\u2009567");
  assert.equal(digits.hex(7, 8), "07h");
});

test("numbers of a time axis name their unit", () => {
  assert.equal(digits.onAxis(0.25, 0.05), "0.25 s");
  assert.equal(digits.onAxis(75, 15), "75 s");
  assert.equal(digits.onAxis(120, 60), "2 min");
  assert.equal(digits.onAxis(5400, 900), "90 min");
  assert.equal(digits.onAxis(7200, 3600), "2 h");
});

test("multiples of a step are told apart", () => {
  for (const [step, decimals] of [[0.025, 3], [0.05, 2], [5, 0], [250, 0], [1e-6, 6]])
    assert.equal(digits.decimalsOf(step), decimals, step);
});
