import type { App } from "../app";
import { levelFor, SPANS, TimeWindow } from "../chart/window";
import { Strip, type StripKind } from "../chart/strip";
import { duration, moment, significant } from "../digits";
import { button, Choice, h, mark, say } from "../dom";
import { settings } from "../settings";

const KINDS: StripKind[] = [
  {
    column: "rate",
    title: "Rate, raw",
    colour: "raw",
    least: 0.05,
    nothing: "no samples yet",
  },
  {
    column: "corrected",
    title: "Rate, corrected",
    colour: "corrected",
    least: 0.05,
    nothing: "no calibration is applied; make one under Calibrate, or apply one under Device",
  },
  {
    column: "temp",
    title: "Temperature",
    colour: "temp",
    least: 0.05,
    nothing: "no temperature yet",
  },
];

const HELP =
  "Drag, or turn the wheel with Ctrl, to zoom; the wheel with Shift moves. A click sets cursor A, with Shift cursor B. " +
  "Keys: arrows move, + and − zoom, space holds, Escape follows, A and B set cursors.";

export class Strips {
  readonly element: HTMLElement;
  axis = 0;
  readonly #window = new TimeWindow();
  readonly #shared = {
    window: this.#window,
    cursors: { A: undefined, B: undefined } as Record<"A" | "B", number | undefined>,
    hover: undefined as number | undefined,
    changed: () => this.#changed(),
  };
  readonly #strips = KINDS.map((kind) => new Strip(kind, this.#shared));
  readonly #spans: Choice<string>;
  readonly #hold = button("Hold", () => this.#toggle(), { "aria-pressed": "false", class: "hold" });
  readonly #cursors = h("p", { class: "cursors" });
  readonly #summary = h("p", { class: "unseen" });
  #stale = false;

  constructor(readonly app: App) {
    this.#spans = new Choice(
      "Time on view",
      SPANS.map((span) => [String(span), duration(span)] as const),
      "10",
      (span) => {
        this.#window.choose(Number(span));
        this.#changed();
      },
    );
    const group = h(
      "div",
      { class: "strips", tabindex: 0, role: "group", "aria-label": `Strip charts. ${HELP}` },
      this.#summary,
      ...this.#strips.map((strip) => strip.element),
    );
    group.addEventListener("mousedown", () => group.focus({ preventScroll: true }));
    group.addEventListener("keydown", (event) => {
      if (this.key(event)) event.preventDefault();
    });
    this.element = h(
      "section",
      { class: "card live", "aria-label": "Strip charts" },
      this.#controls(),
      group,
      this.#cursors,
      h("p", { class: "note keys" }, HELP),
    );
  }

  update(isNew: boolean, all: boolean): void {
    const levels = this.app.model.rings[this.axis] ?? [];
    const finest = levels[0];
    if (finest) this.#window.follow(finest.next * finest.bin_s);
    if (!all && !this.#stale && (!isNew || this.#window.held)) return;
    this.#stale = false;
    const ring = levelFor(levels, this.#window.from, this.#window.to);
    for (const strip of this.#strips) strip.draw(ring);
    this.#tell();
  }

  restyle(): void {
    for (const strip of this.#strips) strip.remake();
    this.#stale = true;
  }

  key(event: KeyboardEvent): boolean {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const does = this.#keys()[event.key];
    does?.();
    if (does) this.#changed();
    return does !== undefined;
  }

  /** Updates the text for users who do not see the charts. */
  summarise(): void {
    say(this.#summary, this.#strips.map((strip) => strip.summary()).join(". "));
  }

  #keys(): Record<string, () => void> {
    const middle = () => this.#shared.hover ?? (this.#window.from + this.#window.to) / 2;
    const zoom = (factor: number) => () => this.#window.zoom(factor, this.#shared.hover);
    const live = () => this.#window.live();
    return {
      ArrowLeft: () => this.#window.pan(-0.2),
      ArrowRight: () => this.#window.pan(0.2),
      "+": zoom(0.5),
      "=": zoom(0.5),
      "-": zoom(2),
      "\u2212": zoom(2),
      " ": () => this.#toggle(),
      Escape: live,
      Home: live,
      "0": live,
      a: () => {
        this.#shared.cursors.A = middle();
      },
      b: () => {
        this.#shared.cursors.B = middle();
      },
      c: () => this.#clear(),
    };
  }

  #controls(): HTMLElement {
    const zoom = (words: string, sign: string, factor: number) =>
      button(
        sign,
        () => {
          this.#window.zoom(factor);
          this.#changed();
        },
        { "aria-label": words, class: "sign" },
      );
    const units = new Choice(
      "Unit of rates",
      [
        ["dps", "°/s"],
        ["dph", "°/h"],
      ],
      settings.unit,
      (unit) => settings.setUnit(unit),
    );
    return h(
      "div",
      { class: "controls" },
      this.#spans.element,
      zoom("Zoom in", "+", 0.5),
      zoom("Zoom out", "−", 2),
      this.#hold,
      units.element,
    );
  }

  #clear(): void {
    this.#shared.cursors.A = this.#shared.cursors.B = undefined;
  }

  #toggle(): void {
    if (this.#window.held) this.#window.live();
    else this.#window.hold();
    this.#changed();
  }

  #changed(): void {
    this.#stale = true;
    mark(this.#hold, "aria-pressed", String(this.#window.held));
    say(this.#hold, this.#window.held ? "Follow" : "Hold");
    this.#spans.set(
      SPANS.some((span) => Math.abs(span - this.#window.span_s) < 1e-9) ? String(this.#window.span_s) : null,
    );
  }

  #tell(): void {
    const { A, B } = this.#shared.cursors;
    if (A === undefined && B === undefined) return say(this.#cursors, "Cursors: none set");
    const at = (name: string, time: number | undefined) =>
      time === undefined ? "" : `${name} at ${moment(time, 3)}: ${this.#values(5, (strip) => strip.middle(time))}`;
    const difference = (A: number, B: number) => this.#values(4, (strip) => strip.middle(B) - strip.middle(A));
    const between =
      A !== undefined && B !== undefined ? `B − A: ${significant(B - A, 5)} s, ${difference(A, B)}` : "";
    say(this.#cursors, [at("A", A), at("B", B), between].filter((words) => words !== "").join("  ·  "));
  }

  /** A number of each strip with its unit, except where it is NaN because a cursor is not on view. */
  #values(digits: number, of: (strip: Strip) => number): string {
    const known = this.#strips.filter((strip) => !Number.isNaN(of(strip)));
    return known.map((strip) => `${significant(of(strip), digits)} ${strip.unit}`).join(", ") || "not on view";
  }
}
