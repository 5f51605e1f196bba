import type { Framed } from "./frame";
import { Ring } from "./ring";
import type { Calibrating, CalibrationEntry, Device, Frame, Notice, Now, SampleCounts, Statistics } from "./protocol";

const PARTS = ["device", "now", "ledger", "notices", "statistics", "calibration", "calibrations"] as const;
export type Part = "strips" | (typeof PARTS)[number];
export const ALL: ReadonlySet<Part> = new Set<Part>(["strips", ...PARTS]);

/** The state that the session has sent so far. Its memory is bounded by the rings and the size of a frame. */
export class Model {
  device: Device | undefined;
  now: Now | undefined;
  ledger: SampleCounts | undefined;
  notices: Notice[] = [];
  statistics: Statistics[] = [];
  calibration: Calibrating = { is: "idle" };
  calibrations: CalibrationEntry[] = [];
  /** The rings of each axis, from fine to coarse. */
  rings: Ring[][] = [];
  /** The number of frames so far, for tests. */
  frames = 0;
  #changed = new Set<Part>();

  take({ frame, payload }: Framed): void {
    this.frames += 1;
    if (frame.snapshot) this.#forget();
    this.#overwrite(frame);
    if (frame.device) this.#fit(frame.device);
    for (const { axis, level, first, count, at } of frame.strips) {
      if (at + 6 * count <= payload.length) this.rings[axis]?.[level]?.write(first, count, payload, at);
    }
    if (frame.strips.length > 0) this.#changed.add("strips");
  }

  /** The parts that changed since the last call. */
  changes(): ReadonlySet<Part> {
    const changed = this.#changed;
    this.#changed = new Set();
    return changed;
  }

  #forget(): void {
    this.device = this.now = this.ledger = undefined;
    this.notices = [];
    this.statistics = [];
    this.calibration = { is: "idle" };
    this.calibrations = [];
    this.rings = [];
    this.#changed = new Set(ALL);
  }

  #overwrite(frame: Frame): void {
    for (const part of PARTS) {
      if (frame[part] === undefined) continue;
      Object.assign(this, { [part]: frame[part] });
      this.#changed.add(part);
    }
  }

  #fit(device: Device): void {
    const fits =
      this.rings.length === device.axes.length &&
      this.rings.every(
        (levels) =>
          levels.length === device.bins_s.length && levels.every((ring, k) => ring.bin_s === device.bins_s[k]),
      );
    if (fits) return;
    this.rings = device.axes.map(() => device.bins_s.map((bin_s) => new Ring(device.bins_kept, bin_s)));
  }
}
