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

/** The colours of the charts, taken from the style sheet for the current theme. */
export type Palette = Record<(typeof NAMES)[number], string>;

/** Reads the colours; the theme may have changed since the last time. */
export function palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(
    NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]),
  ) as unknown as Palette;
}

/** The colour `#rrggbb` with an alpha. A colour in another form is returned as it is. */
export function faint(colour: string, alpha: number): string {
  if (!/^#[0-9a-f]{6}$/i.test(colour)) return colour;
  return (
    colour +
    Math.round(alpha * 255)
      .toString(16)
      .padStart(2, "0")
  );
}
