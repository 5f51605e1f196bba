import type { App } from "./app";
import { h } from "./dom";

export function droppable(words: string, accept: string, take: (files: File[]) => void): HTMLElement {
  const input = h("input", { type: "file", accept, multiple: accept === ".toml" });
  const zone = h(
    "label",
    { class: "drop" },
    input,
    h("b", {}, words),
    h("span", {}, "drop it here, or choose a file"),
  );
  input.addEventListener("change", () => {
    take([...(input.files ?? [])]);
    input.value = "";
  });
  zone.addEventListener("dragover", (event) => {
    event.preventDefault();
    zone.classList.add("over");
  });
  zone.addEventListener("dragleave", () => zone.classList.remove("over"));
  zone.addEventListener("drop", (event) => {
    event.preventDefault();
    event.stopPropagation();
    zone.classList.remove("over");
    take([...(event.dataTransfer?.files ?? [])]);
  });
  return zone;
}

/** The only file, or the first of several, which is then named. */
export function only([file, another]: File[], app: App): File | undefined {
  if (file && another) app.tell(`One file at a time: ${file.name}.`, "wrong");
  return file;
}
