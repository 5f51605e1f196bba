import { moment } from "../digits";
import { h, say } from "../dom";
import type { Notice } from "../protocol";

/** The notices, the newest first. A notice that is shown already stays in place, so that no screen reader repeats it. */
export class Notices {
  readonly element: HTMLElement;
  readonly #none = h("li", { class: "none" }, "None so far: all is well.");
  readonly #list = h("ol", { class: "notices" }, this.#none);
  #rows = new Map<string, Row>();

  constructor() {
    const log = h(
      "div",
      { class: "scroll", role: "log", "aria-relevant": "additions", "aria-label": "Notices", tabindex: 0 },
      this.#list,
    );
    this.element = h(
      "section",
      { class: "card", "aria-label": "Notices of the session" },
      h("h2", {}, "Notices"),
      log,
    );
  }

  update(notices: Notice[]): void {
    const before = this.#rows;
    this.#rows = new Map(
      [...notices].reverse().map((notice) => {
        const name = nameOf(notice);
        return [name, before.get(name) ?? new Row(notice)];
      }),
    );
    for (const [name, row] of before) if (!this.#rows.has(name)) row.element.remove();
    for (const notice of notices) this.#rows.get(nameOf(notice))!.update(notice);
    [...this.#rows.values()].forEach(({ element }, index) => {
      const there = this.#list.children[index]!;
      if (there !== element) this.#list.insertBefore(element, there);
    });
    this.#none.hidden = notices.length > 0;
  }
}

function nameOf({ code, axis, text }: Notice): string {
  return code ? `${code} ${axis}` : text;
}

/** The row of a notice, one for each code and axis, and for each text without a code. Its text and count change. */
class Row {
  readonly element: HTMLElement;
  readonly #at = h("time", {});
  readonly #text = h("span", {});
  readonly #count = h("b", {});

  constructor({ code }: Notice) {
    this.element = h("li", {}, this.#at, " ", h("code", {}, code), " ", this.#text, " ", this.#count);
  }

  update({ at_s, text, count }: Notice): void {
    say(this.#at, moment(at_s, 1));
    say(this.#text, text);
    say(this.#count, count > 1 ? `× ${count}` : "");
  }
}
