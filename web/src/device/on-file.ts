import type { App } from "../app";
import * as digits from "../digits";
import { button, h, sure } from "../dom";
import { downloads } from "../downloads";
import { droppable } from "../drop";
import { storage } from "../storage";
import type { CalibrationEntry } from "../protocol";
import { settings } from "../settings";

/** The largest calibration file, bytes. A calibration is a page of text. */
const LARGEST = 1 << 20;

/** The calibrations on file, which one is applied, and a place to drop more. */
export class OnFile {
  readonly element: HTMLElement;
  readonly #list = h("ul", { class: "on-file" });
  readonly #none: HTMLButtonElement;

  constructor(readonly app: App) {
    this.#none = button("Apply none", () => void app.ask({ do: "apply", calibration: null }), { class: "small" });
    const where = app.inside
      ? "They are kept in this browser."
      : "zerorate serve holds them, and keeps them on disk if it was started with --folder.";
    const drop = droppable("A calibration (TOML)", ".toml", (files) =>
      files.forEach((file) => void this.#add(file)),
    );
    this.element = h(
      "section",
      { class: "card", "aria-label": "Calibrations on file" },
      h("div", { class: "row" }, h("h2", {}, "Calibrations on file"), this.#none),
      this.#list,
      drop,
      h("p", { class: "note" }, where),
    );
  }

  update(entries: CalibrationEntry[]): void {
    this.#none.disabled = !entries.some((entry) => entry.applied);
    const rows = [...entries].reverse().map((entry) => this.#row(entry));
    const none = h("li", { class: "none" }, "None yet: make one under Calibrate, or drop one here.");
    this.#list.replaceChildren(...(rows.length > 0 ? rows : [none]));
  }

  #row(entry: CalibrationEntry): HTMLElement {
    const apply = button(
      entry.applied ? "Applied" : "Apply",
      () => void this.app.ask({ do: "apply", calibration: entry.id }),
      { class: "small", disabled: entry.applied },
    );
    const remove = button("Remove", () => void this.#remove(entry), { class: "small", disabled: entry.applied });
    return h(
      "li",
      { class: entry.applied ? "applied" : "" },
      h(
        "div",
        {},
        h("b", {}, entry.serial ?? "no serial number"),
        " ",
        h("code", {}, entry.id.slice(0, 12)),
        h("p", {}, numbers(entry)),
        h("p", { class: "note" }, origin(entry)),
      ),
      h("div", { class: "row" }, apply, downloads(this.app, entry.id), remove),
    );
  }

  async #remove({ id, serial, toml }: CalibrationEntry): Promise<void> {
    const name = serial ?? id.slice(0, 12);
    if (!(await sure(`Remove the calibration of ${name} from the list?`, "Remove it", "Keep it"))) return;
    if (await this.app.ask({ do: "remove-calibration", calibration: id })) storage.forgetCalibration(toml);
  }

  async #add(file: File): Promise<void> {
    if (file.size > LARGEST) return this.app.tell(`${file.name} is too large for a calibration.`, "wrong");
    const reply = await this.app.ask({ do: "add-calibration", toml: await file.text() });
    if (reply) this.app.tell(`${file.name} is on file.`);
  }
}

function numbers({ pbc_dps, btc_dps_per_c, t3_c }: CalibrationEntry): string {
  const { scale, unitText } = settings;
  return [
    `PBC ${digits.significant(pbc_dps * scale, 4)} ${unitText}`,
    `BTC ${digits.significant(btc_dps_per_c * scale, 4)} ${unitText}/°C`,
    `T3 ${digits.value(t3_c, 0.1)} °C`,
  ].join(" · ");
}

function origin({ method, created, range_c }: CalibrationEntry): string {
  const range = range_c && `${digits.significant(range_c[0], 3)} … ${digits.significant(range_c[1], 3)} °C`;
  return [method, created, range].filter((text) => text).join(" · ");
}
