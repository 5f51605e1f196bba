import type { CalibrationEntry } from "./protocol";
import type { Opening } from "./worker/messages";

const CALIBRATIONS = "zerorate.calibrations";
const TWIN = "zerorate.twin";
const PORT = "zerorate.port";
const DEFAULT_KEYS = "seed=7";

function read<T>(key: string, otherwise: T): T {
  try {
    const text = localStorage.getItem(key);
    return text === null ? otherwise : (JSON.parse(text) as T);
  } catch {
    return otherwise;
  }
}

function write(key: string, value: unknown): void {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch {
    // the browser stores nothing, so the page works but forgets
  }
}

/** The data that this browser keeps between visits. */
export const storage = {
  calibrations(): { calibrations: string[]; applied: string | null } {
    return read(CALIBRATIONS, { calibrations: [], applied: null });
  },

  /** Adds calibrations to the stored ones. Others stay: they may be another window's, or the session refused them. */
  keepCalibrations(entries: CalibrationEntry[]): void {
    const applied = entries.find((entry) => entry.applied)?.id ?? null;
    const all = new Set([...storage.calibrations().calibrations, ...entries.map((entry) => entry.toml)]);
    write(CALIBRATIONS, { calibrations: [...all], applied });
  },

  forgetCalibration(toml: string): void {
    const { calibrations, applied } = storage.calibrations();
    write(CALIBRATIONS, { calibrations: calibrations.filter((one) => one !== toml), applied });
  },

  /** The device to open if no other is: the twin with its last keys. */
  opening(): Opening & { is: "twin" } {
    return { is: "twin", keys: read(TWIN, DEFAULT_KEYS) };
  },

  keepOpening(opening: Opening & { is: "twin" }): void {
    write(TWIN, opening.keys);
  },

  /** True if the last device was at a serial port. */
  hadPort(): boolean {
    return read(PORT, false);
  },

  keepPort(had: boolean): void {
    write(PORT, had);
  },

  /** A stored setting of the page; `otherwise` if none of `values` is stored. */
  choice<T extends string>(name: string, values: readonly T[], otherwise: T): T {
    const value = read<string>(`zerorate.${name}`, otherwise);
    return values.find((known) => known === value) ?? otherwise;
  },

  keepChoice(name: string, value: string): void {
    write(`zerorate.${name}`, value);
  },
};
