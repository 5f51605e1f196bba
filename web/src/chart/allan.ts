import { duration, significant } from "../digits";
import type { AllanPoint } from "../protocol";
import { settings } from "../settings";
import { axis, banded, decades, DECADES, dotted, type Drawing, expected, Figure, type Told } from "./figure";
import { faint, type Palette } from "./palette";

/** The Allan deviation, log-log: points with their one-sigma band, and the model. */
export class Allan extends Figure<AllanPoint[]> {
  /** The unit of the drawing, and the factor that converts a deviation to it. */
  protected unit(): { text: string; scale: number } {
    return { text: settings.unitText, scale: settings.scale };
  }

  protected isThere(points: AllanPoint[]): boolean {
    return points.length > 1;
  }

  protected columns(points: AllanPoint[]): (number | null)[][] {
    const scaled = (of: (point: AllanPoint) => number | null) =>
      points.map((point) => {
        const value = of(point);
        return value !== null && value > 0 ? value * this.unit().scale : null;
      });
    return [
      points.map((point) => point.tau_s),
      scaled((p) => p.hi_dps),
      scaled((p) => p.lo_dps),
      scaled((p) => p.model_dps),
      scaled((p) => p.dev_dps),
    ];
  }

  protected drawing(colours: Palette): Drawing {
    return {
      scales: {
        x: { time: false, distr: 3, range: (_, least, largest) => [least / 1.3, largest * 1.3] },
        y: { distr: 3, range: () => this.#range() },
      },
      axes: [
        axis(colours, "averaging time, s", { size: 26, ...DECADES }),
        axis(colours, `deviation, ${this.unit().text}`, { size: 46, ...DECADES }),
      ],
      ...banded(faint(colours.noise, 0.18), expected(colours), dotted(colours.noise, 2)),
    };
  }

  protected told(points: AllanPoint[]): Told {
    const unit = this.unit().text;
    const text = (dps: number | null) => (dps === null ? "–" : significant(dps * this.unit().scale, 3));
    const lowest = points.reduce((low, point) => (point.dev_dps < low.dev_dps ? point : low));
    const last = points[points.length - 1]!;
    return {
      summary:
        `Allan deviation from ${duration(points[0]!.tau_s)} to ${duration(last.tau_s)}; ` +
        `lowest ${text(lowest.dev_dps)} ${unit} at ${duration(lowest.tau_s)}`,
      head: ["τ, s", `deviation, ${unit}`, "from", "to", "model"],
      rows: points.map((p) => [
        significant(p.tau_s, 4),
        text(p.dev_dps),
        text(p.lo_dps),
        text(p.hi_dps),
        text(p.model_dps),
      ]),
    };
  }

  #range(): [number, number] {
    const points = this.data ?? [];
    const low = Math.min(...points.map((p) => (p.lo_dps > 0 ? Math.max(p.lo_dps, p.dev_dps / 4) : p.dev_dps)));
    const high = Math.max(...points.map((p) => Math.min(p.hi_dps, p.dev_dps * 4)));
    return decades(low * this.unit().scale, high * this.unit().scale);
  }
}
