import type { App } from "../app";
import { button, h } from "../dom";
import { droppable, only } from "../drop";
import { storage } from "../storage";
import type { Inside } from "../link/inside";
import { connectChosen, release } from "../port";
import { canReadPorts, NO_SERIAL } from "../serial";

/** Units and faults of the twin to try, with their keys. */
const PRESETS: readonly (readonly [string, string])[] = [
  ["Another unit", "seed=2"],
  ["Moving", "motion=sway"],
  ["Frozen after a minute", "fault=frozen,fault_at_s=60"],
  ["In an oven", "profile=oven"],
  ["50 Hz bandwidth", "roa=10nf"],
];

/** On a static page: the choice of the device to read. */
export class Opener {
  readonly element: HTMLElement;
  readonly #keys = h("input", {
    id: "keys",
    type: "text",
    autocomplete: "off",
    spellcheck: "false",
    maxlength: 500,
  });

  constructor(
    readonly app: App,
    readonly inside: Inside,
  ) {
    this.#keys.value = storage.opening().keys;
    this.element = h(
      "section",
      { class: "card", "aria-label": "Choose a device" },
      h("h2", {}, "Choose a device"),
      h("div", { class: "three openers" }, this.#twin(), this.#port(), this.#capture()),
    );
  }

  #twin(): HTMLElement {
    const open = (event: Event) => {
      event.preventDefault();
      void release(this.inside);
      this.inside.open({ is: "twin", keys: this.#keys.value.trim() });
      this.app.tell("The twin is being opened.");
    };
    return h(
      "form",
      { submit: open },
      h("h3", {}, "The twin"),
      h("p", {}, "A simulated sensor. Every seed is another unit."),
      h("label", { for: "keys" }, "Keys, as after ", h("code", {}, "twin:")),
      this.#keys,
      h("div", { class: "presets" }, ...PRESETS.map(([name, keys]) => this.#preset(name, keys))),
      h("button", { type: "submit" }, "Open the twin"),
    );
  }

  #preset(name: string, keys: string): HTMLElement {
    const fill = () => {
      this.#keys.value = keys;
    };
    return button(name, fill, { class: "small", title: `twin:${keys}` });
  }

  #port(): HTMLElement {
    const choose = button("Choose its port", () => void connectChosen(this.app, this.inside), {
      disabled: !canReadPorts(),
    });
    const words = "It is connected to a microcontroller with the bridge firmware, at a serial port of this machine.";
    return h("div", {}, h("h3", {}, "A real sensor"), h("p", {}, canReadPorts() ? words : NO_SERIAL), choose);
  }

  #capture(): HTMLElement {
    const open = (files: File[]) => {
      const file = only(files, this.app);
      if (!file) return;
      void release(this.inside);
      this.inside.open({ is: "capture", file });
    };
    return h(
      "div",
      {},
      h("h3", {}, "A recording"),
      h("p", {}, "It is read in this browser and never leaves this machine."),
      droppable("A capture of zerorate", "", open),
    );
  }
}
