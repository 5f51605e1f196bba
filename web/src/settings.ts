import { kept } from "./kept";

export type Theme = "auto" | "light" | "dark";
export type Unit = "dps" | "dph";

/** Seconds in an hour: °/h in a °/s. */
const PER_HOUR = 3600;

/** How the page looks; whoever draws listens. */
class Settings {
  theme: Theme = kept.choice("theme", ["auto", "light", "dark"], "auto");
  unit: Unit = kept.choice("unit", ["dps", "dph"], "dps");
  readonly #listeners: (() => void)[] = [];

  onchange(does: () => void): void {
    this.#listeners.push(does);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    kept.keepChoice("theme", theme);
    this.apply();
  }

  setUnit(unit: Unit): void {
    this.unit = unit;
    kept.keepChoice("unit", unit);
    this.#tell();
  }

  /** What a rate in °/s is multiplied by. */
  get scale(): number {
    return this.unit === "dps" ? 1 : PER_HOUR;
  }

  get unitText(): string {
    return this.unit === "dps" ? "°/s" : "°/h";
  }

  /** Puts the theme on the page. */
  apply(): void {
    if (this.theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = this.theme;
    this.#tell();
  }

  /** Follows the system from now on. */
  follow(): void {
    this.apply();
    for (const query of ["(prefers-color-scheme: dark)", "(forced-colors: active)"]) {
      matchMedia(query).addEventListener("change", () => this.#tell());
    }
  }

  #tell(): void {
    for (const does of this.#listeners) does();
  }
}

export const settings = new Settings();
