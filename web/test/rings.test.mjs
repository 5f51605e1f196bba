// Frames, rings and the window of time, without a browser.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundled } from "./bundle.mjs";

const contents = ["frame", "ring", "model", "chart/window", "chart/extent"]
  .map((name) => `export * from "./src/${name}";`)
  .join("\n");
const page = await bundled({ stdin: { contents, resolveDir: "." } });

/** Makes a frame by docs/formats/page.md. */
function framed(header, numbers) {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const from = Math.ceil((4 + text.length) / 4) * 4;
  const bytes = new ArrayBuffer(from + 4 * numbers.length);
  new DataView(bytes).setUint32(0, text.length, true);
  new Uint8Array(bytes).set(text, 4);
  numbers.forEach((number, k) => new DataView(bytes).setFloat32(from + 4 * k, number, true));
  return bytes;
}

/** Columns of bins with these largest rates. The smallest rates are one less. */
function columns(rates) {
  return [...rates.map((rate) => rate - 1), ...rates, ...new Array(4 * rates.length).fill(NaN)];
}

test("a frame is taken apart, whatever the length of its header", () => {
  for (const name of ["a", "ab", "abc", "abcd", "ä"]) {
    const { frame, payload } = page.unframe(framed({ name }, [1.5, -2]));
    assert.equal(frame.name, name);
    assert.deepEqual([...payload], [1.5, -2]);
  }
  assert.throws(() => page.unframe(framed({ name: "cut" }, []).slice(0, 8)), /ends within its header/);
});

test("a ring keeps the newest bins, and bins that come twice change nothing", () => {
  const ring = new page.Ring(4, 0.001);
  const give = (first, rates) => ring.write(first, rates.length, Float32Array.from(columns(rates)), 0);
  give(10, [1, 2, 3]);
  assert.deepEqual([ring.oldest, ring.next], [10, 13]);
  give(12, [3, 4, 5]);
  assert.deepEqual([ring.oldest, ring.next], [11, 15]);
  const [least, largest] = [new Float64Array(4), new Float64Array(4)];
  assert.equal(ring.copy("rate", 11, 15, least, largest), 4);
  assert.deepEqual([...largest], [2, 3, 4, 5]);
  assert.deepEqual([...least], [1, 2, 3, 4]);
});

test("bins that never came are empty, and a long silence begins anew", () => {
  const ring = new page.Ring(8, 0.001);
  const give = (first, rates) => ring.write(first, rates.length, Float32Array.from(columns(rates)), 0);
  give(0, [1, 2]);
  give(4, [5]);
  const [least, largest] = [new Float64Array(8), new Float64Array(8)];
  ring.copy("rate", 0, 5, least, largest);
  assert.deepEqual([...largest.subarray(0, 5)], [1, 2, NaN, NaN, 5]);
  give(1_000_000, [9]);
  assert.deepEqual([ring.oldest, ring.next], [1_000_000, 1_000_001]);
});

test("memory does not grow however many bins come", () => {
  const model = new page.Model();
  const device = { bins_s: [0.001, 0.008], bins_kept: 16, axes: [{ name: "rate" }], state: { is: "reading" } };
  const give = (first, snapshot) => {
    const strip = { axis: 0, level: 0, first, count: 3, at: 0 };
    model.take(
      page.unframe(
        framed({ seq: first, snapshot, strips: [strip], ...(snapshot ? { device } : {}) }, columns([7, 8, 9])),
      ),
    );
  };
  give(0, true);
  const ring = model.rings[0][0];
  for (let k = 1; k < 20_000; k++) give(3 * k, false);
  assert.equal(model.rings[0][0], ring);
  assert.deepEqual([ring.next - ring.oldest, ring.next], [16, 60_000]);
  give(5, true);
  assert.deepEqual([model.rings[0][0].oldest, model.rings[0][0].next], [5, 8]);
  assert.ok(model.changes().has("strips") && model.changes().size === 0);
});

test("a snapshot voids what was known", () => {
  const model = new page.Model();
  model.take({
    frame: { seq: 1, snapshot: true, strips: [], notices: [{ text: "old" }], now: { t_s: 1 } },
    payload: new Float32Array(0),
  });
  model.take({ frame: { seq: 2, snapshot: false, strips: [] }, payload: new Float32Array(0) });
  assert.equal(model.notices[0].text, "old");
  model.take({ frame: { seq: 3, snapshot: true, strips: [] }, payload: new Float32Array(0) });
  assert.deepEqual([model.notices, model.now], [[], undefined]);
});

test("a window follows, holds, zooms around a point, and comes back", () => {
  const window = new page.TimeWindow();
  window.follow(100);
  assert.deepEqual([window.from, window.to, window.held], [90, 100, false]);
  window.hold(92, 96);
  window.follow(200);
  assert.deepEqual([window.from, window.to, window.held], [92, 96, true]);
  window.zoom(0.5, 93);
  assert.deepEqual([window.from, window.to], [92.5, 94.5]);
  window.pan(0.5);
  assert.deepEqual([window.from, window.to], [93.5, 95.5]);
  window.live();
  assert.equal(window.to, 200);
});

test("the level is the finest that is drawn and still has what is on view", () => {
  const levels = [0.001, 0.008, 0.064].map((bin_s) => new page.Ring(2048, bin_s));
  for (const ring of levels) ring.write(0, 1, new Float32Array(6), 0);
  const fill = (ring, until_s) => {
    for (let bin = ring.next; bin < until_s / ring.bin_s; bin++) ring.write(bin, 1, new Float32Array(6), 0);
  };
  for (const ring of levels) fill(ring, 30);
  const chosen = (from, to) => page.levelFor(levels, from, to).bin_s;
  assert.equal(chosen(29, 30), 0.001);
  assert.equal(chosen(20, 30), 0.008);
  assert.equal(chosen(20, 20.5), 0.008);
  assert.equal(chosen(0, 10), 0.064);
  assert.equal(chosen(0, 10_000), 0.064);
});

test("an axis grows at once and shrinks late", () => {
  const extent = new page.Extent(0.1);
  const range = (least, largest) => extent.around(Float64Array.of(least), Float64Array.of(largest), 1, 1);
  const first = range(-1, 1);
  assert.ok(first.min <= -1 && first.max >= 1);
  assert.deepEqual(range(-0.9, 0.9), first);
  const grown = range(-5, 1);
  assert.ok(grown.min <= -5);
  const shrunk = range(-0.1, 0.1);
  assert.ok(shrunk.max - shrunk.min < 1 && shrunk.min <= -0.1 && shrunk.max >= 0.1);
});
