import type { App, Page } from "../app";
import { duration } from "../digits";
import { button, facts, h, mark, say } from "../dom";
import type { Part } from "../model";
import type { CheckResult, Device, SampleCounts } from "../protocol";
import { OnFile } from "./on-file";
import { Opener } from "./opener";
import { Registers } from "./registers";
import { wiring } from "./wiring";

const STATES = { opening: "The device is being opened.", reading: "Samples arrive.", ended: "The recording ended." };

export class DevicePage implements Page {
  readonly element: HTMLElement;
  readonly #name = h("p", { class: "name" });
  readonly #state = h("p", { class: "state", role: "status" });
  readonly #checks = h("ul", { class: "checks" });
  readonly #rates = h("dl", { class: "facts" });
  readonly #registers = new Registers();
  readonly #onFile: OnFile;

  constructor(readonly app: App) {
    this.#onFile = new OnFile(app);
    const again = button("Open again", () => void app.ask({ do: "reopen" }), { class: "small" });
    const opener = app.inside ? [new Opener(app, app.inside).element] : [];
    const card = (title: string, ...children: Node[]) =>
      h("section", { class: "card", "aria-label": title }, h("h2", {}, title), ...children);
    this.element = h(
      "div",
      { class: "page device" },
      h("h1", { class: "unseen" }, "Device"),
      ...opener,
      h(
        "div",
        { class: "two" },
        card("Connection", h("div", { class: "row" }, this.#name, again), this.#state, this.#checks),
        card("Measured rates", this.#rates),
      ),
      this.#onFile.element,
      card("Registers", this.#registers.element),
      card("Wiring", wiring()),
    );
  }

  update(changed: ReadonlySet<Part>, all: boolean): void {
    const { device, ledger } = this.app.model;
    if (all || changed.has("device")) this.#tell(device);
    if (all || changed.has("ledger") || changed.has("device")) facts(this.#rates, rates(device, ledger));
    if (all || changed.has("calibrations")) this.#onFile.update(this.app.model.calibrations);
  }

  restyle(): void {
    this.#onFile.update(this.app.model.calibrations);
  }

  #tell(device: Device | undefined): void {
    const state = device?.state;
    say(this.#name, device ? `${device.name} (${device.part})` : "No device yet");
    say(this.#state, state === undefined ? "" : state.is === "failed" ? state.why : STATES[state.is]);
    mark(this.#state, "data-state", state?.is ?? null);
    this.#checks.replaceChildren(...(device?.checks ?? []).map(check));
    this.#registers.update(device?.registers ?? []);
  }
}

function rates(device: Device | undefined, ledger: SampleCounts | undefined): [string, string][] {
  const hz = (rate: number | null | undefined) => (rate ? `${rate.toFixed(1)} Hz` : "–");
  const axis = device?.axes[0];
  return [
    ["Samples", hz(ledger?.rate_hz)],
    ["Edges of data ready", hz(ledger?.rdy_hz)],
    ["Conversions, nominal", hz(device?.nominal_hz)],
    ["Bandwidth, −3 dB", hz(axis?.bandwidth_hz)],
    ["Resonance", hz(axis?.resonance_hz)],
    ["Range", axis?.range_dps ? `± ${axis.range_dps} °/s` : "–"],
    ["Read for", ledger ? duration(ledger.duration_s) : "–"],
    ["Software", device?.software ?? "–"],
  ];
}

function check({ what, ok, text }: CheckResult): HTMLElement {
  return h(
    "li",
    { class: ok ? "good" : "bad" },
    h("span", { class: "sign", "aria-hidden": "true" }, ok ? "✓" : "✗"),
    h("div", {}, h("b", {}, h("span", { class: "unseen" }, ok ? "well: " : "not well: "), what), h("p", {}, text)),
  );
}
