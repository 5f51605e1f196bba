import { count, duration, significant } from "../digits";
import { coded, facts, h, table } from "../dom";
import type { LogAbout } from "../protocol";

export class About {
  readonly element = h("section", { class: "card about", "aria-label": "Content of the log" });

  show(file: File, about: LogAbout): void {
    const list = h("dl", { class: "facts" });
    facts(list, [
      ["File", `${file.name}, ${size(file.size)}`],
      ["Format", about.form],
      ["Samples", count(about.samples)],
      ["Rate", `${significant(about.rate_hz, 6)} Hz`],
      ["Duration", duration(about.duration_s)],
      ...(about.topic === null ? [] : [["Topic", about.topic] as [string, string]]),
    ]);
    const rows = about.columns.map((column) => [
      column.name,
      column.kind ?? "neither",
      column.unit ?? "its own",
      count(column.missing),
    ]);
    this.element.replaceChildren(
      h("h2", {}, "Content of the log"),
      list,
      h(
        "div",
        { class: "wide", tabindex: 0, role: "region", "aria-label": "Columns" },
        table("Columns that are analysed", ["Column", "Kind", "Shown in", "Missing samples"], rows),
      ),
      warnings(about.warnings),
    );
  }
}

export function warnings(texts: string[]): HTMLElement {
  return h("ul", { class: "warnings" }, ...texts.map((text) => h("li", {}, ...coded(text))));
}

function size(bytes: number): string {
  for (const [unit, name] of [[1e9, "GB"], [1e6, "MB"], [1e3, "KB"]] as const) {
    if (bytes >= unit) return `${significant(bytes / unit, 3)} ${name}`;
  }
  return `${bytes} bytes`;
}
