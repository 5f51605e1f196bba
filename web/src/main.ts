import "uplot/dist/uPlot.min.css";
import "./style/base.css";
import "./style/frame.css";
import "./style/bench.css";
import "./style/calibrate.css";
import "./style/device.css";
import "./style/log.css";
import "./style/phone.css";
import type { App, Page } from "./app";
import { Bench } from "./bench/bench";
import { button, h } from "./dom";
import { type Framed, unframe } from "./frame";
import { home, type Home } from "./home";
import { storage } from "./storage";
import { Inside } from "./link/inside";
import { Served } from "./link/served";
import { Model } from "./model";
import { PageFrame } from "./page-frame";
import { named, PAGES, type PageName } from "./pages";
import { settings } from "./settings";

/** All pages but the bench are loaded when they are first opened. */
const MAKERS: Record<PageName, (app: App) => Promise<Page>> = {
  bench: async (app) => new Bench(app),
  calibrate: async (app) => new (await import("./calibrate/calibrate")).Calibrate(app),
  log: async (app) => new (await import("./log/log")).Log(app),
  device: async (app) => new (await import("./device/device")).DevicePage(app),
};

class Whole {
  readonly #frame: PageFrame;
  readonly #pages = new Map<PageName, Page>();
  readonly #app: App;
  #shown: Page | undefined;
  #fresh = true;

  constructor(where: Home["home"]) {
    const served = where === "served" ? new Served() : undefined;
    const inside = where === "static" ? new Inside() : undefined;
    const link = (served ?? inside)!;
    this.#frame = new PageFrame(() => this.#app);
    this.#app = {
      model: new Model(),
      link,
      inside,
      ask: async (command) =>
        link.ask(command).catch((why: Error) => {
          this.#frame.tell(why.message, "wrong");
          return undefined;
        }),
      tell: (text, kind = "said") => this.#frame.tell(text, kind),
    };
    link.onframe = (bytes) => this.#take(unframe(bytes));
    link.onstate = (state) => this.#frame.link(state, served);
    settings.onchange(() => this.#restyle());
    settings.follow();
    addEventListener("hashchange", () => void this.#go());
    for (const kind of ["dragover", "drop"] as const) document.addEventListener(kind, keepPage);
    document.addEventListener("keydown", (event) => this.#key(event));
    addEventListener("beforeunload", (event) => {
      if (inside && this.#app.model.calibration.is === "running") event.preventDefault();
    });
    void this.#go();
    link.start();
    if (inside) this.#settle(inside);
    requestAnimationFrame(() => this.#tick());
  }

  /** On a static page: opens the port that was open before a reload, and stores the page for use without a network. */
  #settle(inside: Inside): void {
    if (storage.hadPort()) {
      void import("./port").then(({ connectAgain }) => connectAgain(inside)).catch(() => {});
    }
    if ("serviceWorker" in navigator) void navigator.serviceWorker.register("sw.js").catch(() => {});
  }

  async #go(): Promise<void> {
    const name = named(location.hash);
    const page = await this.#page(name);
    if (named(location.hash) !== name) return;
    this.#frame.show(name, page?.element ?? missing(PAGES[name]));
    this.#shown = page;
    this.#fresh = true;
  }

  /** Updates the model by a frame. Stores calibrations at once, because `#tick` does not run in a hidden page. */
  #take(framed: Framed): void {
    this.#app.model.take(framed);
    const { calibrations } = framed.frame;
    if (calibrations && this.#app.inside) storage.keepCalibrations(calibrations);
  }

  /** A page; undefined if it cannot be loaded, because the server is gone or has another version. */
  async #page(name: PageName): Promise<Page | undefined> {
    try {
      const page = this.#pages.get(name) ?? (await MAKERS[name](this.#app));
      this.#pages.set(name, page);
      return page;
    } catch (why) {
      console.warn(why);
      return undefined;
    }
  }

  /** Runs once per animation frame; the browser asks for none while the page is hidden. */
  #tick(): void {
    requestAnimationFrame(() => this.#tick());
    const changed = this.#app.model.changes();
    if (changed.has("device")) this.#frame.device();
    if (changed.size === 0 && !this.#fresh && !this.#shown) return;
    const fresh = this.#fresh;
    this.#fresh = false;
    this.#shown?.update(changed, fresh);
    if (this.#app.model.frames > 0) document.body.dataset.ready = "";
  }

  #restyle(): void {
    for (const page of this.#pages.values()) page.restyle();
    this.#fresh = true;
  }

  #key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (target.closest("input:not([type=radio]), textarea, select, [role=log]")) return;
    const page = (Object.keys(PAGES) as PageName[])[Number(event.key) - 1];
    if (page) location.hash = page;
    else if (!target.closest("input, a, button, summary") && this.#shown?.key?.(event)) event.preventDefault();
  }
}

/** Keeps the browser from opening a file that is dropped outside of the drop zone. */
function keepPage(event: DragEvent): void {
  if (event.dataTransfer?.types.includes("Files")) event.preventDefault();
}

function missing(title: string): HTMLElement {
  return h(
    "div",
    { class: "page missing" },
    h("h1", {}, title),
    h(
      "section",
      { class: "card", role: "alert" },
      h("p", {}, "This part of the page could not be loaded: the server is gone, or has a newer version. "),
      h("div", { class: "actions" }, button("Load the page again", () => location.reload(), { class: "primary" })),
    ),
  );
}

const where = await home().catch((): Home => ({ home: "served", token_needed: false }));
new Whole(where.home);
