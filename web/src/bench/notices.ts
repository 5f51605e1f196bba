import { clock } from "../digits";
import { h } from "../dom";
import type { Notice } from "../protocol";

/** What there is to say, the newest first. */
export class Notices {
  readonly element: HTMLElement;
  readonly #list = h("ol", { class: "notices" });
  #shown = "";

  constructor() {
    const log = h("div", { class: "scroll", role: "log", "aria-label": "Notices", tabindex: 0 }, this.#list);
    this.element = h(
      "section",
      { class: "card", "aria-label": "What there is to say" },
      h("h2", {}, "Notices"),
      log,
    );
    this.update([]);
  }

  update(notices: Notice[]): void {
    const text = JSON.stringify(notices);
    if (text === this.#shown) return;
    this.#shown = text;
    const rows = [...notices]
      .reverse()
      .map((notice) =>
        h(
          "li",
          {},
          h("time", {}, clock(notice.at_s, 1)),
          " ",
          h("code", {}, notice.code),
          ` ${notice.text}`,
          ...(notice.count > 1 ? [h("b", {}, ` × ${notice.count}`)] : []),
        ),
      );
    this.#list.replaceChildren(
      ...(rows.length > 0 ? rows : [h("li", { class: "none" }, "Nothing to say: all is well so far.")]),
    );
  }
}
