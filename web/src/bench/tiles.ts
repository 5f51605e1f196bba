import type { App } from "../app";
import * as digits from "../digits";
import { button, h, mark, say } from "../dom";
import type { AxisNow, RestVerdict, SampleCounts } from "../protocol";
import { settings } from "../settings";

/** A box of fixed size with a name, a number and a remark. */
class Tile {
  readonly element: HTMLElement;
  readonly #value = h("span", { class: "value" }, "–");
  readonly #unit = h("span", { class: "unit" });
  readonly #below = h("p", { class: "below" });

  constructor(
    readonly kind: string,
    name: string,
    ...more: Node[]
  ) {
    this.element = h(
      "section",
      { class: `tile ${kind}`, "aria-label": name },
      h("h2", {}, h("span", {}, name), ...more),
      h("p", { class: "big" }, this.#value, " ", this.#unit),
      this.#below,
    );
  }

  show(value: string, unit: string, below: string, state: string | null = null): void {
    say(this.#value, value);
    say(this.#unit, unit);
    say(this.#below, below);
    mark(this.element, "data-state", state);
  }
}

const VERDICTS: Record<RestVerdict, [string, string]> = {
  "at-rest": ["at rest", "good"],
  moving: ["moving", "bad"],
  noisy: ["noisy", "warn"],
  step: ["a step", "warn"],
  unjudged: ["not judged", "none"],
};

export class Tiles {
  readonly element: HTMLElement;
  readonly #rate = new Tile("raw", "Rate, raw");
  readonly #corrected = new Tile("corrected", "Rate, corrected");
  readonly #temp = new Tile("temp", "Temperature");
  readonly #angle: Tile;
  readonly #rest = new Tile("rest", "Rest");
  readonly #ledger = new Tile("ledger", "Samples");

  constructor(readonly app: App) {
    const zero = button("Zero", () => void app.ask({ do: "zero-angle" }), {
      class: "small",
      "aria-label": "Zero the angle",
    });
    this.#angle = new Tile("angle", "Angle", zero);
    const tiles = [this.#rate, this.#corrected, this.#temp, this.#angle, this.#rest, this.#ledger];
    this.element = h("div", { class: "tiles" }, ...tiles.map((tile) => tile.element));
  }

  update(axis: number): void {
    const { now, ledger } = this.app.model;
    const values = now?.axes[axis];
    this.#temp.show(digits.value(now?.temp_c, 0.02), "°C", "mean of 1 s");
    this.#rates(values);
    this.#angles(values);
    const [words, state] = VERDICTS[values?.rest.verdict ?? "unjudged"];
    this.#rest.show(words, "", values?.rest.text ?? "", state);
    this.#count(ledger);
  }

  #rates(values: AxisNow | undefined): void {
    const { scale, unitText } = settings;
    const of = (value: number | null | undefined) => (value === null || value === undefined ? null : value * scale);
    const [rate, u] = [of(values?.rate_dps), of(digits.half(values?.u_rate_dps))];
    this.#rate.show(
      digits.value(rate, u),
      unitText,
      u === null ? "mean of 1 s" : `± ${digits.uncertainty(u)} (95 %) · mean of 1 s`,
    );
    const [corrected, uCorrected] = [of(values?.corrected_dps), of(digits.half(values?.u_corrected_dps))];
    const without = rate === null ? "no valid rate in the last second" : "no calibration is applied";
    const below = corrected === null ? without : `± ${digits.uncertainty(uCorrected)} (95 %)`;
    const outside = values?.extrapolated === true;
    this.#corrected.show(
      digits.value(corrected, uCorrected),
      unitText,
      outside ? `${below} · outside its temperatures` : below,
      outside ? "warn" : null,
    );
  }

  #angles(values: AxisNow | undefined): void {
    const u = digits.half(values?.u_angle_deg);
    const below = u === null ? "since it was zeroed" : `± ${digits.uncertainty(u)} (95 %) · since it was zeroed`;
    this.#angle.show(digits.value(values?.angle_deg, u ?? 0.01), "°", below);
  }

  #count(ledger: SampleCounts | undefined): void {
    if (!ledger) return this.#ledger.show("–", "", "");
    const bad: [string, number][] = [
      ["lost", ledger.lost],
      ["impossible", ledger.impossible],
      ["out of range", ledger.out_of_range],
      ["not shown", ledger.missed],
    ];
    const said = bad
      .filter(([, number]) => number > 0)
      .map(([words, number]) => `${digits.count(number)} ${words}`);
    if (ledger.frozen_since_s !== null) said.unshift(`stopped at ${digits.moment(ledger.frozen_since_s, 1)}`);
    const state = said.length > 0 ? "bad" : "good";
    const found = said.length > 0 ? said.join(", ") : "nothing lost";
    const below = `${found} · ${ledger.rate_hz.toFixed(1)} per s for ${digits.duration(ledger.duration_s)}`;
    this.#ledger.show(digits.count(ledger.samples), "", below, state);
  }
}
