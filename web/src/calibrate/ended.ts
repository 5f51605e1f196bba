import type { App } from "../app";
import { button, h, say } from "../dom";
import type { Calibrating } from "../protocol";
import type { Stage } from "./calibrate";
import { titleOf } from "./methods";

/** Shows the reason why a calibration ended without a result, and the remedy. */
export class Ended implements Stage {
  readonly element: HTMLElement;
  readonly #title = h("h1", {});
  readonly #text = h("p", { class: "why", role: "alert" });

  constructor(readonly app: App) {
    const back = button("Back to the methods", () => void app.ask({ do: "dismiss-calibration" }), {
      class: "primary",
    });
    this.element = h(
      "div",
      { class: "ended" },
      this.#title,
      h(
        "section",
        { class: "card" },
        this.#text,
        h("p", { class: "note" }, "No calibration was put on file."),
        h("div", { class: "actions" }, back),
      ),
    );
  }

  update(calibration: Calibrating): void {
    if (calibration.is !== "refused" && calibration.is !== "aborted") return;
    say(this.#title, `${titleOf(calibration.method)}: ${calibration.is}`);
    say(this.#text, calibration.text);
  }
}
