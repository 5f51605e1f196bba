import type { App } from "../app";
import { Curve } from "../chart/curve";
import * as digits from "../digits";
import { button, Choice, coded, h, mark, say } from "../dom";
import { downloads } from "../downloads";
import type { Part } from "../model";
import type { AxisResult, Calibrating, CalibrationResult } from "../protocol";
import { settings } from "../settings";
import type { Stage } from "./calibrate";
import { titleOf } from "./methods";

export class Result implements Stage {
  readonly element = h("div", { class: "result" });
  readonly #curve = new Curve("What is added to the rate", 280, "no curve");
  readonly #apply: HTMLButtonElement;
  readonly #numbers = h("div", {});
  #result: CalibrationResult | undefined;
  #axis = 0;

  constructor(readonly app: App) {
    const apply = () => app.ask({ do: "apply", calibration: this.#result?.entry.id ?? null });
    this.#apply = button("Apply", () => void apply(), { class: "primary" });
  }

  update(calibration: Calibrating, changed: ReadonlySet<Part>): void {
    if (calibration.is !== "done") return;
    if (calibration.entry.id !== this.#result?.entry.id) this.#show(calibration);
    if (!changed.has("calibrations") && !changed.has("calibration")) return;
    const { id } = calibration.entry;
    const applied = this.app.model.calibrations.some((entry) => entry.id === id && entry.applied);
    mark(this.#apply, "disabled", applied ? "" : null);
    say(this.#apply, applied ? "Applied" : "Apply");
  }

  restyle(): void {
    this.#choose(this.#axis);
    this.#curve.remake();
  }

  leave(): void {
    this.#curve.destroy();
  }

  #show(result: CalibrationResult): void {
    this.#result = result;
    const axes = result.axes.map((axis, index) => [String(index), axis.name] as const);
    const choice = new Choice("Axis", axes, "0", (axis) => this.#choose(Number(axis)));
    const again = button("Calibrate again", () => void this.app.ask({ do: "dismiss-calibration" }), {
      class: "quiet",
    });
    this.element.replaceChildren(
      h("h1", {}, `${titleOf(result.method)}: done`),
      ...(axes.length > 1 ? [choice.element] : []),
      this.#numbers,
      h("section", { class: "card" }, this.#curve.element, legend(result)),
      h(
        "section",
        { class: "card" },
        h("h2", {}, "Keep it"),
        downloads(this.app, result.entry.id),
        h("div", { class: "actions" }, this.#apply, again),
      ),
      remarks(result),
    );
    this.#choose(0);
  }

  #choose(index: number): void {
    const axis = this.#result?.axes[index];
    if (!axis) return;
    this.#axis = index;
    this.#numbers.replaceChildren(coefficients(axis), beforeAndAfter(axis));
    this.#curve.show(axis.curve);
  }
}

function legend({ axes }: CalibrationResult): HTMLElement {
  const hasTruth = axes.some((axis) => axis.curve.some((point) => point.truth_dps !== null));
  const truth = " Dashed: the result of a perfect measurement of this twin.";
  return h("p", { class: "note" }, `Line: the correction. Band: the 95 % interval.${hasTruth ? truth : ""}`);
}

function remarks({ warnings, remarks }: CalibrationResult): HTMLElement {
  const rows = (texts: string[]) => texts.map((text) => h("li", {}, ...coded(text)));
  return h(
    "section",
    { class: "card" },
    h("h2", {}, warnings.length > 0 ? "Warnings" : "No warnings"),
    h("ul", { class: "warnings" }, ...rows(warnings)),
    h("ul", { class: "remarks" }, ...rows(remarks)),
  );
}

function coefficients(axis: AxisResult): HTMLElement {
  const { scale, unitText } = settings;
  const tile = (name: string, text: string, unit: string) =>
    h(
      "section",
      { class: "tile", "aria-label": name },
      h("h2", {}, name),
      h("p", { class: "big" }, h("span", { class: "value" }, text), " ", h("span", { class: "unit" }, unit)),
    );
  return h(
    "div",
    { class: "tiles" },
    tile("PBC, offset, ± 95 %", digits.both(axis.pbc_dps * scale, digits.half(axis.u_pbc_dps * scale)), unitText),
    tile(
      "BTC, over temperature, ± 95 %",
      digits.both(axis.btc_dps_per_c * scale, digits.half(axis.u_btc_dps_per_c * scale)),
      `${unitText}/°C`,
    ),
    tile("T3, where it was measured", digits.value(axis.t3_c, 0.01), "°C"),
  );
}

function beforeAndAfter({ before_dps, after_dps, u_pbc_dps }: AxisResult): HTMLElement {
  const { scale, unitText } = settings;
  const text = (dps: number | null) =>
    `${digits.value(dps === null ? null : dps * scale, digits.half(u_pbc_dps * scale))} ${unitText}`;
  return h(
    "p",
    { class: "before-after" },
    "Mean of the last minute: before ",
    h("b", { class: "raw" }, text(before_dps)),
    ", after ",
    h("b", { class: "corrected" }, text(after_dps)),
  );
}
