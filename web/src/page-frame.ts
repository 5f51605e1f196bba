import type { App } from "./app";
import { Choice, h, mark, say } from "./dom";
import type { LinkState } from "./link/link";
import type { Served } from "./link/served";
import { PAGES, type PageName } from "./pages";
import { settings, type Theme } from "./settings";

const SPEEDS = [
  ["1", "1 ×"],
  ["10", "10 ×"],
  ["100", "100 ×"],
  ["0", "max"],
] as const;

/** The frame around every page: links, the device and its state, messages. */
export class PageFrame {
  readonly main = h("main", { id: "main", tabindex: -1 });
  readonly #links = new Map<PageName, HTMLAnchorElement>();
  readonly #device = h("span", { class: "device" });
  readonly #state = h("span", { class: "state" });
  readonly #speed: Choice<string>;
  readonly #banner = h("p", { class: "banner", role: "status" });
  readonly #toast = h("p", { class: "toast", role: "alert" });
  readonly #lock = h("div", { class: "lock", hidden: true });
  #toastEnds = 0;
  #linkWords = "";
  #deviceWords = "";

  constructor(readonly app: () => App) {
    this.#speed = new Choice(
      "Speed of the simulated sensor",
      SPEEDS,
      "1",
      (factor) => void this.app().ask({ do: "speed", factor: Number(factor) }),
    );
    this.#speed.element.hidden = true;
    document.body.append(
      h(
        "a",
        {
          class: "skip",
          href: "#main",
          click: (event) => {
            event.preventDefault();
            this.main.focus();
          },
        },
        "Skip to the content",
      ),
      this.#header(),
      this.main,
      this.#banner,
      this.#toast,
      this.#lock,
    );
  }

  show(name: PageName, element: HTMLElement): void {
    for (const [of, link] of this.#links) mark(link, "aria-current", of === name ? "page" : null);
    document.title = `${PAGES[name]} · zerorate`;
    this.main.replaceChildren(element);
    scrollTo(0, 0);
  }

  link(state: LinkState, served: Served | undefined): void {
    const words: Record<LinkState["is"], string> = {
      connecting: "Connecting …",
      open: "",
      locked: "",
      lost: "The server cannot be reached. The page shows the last values and keeps trying.",
      failed: state.is === "failed" ? `This page cannot work here: ${state.why}` : "",
    };
    this.#linkWords = words[state.is];
    this.#announce();
    this.#lock.hidden = state.is !== "locked";
    if (state.is === "locked" && served) this.#ask(served, state.wrong);
  }

  device(): void {
    const { device } = this.app().model;
    say(this.#device, device?.name ?? "");
    const state = device?.state.is ?? "opening";
    say(this.#state, {
      opening: "opening",
      reading: device?.simulated ? "SIMULATED" : "live",
      ended: "ended",
      failed: "cannot be read",
    }[state]);
    mark(this.#state, "data-state", state === "reading" && device?.simulated ? "simulated" : state);
    this.#speed.element.hidden = device?.simulated !== true;
    if (device)
      this.#speed.set(SPEEDS.some(([factor]) => Number(factor) === device.speed) ? String(device.speed) : null);
    this.#deviceWords = device?.state.is === "failed" ? device.state.why : "";
    this.#announce();
  }

  tell(text: string, kind: "said" | "wrong"): void {
    say(this.#toast, text);
    mark(this.#toast, "data-kind", kind);
    clearTimeout(this.#toastEnds);
    this.#toastEnds = window.setTimeout(() => say(this.#toast, ""), kind === "wrong" ? 12_000 : 5000);
  }

  /** An error of the connection comes before an error of the device. */
  #announce(): void {
    say(this.#banner, this.#linkWords || this.#deviceWords);
  }

  #header(): HTMLElement {
    const links = (Object.keys(PAGES) as PageName[]).map((name) => {
      const link = h("a", { href: `#${name}` }, PAGES[name]);
      this.#links.set(name, link);
      return h("li", {}, link);
    });
    const themes = new Choice<Theme>(
      "Colours",
      [
        ["auto", "Auto"],
        ["light", "Light"],
        ["dark", "Dark"],
      ],
      settings.theme,
      (theme) => settings.setTheme(theme),
    );
    return h(
      "header",
      {},
      h("a", { class: "brand", href: "#bench" }, "zerorate"),
      h("nav", { "aria-label": "Pages" }, h("ul", {}, ...links)),
      h("p", { class: "source", role: "status" }, this.#state, this.#device),
      this.#speed.element,
      themes.element,
    );
  }

  #ask(served: Served, wrong: boolean): void {
    const field = h("input", { type: "password", id: "token", autocomplete: "off", required: true });
    const form = h(
      "form",
      {
        submit: (event) => {
          event.preventDefault();
          void served.unlock(field.value.trim());
        },
      },
      h("h1", {}, "This page needs its token"),
      h("p", {}, "zerorate serve printed it in the terminal when it started."),
      h("label", { for: "token" }, "Token"),
      field,
      h("button", { type: "submit" }, "Open"),
      h("p", { class: "wrong", role: "alert" }, wrong ? "That is not the token." : ""),
    );
    this.#lock.replaceChildren(form);
    field.focus();
  }
}
