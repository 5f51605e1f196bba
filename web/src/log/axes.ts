import { Allan } from "../chart/allan";
import { significant } from "../digits";
import { h } from "../dom";
import type { LogAxis, LogCoefficient, LogPoint, LogValue } from "../protocol";
import { warnings } from "./about";

/** The deviation of a column of a log, in its own unit. */
class LogAllan extends Allan {
  constructor(
    title: string,
    readonly text: string,
  ) {
    super(title, 240, "too short for a deviation");
  }

  protected override unit(): { text: string; scale: number } {
    return { text: this.text, scale: 1 };
  }
}

/** The axes of a log; each appears when its analysis is done. */
export class Axes {
  readonly element = h("div", { class: "two axes-of-log" });
  #figures: LogAllan[] = [];

  begin(): void {
    for (const figure of this.#figures) figure.destroy();
    this.#figures = [];
    this.element.replaceChildren();
  }

  add(axis: LogAxis): void {
    const { name, unit } = axis.column;
    const figure = new LogAllan(name, unit ?? "its own unit");
    this.#figures.push(figure);
    this.element.append(
      h("section", { class: "card", "aria-label": name }, figure.element, coefficients(axis), ...remarks(axis)),
    );
    figure.show(axis.points.map(point));
  }

  restyle(): void {
    for (const figure of this.#figures) figure.remake();
  }
}

function point({ tau_s, dev, lo, hi, model }: LogPoint) {
  return { tau_s, dev_dps: dev, lo_dps: lo, hi_dps: hi, model_dps: model };
}

function coefficients({ column, coefficients }: LogAxis): HTMLElement {
  const head = ["Coefficient", "Value with 95 % interval", "State"].map((words) =>
    h("th", { scope: "col" }, words),
  );
  return h(
    "div",
    { class: "coefficients wide", tabindex: 0, role: "region", "aria-label": `Coefficients of ${column.name}` },
    h(
      "table",
      {},
      h("caption", { class: "unseen" }, `Noise coefficients of ${column.name}`),
      h("thead", {}, h("tr", {}, ...head)),
      h("tbody", {}, ...coefficients.map(row)),
    ),
  );
}

function row(coefficient: LogCoefficient): HTMLElement {
  const { symbol, name, values, identified, remark } = coefficient;
  return h(
    "tr",
    {},
    h("th", { scope: "row" }, symbol, h("span", { class: "other" }, name)),
    h("td", { class: "values" }, ...values.map((value) => h("div", {}, words(coefficient, value)))),
    h("td", {}, h("span", { class: identified ? "state good" : "state" }, identified ? "identified" : remark)),
  );
}

function words({ identified }: LogCoefficient, { value, lo, hi, unit }: LogValue): string {
  if (!identified) return `below ${significant(hi, 2)} ${unit}`;
  return `${significant(value, 3)} (${significant(lo, 3)} … ${significant(hi, 3)}) ${unit}`;
}

function remarks({ terms, model_error, doubt, warnings: texts }: LogAxis): HTMLElement[] {
  const said = [
    ...terms,
    ...(model_error === null || model_error < 0.005
      ? []
      : [`The model may be off by ${significant(100 * model_error, 2)} %.`]),
  ];
  const doubted = doubt === null ? [] : [h("p", { class: "doubt" }, doubt)];
  return [...doubted, ...said.map((text) => h("p", { class: "note" }, text)), warnings(texts)];
}
