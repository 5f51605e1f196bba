import { button, h, save } from "../dom";
import type { Download, LogBias } from "../protocol";
import { warnings } from "./about";
import { picture } from "./pictures";

/** The bias over temperature of a log, and the files made from it. */
export class Bias {
  readonly element = h("section", { class: "card bias", "aria-label": "Bias over temperature", hidden: true });

  forget(): void {
    this.element.hidden = true;
    this.element.replaceChildren();
  }

  show({ text, pictures, warnings: texts, files, no_files, why_not }: LogBias): void {
    const results =
      why_not === null
        ? [
            h("pre", { tabindex: 0, role: "region", "aria-label": "Bias of each axis" }, text),
            h("div", { class: "two pictures" }, ...pictures.map(picture)),
            warnings(texts),
            h("div", { class: "downloads", role: "group", "aria-label": "Download" }, ...files.map(download)),
            ...no_files.map((why) => h("p", { class: "note" }, why)),
          ]
        : [h("p", { class: "doubt" }, why_not)];
    this.element.replaceChildren(h("h2", {}, "Bias over temperature"), ...results);
    this.element.hidden = false;
  }
}

function download({ name, media_type, text }: Download): HTMLElement {
  return button(name, () => save(name, media_type, text), { class: "small", "aria-label": `Download ${name}` });
}
