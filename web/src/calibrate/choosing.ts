import type { App } from "../app";
import { h, say } from "../dom";
import type { CalibrateCommand, Durations } from "../protocol";
import type { Stage } from "./calibrate";
import { meanwhile, METHODS, type Method, PRESELECTED } from "./methods";
import { PlanChoice } from "./plan-choice";

type Duration = keyof Durations;

const DURATIONS: readonly (readonly [Duration, string])[] = [
  ["average_s", "Average at each temperature, s"],
  ["warmup_s", "Warm-up between them, s"],
  ["settle_s", "Wait for thermal balance, s"],
  ["offset_s", "Average for the offset, s"],
];

export class Choosing implements Stage {
  readonly element: HTMLElement;
  readonly #durations = new Map<Duration, HTMLInputElement>();
  readonly #serial = h("input", { id: "serial", type: "text", maxlength: 64, autocomplete: "off" });
  readonly #latitude = h("input", { id: "latitude", type: "number", min: -90, max: 90, step: "any" });
  readonly #start = h("button", { type: "submit", class: "primary" }, "Start");
  readonly #ready = h("p", { class: "note", role: "status" });
  readonly #before = h("ol", {});
  readonly #more = h("summary", {});
  readonly #plan: PlanChoice;
  #method: Method = PRESELECTED;

  constructor(readonly app: App) {
    this.#plan = new PlanChoice(app);
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
      this.#plan.element,
      h("section", { class: "card before" }, h("h2", {}, "Before you start"), this.#before),
      this.#settings(),
      h("div", { class: "actions" }, this.#start, this.#ready),
    );
    this.#choose(this.#method);
  }

  update(): void {
    const reading = this.app.model.device?.state.is === "reading";
    this.#start.disabled = !reading;
    const usual = this.app.model.device?.durations;
    for (const [key, input] of this.#durations) input.placeholder = usual === undefined ? "" : String(usual[key]);
    this.#plan.update();
    say(this.#ready, reading ? "" : "It can start as soon as samples arrive.");
  }

  #choose(method: Method): void {
    this.#method = method;
    const before = [...method.before, meanwhile(this.app.inside !== undefined)];
    this.#before.replaceChildren(...before.map((line) => h("li", {}, line)));
    const byPlan = method.name === "chamber";
    this.#plan.element.hidden = !byPlan;
    say(this.#more, byPlan ? "Serial number, the Earth’s rotation" : "Serial number, durations, the Earth’s rotation");
    for (const input of this.#durations.values()) input.parentElement!.hidden = byPlan;
  }

  #card(method: Method): HTMLElement {
    const { name, title, what, when } = method;
    const change = () => this.#choose(method);
    const input = h("input", { type: "radio", name: "method", value: name, change });
    input.checked = method === this.#method;
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
    const durations = DURATIONS.map(([key, words]) => {
      const input = h("input", {
        id: key,
        type: "number",
        min: 1,
        max: 86_400,
        step: "any",
      });
      this.#durations.set(key, input);
      return field(key, words, input);
    });
    return h(
      "details",
      { class: "card settings" },
      this.#more,
      h(
        "div",
        { class: "fields" },
        field("serial", "Serial number of the sensor", this.#serial),
        ...durations,
        field("latitude", "Latitude, °, if the axis is vertical", this.#latitude),
      ),
      h(
        "p",
        { class: "note" },
        "With a latitude, the Earth’s rotation about the axis is subtracted. Without one, it stays in the bias.",
      ),
    );
  }

  async #begin(): Promise<void> {
    const command: CalibrateCommand = { method: this.#method.name };
    if (command.method === "chamber") command.plan = this.#plan.plan;
    else for (const [key, input] of this.#durations) if (input.value !== "") command[key] = Number(input.value);
    if (this.#serial.value.trim() !== "") command.serial = this.#serial.value.trim();
    const latitude = this.#latitude.value;
    if (latitude !== "") command.latitude_deg = Number(latitude);
    this.#start.disabled = true;
    const reply = await this.app.ask({ do: "calibrate", ...command });
    this.#start.disabled = reply !== undefined;
  }
}
