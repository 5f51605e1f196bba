import { half, significant, value } from "../digits";
import type { CurvePoint } from "../protocol";
import { settings } from "../settings";
import { banded, dotted, type Drawing, expected, Figure, overTemperature, type Told } from "./figure";
import { faint, type Palette } from "./palette";

/** The correction over temperature with its 95 % band and, for the twin, the truth. */
export class Curve extends Figure<CurvePoint[]> {
  protected isThere(points: CurvePoint[]): boolean {
    return points.length > 1;
  }

  protected columns(points: CurvePoint[]): (number | null)[][] {
    const scaled = (of: (point: CurvePoint) => number | null) =>
      points.map((point) => {
        const value = of(point);
        return value === null ? null : value * settings.scale;
      });
    const edge = (sign: number) => scaled((p) => (half(p.u_dps) === null ? null : p.correction_dps + sign * half(p.u_dps)!));
    return [
      points.map((p) => p.temp_c),
      edge(1),
      edge(-1),
      scaled((p) => p.correction_dps),
      scaled((p) => p.truth_dps),
    ];
  }

  protected drawing(colours: Palette): Drawing {
    return {
      ...overTemperature(colours, "added to the rate"),
      ...banded(faint(colours.corrected, 0.22), dotted(colours.corrected, 2), expected(colours)),
    };
  }

  protected told(points: CurvePoint[]): Told {
    const text = (dps: number | null, u: number | null) =>
      dps === null ? "–" : value(dps * settings.scale, u === null ? null : u * settings.scale);
    return {
      summary:
        `What is added to the rate, at ${points.length} temperatures from ${significant(points[0]!.temp_c, 4)} to ` +
        `${significant(points[points.length - 1]!.temp_c, 4)} °C`,
      head: ["°C", `added, ${settings.unitText}`, "± 95 %", "truth (twin)"],
      rows: points.map((p) => [
        value(p.temp_c, 0.01),
        text(p.correction_dps, half(p.u_dps)),
        text(half(p.u_dps), half(p.u_dps)),
        text(p.truth_dps, half(p.u_dps)),
      ]),
    };
  }
}
