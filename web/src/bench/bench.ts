import type { App, Page } from "../app";
import { Allan } from "../chart/allan";
import { Scatter } from "../chart/scatter";
import { Spectrum } from "../chart/spectrum";
import type { Part } from "../model";
import { button, Choice, h, say } from "../dom";
import { Coefficients } from "./coefficients";
import { Marks } from "./marks";
import { Notices } from "./notices";
import { Strips } from "./strips";
import { Tiles } from "./tiles";

/** Time between two updates of the text for users who do not see the charts, ms. */
const WORDS_MS = 5000;
/** Shortest time between two changes of the numbers, so that they can be read, ms. */
const NUMBERS_MS = 200;

const SEEN = "live: its rate of rotation, its temperature, and the noise that limits it.";

/** Shows what the sensor measures now, and the statistics so far. */
export class Bench implements Page {
  readonly element: HTMLElement;
  readonly #tiles: Tiles;
  readonly #strips: Strips;
  readonly #spectrum = new Spectrum("Spectrum", 230, "the first seconds are being collected");
  readonly #allan: Allan;
  readonly #scatter = new Scatter("Rate over temperature", 230, "the first seconds are being collected");
  readonly #marks = new Marks();
  readonly #coefficients = new Coefficients();
  readonly #notices: Notices;
  readonly #seen = h("p", { class: "note" }, `This is a gyroscope, ${SEEN}`);
  readonly #axes = h("div", { class: "axes" });
  #axis = 0;
  #names = "";
  #spoke = 0;
  #wrote = 0;

  constructor(readonly app: App) {
    const restart = button("Restart", () => void app.ask({ do: "restart" }), {
      class: "small",
      "aria-label": "Restart the statistics",
    });
    this.#allan = new Allan("Allan deviation", 230, "the first seconds are being collected", [restart]);
    this.#tiles = new Tiles(app);
    this.#strips = new Strips(app);
    this.#notices = new Notices();
    const card = (figure: { element: HTMLElement }, ...more: Node[]) =>
      h("section", { class: "card" }, figure.element, ...more);
    this.element = h(
      "div",
      { class: "page bench" },
      h("h1", { class: "unseen" }, "Bench"),
      this.#seen,
      this.#axes,
      this.#tiles.element,
      this.#strips.element,
      h(
        "div",
        { class: "three" },
        card(this.#allan, this.#coefficients.element),
        card(this.#spectrum, this.#marks.element),
        card(this.#scatter),
      ),
      this.#notices.element,
    );
  }

  update(changed: ReadonlySet<Part>, all: boolean): void {
    if (changed.has("device") || all) this.#choose();
    const now = performance.now();
    if (all || now - this.#wrote > NUMBERS_MS) {
      this.#wrote = now;
      this.#tiles.update(this.#axis);
    }
    this.#strips.update(changed.has("strips"), all);
    if (changed.has("statistics") || all) this.#statistics();
    if (changed.has("notices") || all) this.#notices.update(this.app.model.notices);
    if (now - this.#spoke > WORDS_MS) {
      this.#spoke = now;
      this.#strips.summarise();
    }
  }

  restyle(): void {
    this.#strips.restyle();
    for (const figure of [this.#spectrum, this.#allan, this.#scatter]) figure.remake();
    this.#statistics();
  }

  key(event: KeyboardEvent): boolean {
    return this.#strips.key(event);
  }

  #statistics(): void {
    const found = this.app.model.statistics[this.#axis];
    this.#allan.show(found?.allan);
    this.#spectrum.show(found && { points: found.spectrum, marks: found.marks });
    this.#scatter.show(found?.temperature);
    this.#coefficients.update(found);
    this.#marks.update(found?.marks ?? []);
  }

  #choose(): void {
    const { device } = this.app.model;
    if (device) say(this.#seen, `This is ${device.simulated ? "a simulated gyroscope" : "a gyroscope"}, ${SEEN}`);
    const axes = device?.axes ?? [];
    const names = axes.map((axis) => axis.name).join("\n");
    if (names === this.#names) return;
    this.#names = names;
    this.#axis = this.#strips.axis = 0;
    const options = axes.map((axis, index) => [String(index), axis.name] as const);
    const choice = new Choice("Axis", options, "0", (value) => {
      this.#axis = this.#strips.axis = Number(value);
      this.update(new Set(), true);
    });
    this.#axes.replaceChildren(...(axes.length > 1 ? [choice.element] : []));
  }
}
