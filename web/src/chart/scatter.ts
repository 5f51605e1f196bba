import type uPlot from "uplot";
import { both, significant, value } from "../digits";
import type { TemperaturePoint } from "../protocol";
import { settings } from "../settings";
import { axis, Figure, padded, tick, type Told } from "./figure";
import { faint, type Palette } from "./palette";

/** The bias over the temperature: means of the time that the part spent at each. */
export class Scatter extends Figure<TemperaturePoint[]> {
  protected isThere(points: TemperaturePoint[]): boolean {
    return points.length > 0;
  }

  protected columns(points: TemperaturePoint[]): (number | null)[][] {
    const sorted = [...points].sort((a, b) => a.temp_c - b.temp_c);
    const scaled = (of: (point: TemperaturePoint) => number) => sorted.map((point) => of(point) * settings.scale);
    return [sorted.map((p) => p.temp_c), scaled((p) => p.rate_dps + p.u_dps), scaled((p) => p.rate_dps - p.u_dps), scaled((p) => p.rate_dps)];
  }

  protected options(colours: Palette): Omit<uPlot.Options, "width" | "height"> {
    const edge = { stroke: "transparent", points: { show: false } };
    return {
      legend: { show: false }, cursor: { show: false }, padding: [8, 10, 0, 0],
      scales: {
        x: { time: false, range: (_, least, largest) => padded(least, largest, 0.1) },
        y: { range: (_, least, largest) => padded(least, largest, 0.002 * settings.scale) },
      },
      axes: [
        axis(colours, "temperature, °C", { size: 26, values: (_, splits) => splits.map(tick) }),
        axis(colours, `rate, ${settings.unitText}`, { size: 58, values: (_, splits) => splits.map(tick) }),
      ],
      series: [{}, { ...edge }, { ...edge }, { stroke: colours.temp, width: 1, points: { show: true, size: 5, fill: colours.temp } }],
      bands: [{ series: [1, 2], fill: faint(colours.temp, 0.2) }],
    };
  }

  protected told(points: TemperaturePoint[]): Told {
    const temps = points.map((p) => p.temp_c);
    return {
      summary: `Rate at ${points.length} temperatures from ${significant(Math.min(...temps), 4)} to ${significant(Math.max(...temps), 4)} °C`,
      head: ["°C", `rate, ${settings.unitText}`, "time there, s"],
      rows: points.map((p) => [value(p.temp_c, 0.01), both(p.rate_dps * settings.scale, p.u_dps * settings.scale), String(p.seconds)]),
    };
  }
}
