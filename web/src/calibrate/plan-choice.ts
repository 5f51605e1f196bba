import type { App } from "../app";
import { h, mark, say } from "../dom";
import { droppable, only } from "../drop";

/** A plan that comes with the software, in plain words. */
interface Shipped {
  name: string;
  title: string;
  what: string;
}

const SHIPPED: readonly Shipped[] = [
  {
    name: "two-point",
    title: "15, 55 and 15 °C",
    what:
      "Waits and averages at each until the sensor has settled: about an hour and a half. An oven and a cold box will do.",
  },
  {
    name: "f57",
    title: "25, −40, +85 and 25 °C",
    what: "Runs by the clock, at 2 °C a minute: three and a half hours. It needs a chamber that makes ramps.",
  },
];

const OWN = "own";
/** The largest plan, bytes; a thousand steps take less. */
const LARGEST = 48_000;

/** The plan for the chamber: one that comes with the software, or a file of the user. */
export class PlanChoice {
  readonly element: HTMLElement;
  readonly #file = h("p", { class: "note plan-file", role: "status" });
  readonly #twin: HTMLElement;
  readonly #own: HTMLInputElement;
  #chosen = SHIPPED[0]!.name;
  #text = "";

  constructor(readonly app: App) {
    const drop = droppable("A plan of your own (TOML)", ".toml", (files) => void this.#take(only(files, app)));
    const [own, ownLabel] = this.#option(OWN, "Your own", "A file with a set point for each step. Drop it below.");
    this.#own = own;
    this.#own.disabled = true;
    this.#twin = ofTwin(app);
    this.element = h(
      "section",
      { class: "card plan-choice" },
      h("h2", { id: "plan-choice" }, "What the chamber is to do"),
      h(
        "div",
        { class: "plans", role: "radiogroup", "aria-labelledby": "plan-choice" },
        ...SHIPPED.map(({ name, title, what }) => this.#option(name, title, what)[1]),
        ownLabel,
      ),
      drop,
      this.#file,
      this.#twin,
    );
  }

  /** The plan for the session: a name, or the text of a plan. */
  get plan(): string {
    return this.#chosen === OWN ? this.#text : this.#chosen;
  }

  update(): void {
    this.#twin.hidden = this.app.model.device?.simulated !== true;
  }

  #option(name: string, title: string, what: string): [HTMLInputElement, HTMLElement] {
    const change = () => {
      this.#chosen = name;
    };
    const input = h("input", { type: "radio", name: "plan", value: name, change });
    input.checked = name === this.#chosen;
    const words = h("span", {}, h("b", {}, title), name === OWN ? "" : " ", name === OWN ? "" : h("code", {}, name));
    return [input, h("label", {}, input, words, h("span", { class: "what" }, what))];
  }

  async #take(file: File | undefined): Promise<void> {
    if (!file) return;
    if (file.size > LARGEST) {
      this.app.tell(`${file.name} is too large for a plan: ${file.size} bytes, of at most ${LARGEST}.`, "wrong");
      return;
    }
    const text = await file.text();
    if (!text.includes("=")) {
      this.app.tell(`${file.name} is not a plan. A plan is a TOML file with schema = 1 and its steps.`, "wrong");
      return;
    }
    this.#text = text;
    this.#chosen = OWN;
    this.#own.checked = true;
    mark(this.#own, "disabled", null);
    say(this.#file, `${file.name} is taken. It is read when you press Start.`);
  }
}

function ofTwin({ inside }: App): HTMLElement {
  const where = inside
    ? ["Under Device, open the twin with the key ", h("code", {}, "profile=oven")]
    : ["Start it with ", h("code", {}, "zerorate serve --device twin:profile=oven")];
  return h(
    "p",
    { class: "note twin" },
    "The twin can simulate an oven that heats and cools by itself (F-57). ",
    ...where,
    ", then take the plan ",
    h("code", {}, "f57"),
    ".",
  );
}
