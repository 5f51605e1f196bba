import { button, h, save } from "../dom";
import type { LogPicture } from "../protocol";

export class Pictures {
  readonly element = h("section", { class: "card pictures", "aria-label": "Pictures", hidden: true });

  show(pictures: LogPicture[]): void {
    this.element.hidden = pictures.length === 0;
    this.element.replaceChildren(h("h2", {}, "Pictures"), h("div", { class: "two" }, ...pictures.map(picture)));
  }
}

export function picture({ name, title, svg }: LogPicture): HTMLElement {
  // an image runs no script, even if the name of a column contains one
  const image = () => h("img", { alt: title, src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}` });
  const larger = () => enlarge(title, image());
  return h(
    "figure",
    {},
    h("button", { type: "button", class: "larger", click: larger, "aria-label": `Enlarge ${title}` }, image()),
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

/** Shows a picture in a dialog as large as the window. A click on it, or Escape, closes it. */
function enlarge(title: string, image: HTMLImageElement): void {
  const dialog = h("dialog", { class: "large", "aria-label": title });
  dialog.addEventListener("click", () => dialog.close());
  dialog.addEventListener("close", () => dialog.remove());
  dialog.append(
    h("div", { class: "row" }, h("h2", {}, title), button("Close", () => dialog.close(), { class: "small" })),
    h("div", { class: "wide", tabindex: 0, role: "region", "aria-label": title }, image),
  );
  document.body.append(dialog);
  dialog.showModal();
}
