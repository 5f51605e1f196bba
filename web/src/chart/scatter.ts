import { both, half, significant, value } from "../digits";
import type { OverTemperature, TemperatureLine, TemperaturePoint } from "../protocol";
import { say } from "../dom";
import { settings } from "../settings";
import { banded, dotted, type Drawing, Figure, overTemperature, type Told } from "./figure";
import { faint, type Palette } from "./palette";

/** The bias over temperature: the mean rate while the part was at each temperature. */
export class Scatter extends Figure<OverTemperature> {
  protected isThere({ points }: OverTemperature): boolean {
    return points.length > 0;
  }

  protected columns({ points }: OverTemperature): (number | null)[][] {
    const scaled = (of: (point: TemperaturePoint) => number) => points.map((point) => of(point) * settings.scale);
    return [
      points.map((p) => p.temp_c),
      scaled((p) => p.rate_dps + (half(p.u_dps) ?? 0)),
      scaled((p) => p.rate_dps - (half(p.u_dps) ?? 0)),
      scaled((p) => p.rate_dps),
    ];
  }

  protected drawing(colours: Palette): Drawing {
    return { ...overTemperature(colours, "rate"), ...banded(faint(colours.temp, 0.2), dotted(colours.temp, 1)) };
  }

  protected told({ points, line }: OverTemperature): Told {
    const temps = points.map((p) => p.temp_c);
    say(this.note, line === null ? "" : slope(line));
    return {
      summary: `Rate at ${points.length} temperatures from ${significant(Math.min(...temps), 4)} to ${significant(Math.max(...temps), 4)} °C`,
      head: ["°C", `rate ± 95 %, ${settings.unitText}`, "time there, s"],
      rows: points.map((p) => [
        value(p.temp_c, 0.01),
        both(p.rate_dps * settings.scale, half(p.u_dps * settings.scale)),
        String(p.seconds),
      ]),
    };
  }
}

/** The slope of the straight line, which is minus BTC within the noise. */
function slope({ slope_dps_per_c, u_dps_per_c }: TemperatureLine): string {
  const { scale, unitText } = settings;
  return `Straight line: ${both(slope_dps_per_c * scale, half(u_dps_per_c * scale))} ${unitText}/°C (95 %, white noise alone)`;
}
