import type uPlot from "uplot";
import { significant } from "../digits";
import type { SpectrumMark, SpectrumPoint } from "../protocol";
import { settings } from "../settings";
import { axis, decades, DECADES, type Drawing, Figure, type Told } from "./figure";
import type { Palette } from "./palette";

export interface Spectral {
  points: SpectrumPoint[];
  marks: SpectrumMark[];
}

/** The label of each kind of mark in the chart. The list below the chart has the full texts. */
const SHORT: Record<SpectrumMark["kind"], string> = {
  bandwidth: "−3 dB",
  nyquist: "½ rate",
  resonance: "resonance",
  line: "line",
};

/** The amplitude spectral density, log-log, with marks at its features. */
export class Spectrum extends Figure<Spectral> {
  protected isThere({ points }: Spectral): boolean {
    return points.length > 1;
  }

  protected columns({ points }: Spectral): (number | null)[][] {
    const shown = points.filter((p) => p.hz > 0);
    return [
      shown.map((p) => p.hz),
      shown.map((p) => (p.density_dps_per_rt_hz > 0 ? p.density_dps_per_rt_hz * settings.scale : null)),
    ];
  }

  protected drawing(colours: Palette): Drawing {
    return {
      scales: {
        x: { time: false, distr: 3, range: (_, least, largest) => [least, this.#end(largest)] },
        y: { distr: 3, range: (_, least, largest) => decades(least, largest) },
      },
      axes: [
        axis(colours, "frequency, Hz", { size: 26, ...DECADES }),
        axis(colours, `${settings.unitText}/√Hz`, { size: 46, ...DECADES }),
      ],
      series: [{}, { stroke: colours.noise, width: 1.2, points: { show: false } }],
      hooks: { draw: [(u) => this.#marks(u, colours)] },
    };
  }

  protected told({ points, marks }: Spectral): Told {
    const unit = `${settings.unitText}/√Hz`;
    const text = (p: SpectrumPoint) => significant(p.density_dps_per_rt_hz * settings.scale, 3);
    return {
      summary:
        `Spectrum from ${significant(points[0]!.hz, 2)} to ${significant(points[points.length - 1]!.hz, 4)} Hz. ` +
        marks.map((mark) => `${mark.text}.`).join(" "),
      head: ["Hz", unit],
      rows: points.map((p) => [significant(p.hz, 4), text(p)]),
    };
  }

  #end(largest: number): number {
    return Math.max(largest, ...(this.data?.marks ?? []).map((mark) => mark.hz)) * 1.02;
  }

  #marks(u: uPlot, colours: Palette): void {
    const { ctx, bbox } = u;
    const pixel = devicePixelRatio;
    ctx.save();
    ctx.font = `${11 * pixel}px system-ui, sans-serif`;
    ctx.textAlign = "right";
    ctx.setLineDash([3 * pixel, 3 * pixel]);
    const marks = [...(this.data?.marks ?? [])].sort((a, b) => a.hz - b.hz);
    marks.forEach((mark, row) => {
      const x = u.valToPos(mark.hz, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width + 1) return;
      ctx.strokeStyle = ctx.fillStyle = mark.kind === "line" ? colours.warn : colours.muted;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.fillText(SHORT[mark.kind], x - 3 * pixel, bbox.top + (11 + 13 * (row % 4)) * pixel);
    });
    ctx.restore();
  }
}
