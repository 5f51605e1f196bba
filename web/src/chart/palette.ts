/** Colours of the charts, as the style sheet has them for the theme in force. */
export interface Palette {
  muted: string;
  grid: string;
  raw: string;
  corrected: string;
  temp: string;
  noise: string;
  model: string;
  cursor: string;
  warn: string;
}

const NAMES = [
  "muted",
  "grid",
  "raw",
  "corrected",
  "temp",
  "noise",
  "model",
  "cursor",
  "warn",
] as const;

/** Read anew: the theme may have changed. */
export function palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(
    NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]),
  ) as unknown as Palette;
}

/** The same colour, let through: `#rrggbb` and an alpha. */
export function faint(colour: string, alpha: number): string {
  if (!/^#[0-9a-f]{6}$/i.test(colour)) return colour;
  return (
    colour +
    Math.round(alpha * 255)
      .toString(16)
      .padStart(2, "0")
  );
}
