import { button, h, save } from "../dom";
import type { LogPicture } from "../protocol";

/** The pictures of a log, as the program draws them. */
export class Pictures {
  readonly element = h("section", { class: "card pictures", "aria-label": "Pictures", hidden: true });

  show(pictures: LogPicture[]): void {
    this.element.hidden = pictures.length === 0;
    this.element.replaceChildren(h("h2", {}, "Pictures"), h("div", { class: "two" }, ...pictures.map(picture)));
  }
}

/** A picture with its title and a button to save it. */
export function picture({ name, title, svg }: LogPicture): HTMLElement {
  // an image runs no script, even if the name of a column contains one
  const image = h("img", { alt: title, src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}` });
  return h(
    "figure",
    {},
    image,
    h(
      "figcaption",
      {},
      h("span", { class: "name" }, title),
      button("Save", () => save(name, "image/svg+xml", svg), {
        class: "small",
        "aria-label": `Save ${title} as SVG`,
      }),
    ),
  );
}
