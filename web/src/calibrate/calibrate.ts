import type { App, Page } from "../app";
import { h } from "../dom";
import { ALL, type Part } from "../model";
import type { Calibrating } from "../protocol";
import { Choosing } from "./choosing";
import { Ended } from "./ended";
import { Result } from "./result";
import { Run } from "./run";

/** The view of one state of the guided calibration. */
export interface Stage {
  readonly element: HTMLElement;
  update(calibration: Calibrating, changed: ReadonlySet<Part>): void;
  restyle?(): void;
  /** Releases the view; it is not shown again. */
  leave?(): void;
}

const STAGES = { idle: Choosing, running: Run, done: Result, refused: Ended, aborted: Ended };

/**
 * The guided calibration: choose, run, result. The view follows the session, so that it is the same in every window
 * and after a reload.
 */
export class Calibrate implements Page {
  readonly element = h("div", { class: "page calibrate" });
  #is: Calibrating["is"] | undefined;
  #stage: Stage | undefined;

  constructor(readonly app: App) {}

  update(changed: ReadonlySet<Part>, all: boolean): void {
    const { calibration } = this.app.model;
    const isOther = calibration.is !== this.#is;
    if (isOther) this.#enter(calibration.is);
    if (isOther || all || changed.size > 0) this.#stage!.update(calibration, isOther || all ? ALL : changed);
  }

  restyle(): void {
    this.#stage?.restyle?.();
  }

  #enter(is: Calibrating["is"]): void {
    this.#is = is;
    this.#stage?.leave?.();
    this.#stage = new STAGES[is](this.app);
    this.element.replaceChildren(this.#stage.element);
    scrollTo(0, 0);
  }
}
