import type { App } from "../app";
import { h, say } from "../dom";
import type { CalibrateWish, MethodName } from "../protocol";
import type { Stage } from "./calibrate";
import { METHODS, type Method } from "./methods";

type Duration = "average_s" | "warmup_s" | "settle_s" | "offset_s";

/** The durations, with what is taken where nothing is given, s (F-51). */
const DURATIONS: readonly (readonly [Duration, string, number])[] = [
  ["average_s", "Averages at both temperatures, s", 10],
  ["warmup_s", "Warm-up between them, s", 600],
  ["settle_s", "Thermal balance, s", 2400],
  ["offset_s", "Mean of the offset, s", 150],
];

/** The Earth's rotation, °/s (F-16). */
const EARTH_DPS = 0.00418;

/** Which method, and how. */
export class Choosing implements Stage {
  readonly element: HTMLElement;
  readonly #durations = new Map<Duration, HTMLInputElement>();
  readonly #serial = h("input", { id: "serial", type: "text", maxlength: 64, autocomplete: "off" });
  readonly #latitude = h("input", { id: "latitude", type: "number", min: -90, max: 90, step: "any" });
  readonly #start = h("button", { type: "submit", class: "primary" }, "Start");
  readonly #ready = h("p", { class: "note", role: "status" });
  #method: MethodName = "an1042";

  constructor(readonly app: App) {
    const methods = h(
      "fieldset",
      { class: "methods" },
      h("legend", {}, "Which method?"),
      ...METHODS.map((method) => this.#card(method)),
    );
    const begin = (event: Event) => {
      event.preventDefault();
      void this.#begin();
    };
    this.element = h(
      "form",
      { class: "choosing", submit: begin },
      h("h1", {}, "Calibrate"),
      methods,
      before(),
      this.#settings(),
      h("div", { class: "actions" }, this.#start, this.#ready),
    );
  }

  update(): void {
    const reading = this.app.model.device?.state.is === "reading";
    this.#start.disabled = !reading;
    say(this.#ready, reading ? "" : "It can start when samples come.");
  }

  restyle(): void {}

  #card({ name, title, what, when }: Method): HTMLElement {
    const input = h("input", {
      type: "radio",
      name: "method",
      value: name,
      change: () => {
        this.#method = name;
      },
    });
    input.checked = name === this.#method;
    return h(
      "label",
      { class: "method" },
      input,
      h("span", { class: "title" }, title, " ", h("code", {}, name)),
      h("span", {}, what),
      h("span", { class: "when" }, when),
    );
  }

  #settings(): HTMLElement {
    const field = (id: string, words: string, input: HTMLInputElement) =>
      h("div", { class: "field" }, h("label", { for: id }, words), input);
    const durations = DURATIONS.map(([key, words, otherwise]) => {
      const input = h("input", {
        id: key,
        type: "number",
        min: 1,
        max: 86_400,
        step: "any",
        placeholder: otherwise,
      });
      this.#durations.set(key, input);
      return field(key, words, input);
    });
    return h(
      "details",
      { class: "card settings" },
      h("summary", {}, "Serial number, durations, the Earth’s rotation"),
      h(
        "div",
        { class: "fields" },
        field("serial", "Serial number of the part", this.#serial),
        ...durations,
        field("latitude", "Latitude, °, if the axis is vertical", this.#latitude),
      ),
      h(
        "p",
        { class: "note" },
        "With a latitude the Earth’s rotation on the axis is taken out of the bias; without one it stays in it.",
      ),
    );
  }

  async #begin(): Promise<void> {
    const wish: CalibrateWish = { method: this.#method };
    for (const [key, input] of this.#durations) if (input.value !== "") wish[key] = Number(input.value);
    if (this.#serial.value.trim() !== "") wish.serial = this.#serial.value.trim();
    const latitude = this.#latitude.value;
    if (latitude !== "") wish.earth_dps = EARTH_DPS * Math.sin((Number(latitude) * Math.PI) / 180);
    this.#start.disabled = true;
    const given = await this.app.ask({ do: "calibrate", ...wish });
    this.#start.disabled = given !== undefined;
  }
}

function before(): HTMLElement {
  const lines = [
    "Fix the part to something that does not move: a heavy table, no fan, no feet.",
    "Let it be cold: off for half an hour, then on just now.",
    "Feed it from a linear +5 V supply; a switching one shifts its bias.",
    "Leave it alone until this page says that it is done. The page may be closed meanwhile: the session goes on.",
  ];
  return h(
    "section",
    { class: "card before" },
    h("h2", {}, "Before you start"),
    h("ol", {}, ...lines.map((line) => h("li", {}, line))),
  );
}
