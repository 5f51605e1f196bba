import { Allan } from "../chart/allan";
import { significant } from "../digits";
import { h } from "../dom";
import type { LogAxis, LogTerm, PointReport } from "../protocol";
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

  add({ axis, terms }: LogAxis): void {
    const figure = new LogAllan(axis.name, axis.unit ?? "its own unit");
    this.#figures.push(figure);
    this.element.append(
      h(
        "section",
        { class: "card", "aria-label": axis.name },
        figure.element,
        ...(terms.length === 0 ? [] : [table(axis.name, terms)]),
        ...remarks(axis),
      ),
    );
    figure.show(axis.points.filter(({ m }) => Number.isInteger(Math.log2(m))).map(point));
  }

  restyle(): void {
    for (const figure of this.#figures) figure.remake();
  }
}

function point({ tau_s, dev, lo, hi, model }: PointReport) {
  return { tau_s, dev_dps: dev, lo_dps: lo, hi_dps: hi, model_dps: model };
}

function table(name: string, terms: LogTerm[]): HTMLElement {
  const head = ["Coefficient", "Value with 95 % interval"].map((words) => h("th", { scope: "col" }, words));
  return h(
    "div",
    { class: "coefficients" },
    h(
      "table",
      {},
      h("caption", { class: "unseen" }, `Noise coefficients of ${name}`),
      h("thead", {}, h("tr", {}, ...head)),
      h("tbody", {}, ...terms.map(row)),
    ),
  );
}

function row({ name, values, identified, remark }: LogTerm): HTMLElement {
  const [letter = name, words] = name.split("  ");
  return h(
    "tr",
    {},
    h("th", { scope: "row" }, letter, ...(words === undefined ? [] : [h("span", { class: "other" }, words)])),
    h(
      "td",
      { class: "values" },
      ...values.map((value) => h("div", {}, value)),
      h("div", { class: identified && !remark ? "state good" : "state" }, remark || "identified"),
    ),
  );
}

function remarks({ fit, rate_hz, rejection, warnings: texts }: LogAxis["axis"]): HTMLElement[] {
  const error = fit?.model_error ?? 0;
  const holds = fit?.f_max_hz ?? rate_hz;
  const said = [
    ...(holds < 0.499 * rate_hz
      ? [`The noise model holds below ${significant(holds, 3)} Hz; above it the sensor's filter shapes the noise.`]
      : []),
    ...(error < 0.005 || rejection !== null ? [] : [`The model may be off by ${significant(100 * error, 2)} %.`]),
  ];
  const doubted = rejection === null ? [] : [h("p", { class: "doubt" }, rejection)];
  return [...doubted, ...said.map((text) => h("p", { class: "note" }, text)), warnings(texts)];
}
