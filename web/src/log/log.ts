import type { App, Page } from "../app";
import { button, h, say } from "../dom";
import { droppable, only } from "../drop";
import { significant } from "../digits";
import type { LogSettings, LogInspection } from "../protocol";
import type { FromLog, ToLog } from "../worker/log-messages";
import { About } from "./about";
import { Axes } from "./axes";
import { Bias } from "./bias";
import { NoiseFile } from "./noise-file";
import { Pictures } from "./pictures";
import { Questions } from "./questions";

const FORMS = "CSV, Parquet, NPY, MCAP, ROS 1 bags, Arrow; also packed (gz, xz, zst)";

/** Shows the content and the noise of a log of any gyroscope. A worker of this browser reads the log. */
export class Log implements Page {
  readonly element: HTMLElement;
  readonly #state = h("p", { class: "doing", role: "status" });
  readonly #bar = h("progress", { max: 1, hidden: true, "aria-label": "Progress of the work on the log" });
  readonly #cancel: HTMLButtonElement;
  readonly #below = h("div", { class: "below" });
  readonly #questions = new Questions((settings) => this.#look(settings));
  readonly #about = new About();
  readonly #axes = new Axes();
  readonly #pictures = new Pictures();
  readonly #bias = new Bias();
  readonly #noise = new NoiseFile((command) => this.#tell({ do: "noise-file", command }));
  #worker: Worker | undefined;
  #file: File | undefined;

  constructor(readonly app: App) {
    this.#cancel = button("Cancel", () => this.#end("Cancelled. Nothing of the log is kept."), {
      class: "small",
      hidden: true,
    });
    const drop = droppable("A log of any gyroscope or IMU at rest", "", (files) => this.#take(files));
    this.element = h(
      "div",
      { class: "page log" },
      h("h1", { class: "unseen" }, "Log"),
      h(
        "section",
        { class: "card intake" },
        drop,
        h(
          "p",
          { class: "note" },
          `${FORMS}. The file is read in this browser: `,
          h("b", {}, "it never leaves this machine."),
          " SQLite bags (.db3) need the program: zerorate imu.",
        ),
        h("div", { class: "work" }, this.#state, this.#bar, this.#cancel),
      ),
      this.#below,
    );
    document.addEventListener("drop", (event) => this.#dropped(event));
    this.#say("No log yet.");
  }

  update(): void {}

  restyle(): void {
    this.#axes.restyle();
  }

  open(file: File): void {
    this.#file = file;
    this.#axes.begin();
    this.#questions.reset();
    this.#below.replaceChildren();
    this.#look({});
  }

  #dropped(event: DragEvent): void {
    if (this.element.isConnected) this.#take([...(event.dataTransfer?.files ?? [])]);
  }

  #take(files: File[]): void {
    const file = only(files, this.app);
    if (file) this.open(file);
  }

  #look(settings: LogSettings): void {
    if (!this.#file) return;
    this.#worker?.terminate();
    this.#worker = this.#start();
    this.#work(`Looking into ${this.#file.name} …`, null);
    this.#tell({ do: "look", file: this.#file, settings });
  }

  #start(): Worker {
    const worker = new Worker(new URL("log.js", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<FromLog>) => this.#heard(data);
    worker.onerror = (event) => {
      this.#end(
        `The worker that reads logs stopped: ${event.message || "it could not be loaded"}. The log may be too large for this browser; zerorate imu reads it.`,
      );
    };
    return worker;
  }

  #tell(what: ToLog): void {
    this.#worker?.postMessage(what);
  }

  #heard(told: FromLog): void {
    if (told.is === "progress") this.#work(told.text, told.share);
    else if (told.is === "looked") this.#looked(told.looked);
    else if (told.is === "axis") this.#axes.add(told.axis);
    else if (told.is === "bias") this.#bias.show(told.bias);
    else if (told.is === "summary") {
      this.#pictures.show(told.summary.pictures);
      this.#noise.offer(told.summary);
      this.#say(`${this.#file?.name ?? "The log"}: done.`);
    } else if (told.is === "file") this.#noise.take(told.file);
    else this.#failed(told.why);
  }

  /** A refused command leaves the results; any other error ends the work. */
  #failed(why: string): void {
    if (this.#cancel.hidden) this.app.tell(why, "wrong");
    else this.#end(why);
  }

  #looked(looked: LogInspection): void {
    if (looked.is === "refused") return this.#end(looked.text);
    if (looked.is === "question") {
      this.#say("The log does not say enough about itself.");
      this.#questions.ask(looked.text, looked.choices, looked.settings);
      this.#below.replaceChildren(this.#questions.element);
      return;
    }
    this.#about.show(this.#file!, looked);
    this.#axes.begin();
    this.#pictures.show([]);
    this.#bias.forget();
    this.#noise.forget();
    this.#questions.offer();
    this.#below.replaceChildren(
      this.#about.element,
      this.#axes.element,
      this.#pictures.element,
      this.#bias.element,
      this.#noise.element,
      this.#questions.element,
    );
    this.#work(`Analysing ${significant(looked.samples, 3)} samples of ${looked.columns.length} columns …`, null);
    this.#tell({ do: "analyse" });
  }

  #work(text: string, share: number | null): void {
    say(this.#state, text);
    this.#cancel.hidden = this.#bar.hidden = false;
    if (share === null) this.#bar.removeAttribute("value");
    else this.#bar.value = share;
  }

  #say(text: string): void {
    say(this.#state, text);
    this.#cancel.hidden = this.#bar.hidden = true;
  }

  #end(why: string): void {
    this.#worker?.terminate();
    this.#worker = undefined;
    this.#say(why);
  }
}
