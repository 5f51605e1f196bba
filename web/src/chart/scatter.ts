import { both, significant, value } from "../digits";
import type { TemperaturePoint } from "../protocol";
import { say } from "../dom";
import { settings } from "../settings";
import { banded, dotted, type Drawing, Figure, overTemperature, type Told } from "./figure";
import { faint, type Palette } from "./palette";

/** The bias over the temperature: means of the time that the part spent at each. */
export class Scatter extends Figure<TemperaturePoint[]> {
  protected isThere(points: TemperaturePoint[]): boolean {
    return points.length > 0;
  }

  protected columns(points: TemperaturePoint[]): (number | null)[][] {
    const sorted = [...points].sort((a, b) => a.temp_c - b.temp_c);
    const scaled = (of: (point: TemperaturePoint) => number) => sorted.map((point) => of(point) * settings.scale);
    return [
      sorted.map((p) => p.temp_c),
      scaled((p) => p.rate_dps + p.u_dps),
      scaled((p) => p.rate_dps - p.u_dps),
      scaled((p) => p.rate_dps),
    ];
  }

  protected drawing(colours: Palette): Drawing {
    return { ...overTemperature(colours, "rate"), ...banded(faint(colours.temp, 0.2), dotted(colours.temp, 1)) };
  }

  protected told(points: TemperaturePoint[]): Told {
    const temps = points.map((p) => p.temp_c);
    say(this.note, line(points));
    return {
      summary: `Rate at ${points.length} temperatures from ${significant(Math.min(...temps), 4)} to ${significant(Math.max(...temps), 4)} °C`,
      head: ["°C", `rate, ${settings.unitText}`, "time there, s"],
      rows: points.map((p) => [
        value(p.temp_c, 0.01),
        both(p.rate_dps * settings.scale, p.u_dps * settings.scale),
        String(p.seconds),
      ]),
    };
  }
}

/** The straight line through the points, weighted by their uncertainty: its slope is minus BTC, as far as noise goes. */
function line(points: TemperaturePoint[]): string {
  const weighted = points.filter((p) => p.u_dps > 0).map((p) => ({ ...p, weight: 1 / p.u_dps ** 2 }));
  const sum = (of: (p: (typeof weighted)[number]) => number) =>
    weighted.reduce((all, p) => all + p.weight * of(p), 0);
  const [weight, temp] = [sum(() => 1), sum((p) => p.temp_c)];
  const spread = sum((p) => (p.temp_c - temp / weight) ** 2);
  if (weighted.length < 3 || !(spread > 0)) return "";
  const slope = sum((p) => (p.temp_c - temp / weight) * p.rate_dps) / spread;
  const { scale, unitText } = settings;
  return `Straight line: ${both(slope * scale, scale / Math.sqrt(spread))} ${unitText}/°C (white noise alone)`;
}
