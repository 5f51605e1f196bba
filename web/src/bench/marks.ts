import { h } from "../dom";
import type { SpectrumMark } from "../protocol";

export class Marks {
  readonly element = h("ul", { class: "marks" });
  #shown = "";

  update(marks: SpectrumMark[]): void {
    const text = JSON.stringify(marks);
    if (text === this.#shown) return;
    this.#shown = text;
    this.element.replaceChildren(...marks.map((mark) => h("li", { class: mark.kind }, mark.text)));
  }
}
