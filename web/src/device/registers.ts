import { hex } from "../digits";
import { h } from "../dom";
import type { Field, Register } from "../protocol";

/** The content of the registers, bit by bit in plain words. */
export class Registers {
  readonly element = h("div", { class: "registers" });
  #shown = "";

  update(registers: Register[]): void {
    const text = JSON.stringify(registers);
    if (text === this.#shown) return;
    this.#shown = text;
    const none = h("p", { class: "none" }, "This device has no readable registers.");
    this.element.replaceChildren(...(registers.length > 0 ? registers.map(panel) : [none]));
  }
}

function panel({ name, address, value, bits, fields }: Register): HTMLElement {
  const wrong = fields.some((field) => field.wrong);
  const binary = value.toString(2).padStart(bits, "0");
  const cells = (binary.match(/.{1,8}/g) ?? []).map((byte) =>
    h(
      "span",
      { class: "byte" },
      ...[...byte].map((bit) => h("span", { class: bit === "1" ? "one" : "zero" }, bit)),
    ),
  );
  return h(
    "section",
    { class: wrong ? "register wrong" : "register", "aria-label": `Register ${name}` },
    h(
      "h3",
      {},
      h("span", {}, name),
      h("code", {}, `at ${hex(address, 8)}`),
      h("code", { class: "content" }, hex(value, bits)),
    ),
    h("p", { class: "bits", role: "img", "aria-label": `in bits ${binary}` }, ...cells),
    h("dl", {}, ...fields.map(row)),
  );
}

function row({ name, value, meaning, wrong }: Field): HTMLElement {
  return h(
    "div",
    wrong ? { class: "wrong" } : {},
    h("dt", {}, `${name} = ${value}`),
    h("dd", {}, wrong ? `unexpected: ${meaning}` : meaning),
  );
}
