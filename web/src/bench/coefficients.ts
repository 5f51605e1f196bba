import { duration, significant } from "../digits";
import { h, say } from "../dom";
import type { Coefficient, Statistics } from "../protocol";

/** The three rows exist from the beginning, so that nothing moves when they are filled. */
const SYMBOLS = [
  ["N", "angle random walk"],
  ["B", "bias instability"],
  ["K", "rate random walk"],
] as const;

export class Coefficients {
  readonly element: HTMLElement;
  readonly #rows = SYMBOLS.map(([symbol, name]) => ({
    symbol,
    name: h("span", { class: "name" }, name),
    value: h("span", { class: "value" }, "–"),
    state: h("span", { class: "state" }, "not yet"),
  }));
  readonly #caution = h("p", { class: "note caution" });

  constructor() {
    const rows = this.#rows.map(({ symbol, name, value, state }) =>
      h("tr", {}, h("th", { scope: "row" }, symbol), h("td", {}, value, name, " · ", state)),
    );
    const head = h("tr", {}, ...["Symbol", "Value"].map((words) => h("th", { scope: "col" }, words)));
    this.element = h(
      "div",
      { class: "coefficients" },
      h(
        "table",
        {},
        h("caption", { class: "unseen" }, "Noise coefficients"),
        h("thead", { class: "unseen" }, head),
        h("tbody", {}, ...rows),
      ),
      this.#caution,
    );
  }

  update(found: Statistics | undefined): void {
    for (const row of this.#rows) {
      const coefficient = found?.coefficients.find(({ symbol }) => symbol === row.symbol);
      if (coefficient) say(row.name, coefficient.name);
      say(row.value, coefficient ? words(coefficient) : "–");
      say(row.state, coefficient ? state(coefficient) : "not yet");
      row.state.classList.toggle("good", coefficient?.identified === true);
    }
    say(this.#caution, found?.caution ?? "");
  }
}

function words({ identified, value, lo, hi, unit }: Coefficient): string {
  if (!identified) return `${significant(hi, 2)} ${unit} at most`;
  return `${significant(value, 3)} (95 %: ${significant(lo, 2)} … ${significant(hi, 2)}) ${unit}`;
}

function state({ identified, identified_in_s }: Coefficient): string {
  if (identified) return "identified";
  return identified_in_s === null ? "not identified yet" : `identified in ${duration(identified_in_s)}`;
}
