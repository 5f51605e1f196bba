import { storage } from "./storage";

export type Theme = "auto" | "light" | "dark";
export type Unit = "dps" | "dph";

/** Theme and unit of the page. Views listen for changes. */
class Settings {
  theme: Theme = storage.choice("theme", ["auto", "light", "dark"], "auto");
  unit: Unit = storage.choice("unit", ["dps", "dph"], "dps");
  readonly #listeners: (() => void)[] = [];

  onchange(does: () => void): void {
    this.#listeners.push(does);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    storage.keepChoice("theme", theme);
    this.apply();
  }

  setUnit(unit: Unit): void {
    this.unit = unit;
    storage.keepChoice("unit", unit);
    this.#tell();
  }

  /** The factor from °/s to the chosen unit. */
  get scale(): number {
    return this.unit === "dps" ? 1 : 3600;
  }

  get unitText(): string {
    return this.unit === "dps" ? "°/s" : "°/h";
  }

  apply(): void {
    if (this.theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = this.theme;
    this.#tell();
  }

  /** Applies changes of the system's theme from now on. */
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
