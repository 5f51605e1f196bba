import uPlot from "uplot";
import { decimalsOf, moment, onAxis, significant } from "../digits";
import { h, say } from "../dom";
import type { Column, Ring } from "../ring";
import { settings } from "../settings";
import { faint, palette } from "./palette";
import { Extent } from "./extent";
import { DRAWN, type TimeWindow } from "./window";

export interface StripKind {
  column: Column;
  title: string;
  colour: "raw" | "corrected" | "temp";
  /** The smallest range that the axis shows, °/s or °C. */
  least: number;
  /** The text while there is nothing to show. */
  nothing: string;
}

/** The state that all strips share. */
export interface Shared {
  window: TimeWindow;
  /** Positions of the cursors, s since the first sample; undefined for a cursor that is not set. */
  cursors: { A: number | undefined; B: number | undefined };
  /** The time under the pointer, s since the first sample; undefined if the pointer is elsewhere. */
  hover: number | undefined;
  changed(): void;
}

/** The possible steps between two numbers on the time axis, s. */
const STEPS_S = [
  0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600,
  7200,
];

/** The shortest time between two changes of the numbers above a strip while the pointer is on none, ms. */
const READ_MS = 250;

/** Heights of the chart and of the numbers on its time axis, px. */
const HEIGHT = 128;
const TIMES = 20;

/** The least width of a bin without neighbours, px. */
const LEAST_WIDTH = 1.5;

