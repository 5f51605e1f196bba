import type { App } from "../app";
import { Strip, type StripKind } from "../chart/strip";
import { levelFor, TimeWindow } from "../chart/window";
import { duration, half, uncertainty, value } from "../digits";
import { button, coded, facts, h, mark, say, sure } from "../dom";
import type { Part } from "../model";
import type { Calibrating, Running, Step } from "../protocol";
import { settings } from "../settings";
import type { Stage } from "./calibrate";
import { titleOf } from "./methods";

const KINDS: readonly StripKind[] = [
  {
    column: "rate",
    title: "Rate",
    colour: "raw",
    least: 0.01,
    nothing: "no rate yet",
  },
  {
    column: "temp",
    title: "Temperature",
    colour: "temp",
    least: 0.2,
    nothing: "no temperature yet",
  },
];

/** The view of a running calibration: the advice, the steps, and the refusals if it ended now. */
export class Run implements Stage {
  readonly element: HTMLElement;
  readonly #title = h("h1", {});
  readonly #advice = h("p", { class: "advice", role: "status" });
  readonly #left = h("p", { class: "left" });
  readonly #bar = h("progress", { max: 1, value: 0, "aria-label": "Progress of the calibration" });
  readonly #steps = h("ol", { class: "steps" });
  readonly #refusals = h("ul", { class: "pending-refusals" });
  readonly #facts = h("dl", { class: "facts" });
  readonly #finish: HTMLButtonElement;
  readonly #watch: HTMLElement;
  readonly #window = new TimeWindow();
  readonly #traces: Strip[];
  #planned = "";
  #shown = "";

  constructor(readonly app: App) {
    this.#traces = KINDS.map((kind) => this.#strip(kind));
    this.#finish = button("Finish now", () => void app.ask({ do: "finish-calibration" }));
    const abort = button("Abort", () => void this.#abort(), { class: "quiet" });
    const card = (name: string, title: string, ...children: Node[]) =>
      h("section", { class: `card ${name}` }, h("h2", {}, title), ...children);
    const title = "What would be refused if it ended now";
    this.#watch = card("watch", title, h("div", { role: "status" }, this.#refusals));
    this.element = h(
      "div",
      { class: "run" },
      this.#title,
      card("now", "Now", this.#advice, this.#bar, h("div", { class: "actions" }, this.#left, this.#finish, abort)),
      card("plan", "Steps", this.#steps),
      this.#watch,
      h("section", { class: "card trace" }, ...this.#traces.map((trace) => trace.element), this.#facts),
    );
  }

  update(calibration: Calibrating, changed: ReadonlySet<Part>): void {
    if (calibration.is !== "running") return;
    if (changed.has("calibration")) this.#tell(calibration);
    if (changed.has("strips")) this.#draw(calibration);
  }

  restyle(): void {
    for (const trace of this.#traces) trace.remake();
  }

  leave(): void {
    for (const trace of this.#traces) trace.destroy();
  }

  #strip(kind: StripKind): Strip {
    const none = { cursors: { A: undefined, B: undefined }, hover: undefined };
    const changed = () => {
      for (const trace of this.#traces) trace.tell();
    };
    return new Strip(kind, { window: this.#window, ...none, changed });
  }

  #tell(run: Running): void {
    const whole_s = run.elapsed_s + run.left_s;
    say(this.#title, `Calibrating: ${titleOf(run.method)}`);
    say(this.#advice, run.advice);
    const least = run.method === "chamber" ? "at least " : "";
    say(this.#left, `${least}${duration(run.left_s)} left, ${duration(run.elapsed_s)} done`);
    this.#bar.value = whole_s > 0 ? Math.min(1, run.elapsed_s / whole_s) : 0;
    this.#finish.hidden = run.method === "an1042" || run.method === "chamber";
    this.#watch.hidden = run.method === "chamber";
    this.#finish.disabled = !run.can_finish;
    mark(this.#finish, "class", run.is_enough ? "primary" : null);
    this.#plan(run);
    this.#warn(run.pending_refusals, this.#finish.hidden || run.can_finish);
    facts(this.#facts, temperatures(run));
  }

  #plan({ method, steps, elapsed_s }: Running): void {
    const planned = JSON.stringify(steps);
    if (planned !== this.#planned) {
      this.#planned = planned;
      this.#steps.replaceChildren(
        ...steps.map((step) => h("li", {}, h("span", { class: "name" }, step.name), h("span", { class: "time" }))),
      );
    }
    // a step at a set point of the chamber goes on after its time until the sensor has settled
    const isOver = ({ to_s }: Step) => (method === "chamber" ? elapsed_s > to_s : elapsed_s >= to_s);
    const now = steps.findIndex((step) => !isOver(step));
    steps.forEach((step, index) => {
      const row = this.#steps.children[index]!;
      const state = isOver(step) ? "done" : index === now ? "now" : "later";
      const left_s = Math.ceil(step.to_s - elapsed_s);
      const words = {
        done: "done",
        now: left_s > 0 ? `${duration(left_s)} left` : "until it is settled",
        later: `${method === "chamber" ? "at least " : ""}${duration(step.to_s - step.from_s)}`,
      };
      mark(row, "data-state", state);
      mark(row, "aria-current", state === "now" ? "step" : null);
      say(row.lastElementChild!, words[state]);
    });
  }

  #warn(refusals: string[], isKnown: boolean): void {
    const text = JSON.stringify([refusals, isKnown]);
    if (text === this.#shown) return;
    this.#shown = text;
    const rows = refusals.map((refusal) => h("li", { class: "pending-refusal" }, ...coded(refusal)));
    const none = h("li", { class: "none" }, isKnown ? "Nothing." : "Not known in the first minute.");
    this.#refusals.replaceChildren(...(rows.length > 0 ? rows : [none]));
  }

  #draw(run: Running): void {
    const levels = this.app.model.rings[0] ?? [];
    const finest = levels[0];
    if (!finest) return;
    this.#window.span_s = Math.max(10, run.elapsed_s * 1.02);
    this.#window.follow(finest.next * finest.bin_s);
    const level = levelFor(levels, this.#window.from, this.#window.to);
    for (const trace of this.#traces) trace.draw(level);
  }

  async #abort(): Promise<void> {
    const end = await sure("End this calibration without a result?", "End it", "Go on");
    if (end) void this.app.ask({ do: "abort-calibration" });
  }
}

function temperatures({ method, temps_c, forecast }: Running): [string, string][] {
  const names = ["At the beginning", "Now", "Lowest", "Highest"];
  const rows = names.map((name, k): [string, string] => [name, temps_c ? `${value(temps_c[k], 0.02)} °C` : "–"]);
  if (method === "an1042" || method === "chamber") return rows;
  const { scale, unitText } = settings;
  const stated = (u: number | undefined, unit: string) =>
    u === undefined ? "–" : `± ${uncertainty(half(u * scale))} ${unit} (95 %)`;
  const when = forecast ? `if it had ended at ${duration(forecast.at_s)}` : "if it ended now";
  return [
    ...rows,
    [`PBC, ${when}`, stated(forecast?.u_pbc_dps, unitText)],
    [`BTC, ${when}`, stated(forecast?.u_btc_dps_per_c, `${unitText}/°C`)],
  ];
}
