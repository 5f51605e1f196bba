/** Makes elements without a framework. Data reaches the page as text only. */

type Attributes = Record<string, string | number | boolean | ((event: Event) => void) | undefined>;
type Child = Node | string;

const SVG = "http://www.w3.org/2000/svg";

function fill(element: Element, attributes: Attributes, children: Child[]): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children);
}

/** Makes an element. A function among the attributes becomes a listener. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

export function svg(tag: string, attributes: Attributes = {}, ...children: Child[]): SVGElement {
  const element = document.createElementNS(SVG, tag);
  fill(element, attributes, children);
  return element;
}

export function say(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function mark(element: Element, name: string, value: string | null): void {
  if (element.getAttribute(name) === value) return;
  if (value === null) element.removeAttribute(name);
  else element.setAttribute(name, value);
}

/** If `words` is only a sign, the attribute `aria-label` must have words for screen readers. */
export function button(words: string, does: () => void, attributes: Attributes = {}): HTMLButtonElement {
  return h("button", { type: "button", click: () => does(), ...attributes }, words);
}

/** A choice among several values: radio buttons that look like one switch. */
export class Choice<T extends string> {
  readonly element: HTMLElement;
  readonly #inputs = new Map<T, HTMLInputElement>();
  static #count = 0;

  constructor(label: string, options: readonly (readonly [T, string])[], chosen: T, onchange: (value: T) => void) {
    const name = `choice-${Choice.#count++}`;
    this.element = h("fieldset", { class: "choice" }, h("legend", { class: "unseen" }, label));
    for (const [value, words] of options) {
      const input = h("input", { type: "radio", name, value, change: () => onchange(value) });
      input.checked = value === chosen;
      this.#inputs.set(value, input);
      this.element.append(h("label", {}, input, h("span", {}, words)));
    }
  }

  set(value: T | null): void {
    for (const [of, input] of this.#inputs) input.checked = of === value;
  }
}

/** Asks in a dialog while the page goes on (`confirm` would halt it). Escape means no. */
export function sure(question: string, yes: string, no: string): Promise<boolean> {
  return new Promise((done) => {
    const dialog: HTMLDialogElement = h(
      "dialog",
      { "aria-label": question, close: () => done(dialog.returnValue === "yes") },
      h("p", {}, question),
      h(
        "div",
        { class: "actions" },
        button(no, () => dialog.close(), { autofocus: true }),
        button(yes, () => dialog.close("yes"), { class: "primary" }),
      ),
    );
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  });
}

export function save(name: string, type: string, text: string): void {
  const url = URL.createObjectURL(new Blob([text], { type }));
  const link = h("a", { href: url, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** A table with a caption, for users who do not see the picture beside it. */
export function table(caption: string, head: string[], rows: string[][]): HTMLTableElement {
  return h(
    "table",
    {},
    h("caption", {}, caption),
    h("thead", {}, h("tr", {}, ...head.map((words) => h("th", { scope: "col" }, words)))),
    h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map((words) => h("td", {}, words))))),
  );
}

/** A message of the program as nodes: its code, if it begins with one (`code: text`), and its text. */
export function coded(text: string): Node[] {
  const [, code, words] = /^([a-z][a-z0-9]*(?:-[a-z0-9]+)*): (.*)$/s.exec(text) ?? [];
  return code ? [h("code", {}, code), document.createTextNode(` ${words}`)] : [document.createTextNode(text)];
}

/** Fills a list with names and values. If the names are the same as before, only the values change. */
export function facts(list: HTMLElement, rows: [string, string][]): void {
  const names = rows.map(([name]) => name).join("\n");
  if (list.dataset.names !== names) {
    list.dataset.names = names;
    list.replaceChildren(...rows.map(([name]) => h("div", {}, h("dt", {}, name), h("dd", {}))));
  }
  rows.forEach(([, words], index) => say(list.children[index]!.lastElementChild!, words));
}