/** A strip chart: for each bin an area from its least to its largest value, so that a spike is never hidden. */
export class Strip {
  readonly element: HTMLElement;
  readonly #readout = h("span", { class: "readout" });
  readonly #title = h("span", { class: "name" });
  readonly #nothing = h("p", { class: "nothing" });
  readonly #box = h("div", { class: "plot" });
  readonly #x = new Float64Array(DRAWN + 2);
  readonly #least = new Float64Array(DRAWN + 2);
  readonly #largest = new Float64Array(DRAWN + 2);
  readonly #extent: Extent;
  readonly #resized = new ResizeObserver(() =>
    this.#plot?.setSize({ width: this.#box.clientWidth, height: this.#height }),
  );
  #plot: uPlot | undefined;
  #ring: Ring | undefined;
  #count = 0;
  #told = 0;

  constructor(
    readonly kind: StripKind,
    readonly shared: Shared,
  ) {
    this.#extent = new Extent(kind.least);
    say(this.#nothing, kind.nothing);
    this.element = h(
      "figure",
      { class: `strip ${kind.colour}` },
      h("figcaption", {}, this.#title, this.#readout),
      this.#box,
      this.#nothing,
    );
    this.#resized.observe(this.#box);
  }

  /** True if the strip shows a rate. The temperature strip is the lowest, and has the numbers of the time axis. */
  get #isRate(): boolean {
    return this.kind.column !== "temp";
  }

  get #height(): number {
    return HEIGHT + (this.#isRate ? 0 : TIMES);
  }

  get scale(): number {
    return this.#isRate ? settings.scale : 1;
  }

  get unit(): string {
    return this.#isRate ? settings.unitText : "°C";
  }

  remake(): void {
    this.#plot?.destroy();
    this.#plot = undefined;
    this.#extent.forget();
  }

  destroy(): void {
    this.#resized.disconnect();
    this.#plot?.destroy();
    this.#plot = undefined;
  }

  /** Draws the part of a ring that is in the time window. */
  draw(ring: Ring | undefined): void {
    if (this.#box.clientWidth === 0) return;
    this.#plot ??= this.#make();
    this.#ring = ring;
    this.#count = ring ? this.#collect(ring) : 0;
    const { from, to } = this.shared.window;
    const range = this.#extent.around(this.#least, this.#largest, this.#count, this.scale);
    const of = (all: Float64Array) => all.subarray(0, this.#count);
    this.#plot.batch(() => {
      this.#plot!.setData([of(this.#x), of(this.#largest)] as unknown as uPlot.AlignedData, false);
      this.#plot!.setScale("x", { min: from, max: to });
      this.#plot!.setScale("y", range);
    });
    this.#nothing.hidden = this.#extent.seen !== undefined;
    this.tell();
  }

  /** Shows the values under the pointer, or else, at most every `READ_MS`, those of the last bin in the window. */
  tell(): void {
    const at = this.shared.hover;
    if (at === undefined && performance.now() - this.#told < READ_MS) return;
    this.#told = performance.now();
    const bin = at === undefined ? this.#count - 1 : this.#index(at);
    say(this.#title, `${this.kind.title}, ${this.unit}`);
    say(this.#readout, bin < 0 || bin >= this.#count ? "" : this.#words(bin, at !== undefined));
  }

  /** The mean of the smallest and largest value of the bin at a time, in the displayed unit; NaN if there is none. */
  middle(at_s: number): number {
    const bin = this.#index(at_s);
    if (bin < 0 || bin >= this.#count) return NaN;
    const middle = (this.#least[bin]! + this.#largest[bin]!) / 2;
    return Number.isFinite(middle) ? middle * this.scale : NaN;
  }

  /** The smallest and largest displayed value in words, for users who do not see the chart. */
  summary(): string {
    const range = this.#extent.seen;
    if (!range) return `${this.kind.title}: ${this.kind.nothing}`;
    const [least, largest] = range.map((v) => significant(v * this.scale, 4));
    return `${this.kind.title}: between ${least} and ${largest} ${this.unit}`;
  }

  #words(bin: number, withTime: boolean): string {
    const [least, largest] = [this.#least[bin]!, this.#largest[bin]!];
    if (!Number.isFinite(least)) return "";
    const words = `${this.#number(least)} … ${this.#number(largest)}`;
    return withTime ? `at ${moment(this.#x[bin]!, 3)}: ${words}` : words;
  }

  #number(value: number): string {
    const digits = this.#isRate ? (settings.unit === "dps" ? 4 : 0) : 3;
    return (value * this.scale).toFixed(digits).replace("-", "\u2212");
  }

  #index(at_s: number): number {
    if (!this.#ring || this.#count === 0) return -1;
    return Math.round((at_s - this.#x[0]!) / this.#ring.bin_s);
  }

  #collect(ring: Ring): number {
    const { from, to } = this.shared.window;
    const first = Math.max(ring.oldest, Math.floor(from / ring.bin_s) - 1);
    const end = Math.min(ring.next, Math.ceil(to / ring.bin_s) + 1, first + DRAWN + 2);
    const count = ring.copy(this.kind.column, first, end, this.#least, this.#largest);
    for (let bin = 0; bin < count; bin++) this.#x[bin] = (first + bin + 0.5) * ring.bin_s;
    return count;
  }

  #make(): uPlot {
    const colours = palette();
    const colour = colours[this.kind.colour];
    const axis = {
      stroke: colours.muted,
      grid: { stroke: colours.grid, width: 1 },
      ticks: { show: false },
      font: "11px system-ui, sans-serif",
    };
    const options: uPlot.Options = {
      width: this.#box.clientWidth,
      height: this.#height,
      legend: { show: false },
      padding: [6, 24, 0, 0],
      scales: { x: { time: false, auto: false }, y: { auto: false } },
      cursor: {
        sync: { key: "strips", scales: ["x", null] },
        drag: { x: true, y: false, setScale: false },
        points: { show: false },
      },
      axes: [
        {
          ...axis,
          size: this.#isRate ? 6 : 24,
          space: 90,
          incrs: STEPS_S,
          values: (_, splits) => this.#times(splits),
        },
        { ...axis, size: 64, space: 26, values: (_, splits) => splits.map((v) => this.#tick(v, splits)) },
      ],
      series: [
        {},
        {
          stroke: colour,
          fill: faint(colour, 0.55),
          width: 1,
          points: { show: false },
          paths: (u) => this.#paths(u),
        },
      ],
      hooks: {
        draw: [(u) => this.#cursors(u, colours.cursor)],
        setCursor: [(u) => this.#pointed(u)],
        setSelect: [(u) => this.#selected(u)],
      },
    };
    const plot = new uPlot(options, [[], []] as unknown as uPlot.AlignedData, this.#box);
    plot.root.setAttribute("aria-hidden", "true");
    this.#listen(plot);
    return plot;
  }

  #times(splits: number[]): string[] {
    const step = Number(((splits[1] ?? 1) - (splits[0] ?? 0)).toFixed(3));
    return splits.map((at) => (!this.#isRate && at >= 0 ? onAxis(at, step) : ""));
  }

  #tick(value: number, splits: number[]): string {
    const step = ((splits[1] ?? 1) - (splits[0] ?? 0)) * this.scale;
    const text = (value * this.scale).toFixed(decimalsOf(step));
    return /[1-9]/.test(text) ? text.replace("-", "\u2212") : text.replace("-", "");
  }

  /** An area from the largest to the least value of each bin. Bins without neighbours get the width of a bin. */
  #paths(u: uPlot): uPlot.Series.Paths {
    const area = new Path2D();
    for (let bin = 0; bin < this.#count; bin++) {
      if (Number.isNaN(this.#least[bin]!)) continue;
      let end = bin + 1;
      while (end < this.#count && !Number.isNaN(this.#least[end]!)) end++;
      this.#outline(u, area, bin, end);
      bin = end;
    }
    return { stroke: area, fill: area };
  }

  #outline(u: uPlot, area: Path2D, from: number, end: number): void {
    const x = (bin: number) => u.valToPos(this.#x[bin]!, "x", true);
    const y = (of: Float64Array, bin: number) => u.valToPos(of[bin]!, "y", true);
    if (end - from === 1) return this.#alone(area, x(from), y(this.#largest, from), y(this.#least, from), u);
    area.moveTo(x(from), y(this.#largest, from));
    for (let bin = from + 1; bin < end; bin++) area.lineTo(x(bin), y(this.#largest, bin));
    for (let bin = end - 1; bin >= from; bin--) area.lineTo(x(bin), y(this.#least, bin));
  }

  /** Draws a bin between empty bins, as when samples are rarer than bins. It gets a width, so that it is visible. */
  #alone(area: Path2D, x: number, top: number, bottom: number, u: uPlot): void {
    const { window } = this.shared;
    const bin = ((this.#ring?.bin_s ?? 0) / (window.to - window.from)) * u.bbox.width;
    const width = Math.max(bin, LEAST_WIDTH * devicePixelRatio);
    area.rect(x - width / 2, top, width, bottom - top);
  }

  #cursors(u: uPlot, colour: string): void {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    for (const name of ["A", "B"] as const) {
      const at = this.shared.cursors[name];
      if (at === undefined || at < this.shared.window.from || at > this.shared.window.to) continue;
      const x = u.valToPos(at, "x", true);
      ctx.strokeStyle = ctx.fillStyle = colour;
      ctx.fillText(name, x + 3 * devicePixelRatio, bbox.top + 11 * devicePixelRatio);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.strokeStyle = faint(colour, 0.25);
    ctx.strokeRect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.restore();
  }

  #pointed(u: uPlot): void {
    const left = u.cursor.left ?? -1;
    this.shared.hover = left < 0 ? undefined : u.posToVal(left, "x");
    this.shared.changed();
  }

  #selected(u: uPlot): void {
    const { left, width } = u.select;
    if (width < 4) return;
    this.shared.window.hold(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.shared.changed();
  }

  #listen(plot: uPlot): void {
    let pressed = 0;
    plot.over.addEventListener("mousedown", (event) => {
      pressed = event.clientX;
    });
    plot.over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - pressed) > 3) return;
      this.shared.cursors[event.shiftKey ? "B" : "A"] = plot.posToVal(event.offsetX, "x");
      this.shared.changed();
    });
    plot.over.addEventListener("dblclick", () => {
      this.shared.window.live();
      this.shared.changed();
    });
    plot.over.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey && !event.shiftKey && document.activeElement !== this.element.parentElement) return;
        event.preventDefault();
        if (event.shiftKey) this.shared.window.pan(Math.sign(event.deltaY || event.deltaX) * 0.1);
        else this.shared.window.zoom(event.deltaY > 0 ? 1.25 : 0.8, plot.posToVal(event.offsetX, "x"));
        this.shared.changed();
      },
      { passive: false },
    );
  }
}
