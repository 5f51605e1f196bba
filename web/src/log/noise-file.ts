import { button, h, save, say } from "../dom";
import type { Download, LogSummary, NoiseFileCommand } from "../protocol";
import { warnings } from "./about";

const FORMATS: readonly (readonly [string, string])[] = [
  ["kalibr", "Kalibr"],
  ["openvins", "OpenVINS"],
  ["vins", "VINS-Fusion"],
  ["orbslam3", "ORB-SLAM3"],
  ["kf-gins", "KF-GINS"],
  ["ros", "ROS (covariances)"],
];

export class NoiseFile {
  readonly element: HTMLElement;
  readonly #why = h("p", { class: "doubt" });
  readonly #warnings = h("div", {});
  readonly #format = select("format", FORMATS);
  readonly #combine = select("combine", [
    ["worst", "the worst of the axes"],
    ["mean", "the mean of the axes"],
  ]);
  readonly #inflate = h("input", { id: "inflate", type: "number", min: 0.001, max: 1000, step: "any", value: 1 });
  readonly #acceptRejected = h("input", { id: "accept-rejected", type: "checkbox" });
  readonly #text = h("pre", { tabindex: 0, role: "region", "aria-label": "The file" });
  readonly #save: HTMLButtonElement;
  #file: Download | undefined;

  constructor(command: (command: NoiseFileCommand) => void) {
    const field = (label: string, input: HTMLElement) =>
      h("div", { class: "field" }, h("label", { for: input.id }, label), input);
    const submit = (event: Event) => {
      event.preventDefault();
      command({
        format: this.#format.value,
        combine: this.#combine.value,
        inflate: Number(this.#inflate.value),
        accept_rejected: this.#acceptRejected.checked,
      });
    };
    this.#save = button(
      "Save",
      () => {
        if (this.#file) save(this.#file.name, this.#file.media_type, this.#file.text);
      },
      { class: "small", disabled: true },
    );
    this.element = h(
      "section",
      { class: "card noise", "aria-label": "File for a filter", hidden: true },
      h("h2", {}, "File for a filter"),
      this.#warnings,
      this.#why,
      h(
        "form",
        { submit },
        h(
          "div",
          { class: "fields" },
          field("For", this.#format),
          field("If it takes one number for all axes", this.#combine),
          field("Factor on all noise", this.#inflate),
          field("Accept rejected models", this.#acceptRejected),
        ),
        h(
          "div",
          { class: "actions" },
          h("button", { type: "submit", class: "primary" }, "Make the file"),
          this.#save,
        ),
      ),
      this.#text,
    );
  }

  forget(): void {
    this.element.hidden = true;
    this.#file = undefined;
    this.#save.disabled = true;
    say(this.#text, "");
  }

  offer({ no_noise_file, warnings: texts }: LogSummary): void {
    this.element.hidden = false;
    this.#warnings.replaceChildren(warnings(texts));
    say(this.#why, no_noise_file ?? "");
  }

  take(file: Download): void {
    this.#file = file;
    this.#save.disabled = false;
    say(this.#text, file.text);
  }
}

function select(id: string, options: readonly (readonly [string, string])[]): HTMLSelectElement {
  return h("select", { id }, ...options.map(([value, words]) => h("option", { value }, words)));
}
