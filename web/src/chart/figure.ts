import uPlot from "uplot";
import { superscript } from "../digits";
import { h, say, table } from "../dom";
import { settings } from "../settings";
import { palette, type Palette } from "./palette";

/** The summary of a chart in words, and its numbers as rows. */
export interface Told {
  summary: string;
  head: string[];
  rows: string[][];
}

/** The options that differ between the kinds of charts. */
export type Drawing = Pick<uPlot.Options, "scales" | "axes" | "series" | "bands" | "hooks">;

const FRAME = {
  legend: { show: false },
  cursor: { show: false },
  padding: [8, 18, 0, 0] as uPlot.Padding,
};

/** A chart that gets all its numbers with each change. A table below it holds the numbers. */
export abstract class Figure<T> {
  readonly element: HTMLElement;
  protected readonly note = h("p", { class: "note" });
  readonly #summary = h("p", { class: "unseen" });
  readonly #box = h("div", { class: "plot" });
  readonly #nothing = h("p", { class: "nothing" });
  readonly #table = h("div", { class: "numbers", tabindex: 0, role: "region", "aria-label": "Numbers" });
  readonly #details: HTMLDetailsElement;
  readonly #resized = new ResizeObserver(() => this.#fit());
  #plot: uPlot | undefined;
  protected data: T | undefined;

  constructor(
    readonly title: string,
    readonly height: number,
    nothing: string,
    extra: Node[] = [],
  ) {
    say(this.#nothing, nothing);
    this.#details = h("details", { toggle: () => this.#tabulate() }, h("summary", {}, "Numbers"), this.#table);
    this.element = h(
      "figure",
      { class: "figure" },
      h("figcaption", {}, h("span", { class: "name" }, title), ...extra),
      this.#summary,
      h("div", { class: "canvas" }, this.#box, this.#nothing),
      this.note,
      this.#details,
    );
    this.#box.style.setProperty("--height", `${height}px`);
    this.#resized.observe(this.#box);
  }

  show(data: T | undefined): void {
    this.data = data;
    this.#draw();
  }

  /** Redraws the chart, after a change of theme or unit. */
  remake(): void {
    this.#plot?.destroy();
    this.#plot = undefined;
    this.#draw();
  }

  destroy(): void {
    this.#resized.disconnect();
    this.#plot?.destroy();
    this.#plot = undefined;
  }

  protected abstract isThere(data: T): boolean;
  protected abstract drawing(colours: Palette): Drawing;
  protected abstract columns(data: T): (number | null)[][];
  protected abstract told(data: T): Told;

  #draw(): void {
    const data = this.data;
    const there = data !== undefined && this.isThere(data);
    this.#nothing.hidden = there;
    if (!there) say(this.#summary, this.#nothing.textContent ?? "");
    if (!there || this.#box.clientWidth === 0) return;
    this.#plot ??= this.#make();
    this.#plot.setData(this.columns(data) as uPlot.AlignedData);
    say(this.#summary, this.told(data).summary);
    this.#tabulate();
  }

  #make(): uPlot {
    const size = { width: this.#box.clientWidth, height: this.height };
    const plot = new uPlot({ ...FRAME, ...this.drawing(palette()), ...size }, [[]], this.#box);
    plot.root.setAttribute("aria-hidden", "true");
    return plot;
  }

  #fit(): void {
    if (this.#box.clientWidth === 0) return;
    if (this.#plot) this.#plot.setSize({ width: this.#box.clientWidth, height: this.height });
    else this.#draw();
  }

  #tabulate(): void {
    if (!this.#details.open || this.data === undefined) return;
    const { head, rows } = this.told(this.data);
    const at = this.#table.scrollTop;
    this.#table.replaceChildren(table(this.title, head, rows));
    this.#table.scrollTop = at;
  }
}

export function axis(colours: Palette, label: string, more: uPlot.Axis = {}): uPlot.Axis {
  return {
    stroke: colours.muted,
    grid: { stroke: colours.grid, width: 1 },
    ticks: { show: false },
    font: "11px system-ui, sans-serif",
    labelFont: "11px system-ui, sans-serif",
    label,
    labelSize: 16,
    labelGap: 0,
    ...more,
  };
}

/** A band between the first two columns of values, filled in this colour, and lines of the columns after them. */
export function banded(fill: string, ...lines: uPlot.Series[]): Pick<Drawing, "series" | "bands"> {
  const edge = (): uPlot.Series => ({ stroke: "transparent", points: { show: false } });
  return { series: [{}, edge(), edge(), ...lines], bands: [{ series: [1, 2], fill }] };
}

export function dotted(colour: string, width: number): uPlot.Series {
  return { stroke: colour, width, points: { show: true, size: 5, fill: colour } };
}

export function expected(colours: Palette): uPlot.Series {
  return { stroke: colours.model, width: 1.5, dash: [6, 4], points: { show: false } };
}

export function overTemperature(colours: Palette, label: string): Pick<Drawing, "scales" | "axes"> {
  const values = (_: uPlot, splits: number[]) => splits.map(tick);
  return {
    scales: {
      x: { time: false, range: (_, least, largest) => padded(least, largest, 0.1) },
      y: { range: (_, least, largest) => padded(least, largest, 0.002 * settings.scale) },
    },
    axes: [
      axis(colours, "temperature, °C", { size: 26, values }),
      axis(colours, `${label}, ${settings.unitText}`, { size: 58, values }),
    ],
  };
}

/** The range of whole decades around positive numbers. */
export function decades(least: number, largest: number): [number, number] {
  if (!(least > 0) || !(largest > 0)) return [1e-3, 1];
  const low = Math.floor(Math.log10(least * 1.0001));
  const high = Math.ceil(Math.log10(largest * 0.9999));
  return [10 ** low, 10 ** Math.max(high, low + 1)];
}

function wholeDecades(_: uPlot, __: number, least: number, largest: number): number[] {
  const first = Math.ceil(Math.log10(least) - 1e-9);
  const last = Math.floor(Math.log10(largest) + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => 10 ** (first + k));
}

/** Labels at whole decades, and none between: `0.01` to `1000`, and beyond these like `10⁻³`. */
function decadeTick(value: number | null): string {
  if (value === null) return "";
  const power = Math.log10(value);
  if (Math.abs(power - Math.round(power)) > 1e-6) return "";
  const whole = Math.round(power);
  if (whole >= -2 && whole <= 3) return String(Number((10 ** whole).toPrecision(1)));
  return `10${superscript(whole)}`;
}

export const DECADES: uPlot.Axis = { splits: wholeDecades, values: (_, splits) => splits.map(decadeTick) };

/** The label of a number on a linear axis. */
function tick(value: number | null): string {
  return value === null ? "" : String(Number(value.toPrecision(6))).replace("-", "\u2212");
}

function padded(least: number | null, largest: number | null, floor: number): [number, number] {
  if (least === null || largest === null) return [0, 1];
  const by = Math.max((largest - least) * 0.08, floor);
  return [least - by, largest + by];
}
