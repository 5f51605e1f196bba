import type uPlot from "uplot";
import { significant, value } from "../digits";
import type { CurvePoint } from "../protocol";
import { settings } from "../settings";
import { axis, Figure, padded, tick, type Told } from "./figure";
import { faint, type Palette } from "./palette";

/** What a calibration adds at each temperature, its band of one sigma, and on the twin the truth. */
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
    const edge = (sign: number) => scaled((p) => (p.u_dps === null ? null : p.correction_dps + sign * p.u_dps));
    return [
      points.map((p) => p.temp_c),
      edge(1),
      edge(-1),
      scaled((p) => p.correction_dps),
      scaled((p) => p.truth_dps),
    ];
  }

  protected options(colours: Palette): Omit<uPlot.Options, "width" | "height"> {
    const edge = { stroke: "transparent", points: { show: false } };
    return {
      legend: { show: false },
      cursor: { show: false },
      padding: [8, 10, 0, 0],
      scales: {
        x: { time: false, range: (_, least, largest) => padded(least, largest, 0.1) },
        y: { range: (_, least, largest) => padded(least, largest, 0.002 * settings.scale) },
      },
      axes: [
        axis(colours, "temperature, °C", { size: 26, values: (_, splits) => splits.map(tick) }),
        axis(colours, `added to the rate, ${settings.unitText}`, {
          size: 58,
          values: (_, splits) => splits.map(tick),
        }),
      ],
      series: [
        {},
        { ...edge },
        { ...edge },
        { stroke: colours.corrected, width: 2, points: { show: true, size: 5, fill: colours.corrected } },
        { stroke: colours.model, width: 1.5, dash: [6, 4], points: { show: false } },
      ],
      bands: [{ series: [1, 2], fill: faint(colours.corrected, 0.22) }],
    };
  }

  protected told(points: CurvePoint[]): Told {
    const text = (dps: number | null, u: number | null) =>
      dps === null ? "–" : value(dps * settings.scale, u === null ? null : u * settings.scale);
    return {
      summary:
        `What is added to the rate, at ${points.length} temperatures from ${significant(points[0]!.temp_c, 4)} to ` +
        `${significant(points[points.length - 1]!.temp_c, 4)} °C`,
      head: ["°C", `added, ${settings.unitText}`, "± one sigma", "truth (twin)"],
      rows: points.map((p) => [
        value(p.temp_c, 0.01),
        text(p.correction_dps, p.u_dps),
        text(p.u_dps, p.u_dps),
        text(p.truth_dps, p.u_dps),
      ]),
    };
  }
}
