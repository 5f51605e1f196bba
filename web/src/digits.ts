/** Formats numbers with the digits that their uncertainty warrants. */

const MINUS = "\u2212";
const THIN = "\u2009";
const NONE = "\u2013";

function signed(text: string): string {
  const zero = !/[1-9]/.test(text);
  const bare = text.replace("-", "");
  return text.startsWith("-") && !zero ? MINUS + bare : bare;
}

/** Power of ten of the second significant digit of an uncertainty, after rounding (0.0996 is 0.10). */
function place(u: number): number {
  return Math.floor(Math.log10(Number(u.toPrecision(2)))) - 1;
}

function at(value: number, place: number): string {
  if (place <= 0) return signed(value.toFixed(Math.min(12, -place)));
  const unit = 10 ** place;
  return signed((Math.round(value / unit) * unit).toFixed(0));
}

function usable(u: number | null | undefined): u is number {
  return u !== null && u !== undefined && Number.isFinite(u) && u > 0;
}

/** Half width of the 95 % interval for a standard uncertainty. Every ± on the page is such a half width. */
export function half(u: number | null | undefined): number | null {
  return usable(u) ? 1.959963984540054 * u : null;
}

/** A value rounded to the second digit of the half width `u` of its interval; without `u`, `significant` to four. */
export function value(value: number | null | undefined, u?: number | null): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  return usable(u) ? at(value, place(u)) : significant(value, 4);
}

/** Formats the half width `u` of an interval with two significant digits. */
export function uncertainty(u: number | null | undefined): string {
  return usable(u) ? at(u, place(u)) : NONE;
}

/** Formats a value with its half width: `1.234 ± 0.012`. */
export function both(number: number | null | undefined, u: number | null | undefined): string {
  return usable(u) ? `${value(number, u)} ± ${uncertainty(u)}` : value(number);
}

/** A value with `digits` significant digits, or with all digits before the point. Powers of ten replace many zeros. */
export function significant(value: number | null | undefined, digits: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  if (value === 0) return "0";
  const power = Math.floor(Math.log10(Math.abs(Number(value.toPrecision(digits)))));
  if (power >= -5 && power < 6) return at(value, Math.min(power - digits + 1, 0));
  const mantissa = signed((value / 10 ** power).toFixed(digits - 1));
  return `${mantissa} × 10${superscript(power)}`;
}

export function superscript(power: number): string {
  return [...String(power)].map((sign) => (sign === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(sign)]!)).join("");
}

/** Formats a number in groups of three digits: `12 345 678`. */
export function count(number: number): string {
  return String(Math.round(number)).replace(/\B(?=(\d{3})+$)/g, THIN);
}

/** Formats a duration: `2 h 10 min`, `3 min 20 s`, `45 s`, `0.25 s`. */
export function duration(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return NONE;
  const whole = Math.round(seconds);
  if (Math.abs(seconds) < 9.95 && seconds !== whole) return `${significant(seconds, 2)} s`;
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return pair(whole, 60, "min", "s");
  if (whole < 86_400) return pair(Math.round(whole / 60), 60, "h", "min");
  return pair(Math.round(whole / 3600), 24, "d", "h");
}

function pair(total: number, per: number, big: string, small: string): string {
  const rest = total % per;
  const head = `${Math.floor(total / per)} ${big}`;
  return rest === 0 ? head : `${head} ${rest} ${small}`;
}

/** A time since the first sample: `1 h 2 min 3 s`, `45.25 s`. The units distinguish it from a clock time. */
export function moment(seconds: number, decimals: number): string {
  const sign = seconds < 0 ? MINUS : "";
  const rounded = Number(Math.abs(seconds).toFixed(decimals));
  const hours = Math.floor(rounded / 3600);
  const minutes = Math.floor((rounded % 3600) / 60);
  const parts = [`${(rounded % 60).toFixed(decimals)} s`];
  if (rounded >= 60) parts.unshift(`${minutes} min`);
  if (rounded >= 3600) parts.unshift(`${hours} h`);
  return sign + parts.join(" ");
}

/** Number of decimals that the multiples of a step need: 2 for 0.05, and 3 for 0.025. */
export function decimalsOf(step: number): number {
  return (String(Number(step.toPrecision(3))).split(".")[1] ?? "").length;
}

/** A number of the time axis, in the largest unit that divides the step between two of them: `120 s`, `2 min`, `3 h`. */
export function onAxis(seconds: number, step: number): string {
  for (const [size, unit] of [[3600, "h"], [60, "min"]] as const) {
    if (step >= size && step % size === 0) return `${Math.round(seconds / size)} ${unit}`;
  }
  const decimals = Math.max(0, Math.min(3, -Math.floor(Math.log10(step) + 1e-9)));
  return `${seconds.toFixed(decimals)} s`;
}

/** Formats a hexadecimal number: `07h` for 8 bits. */
export function hex(value: number, bits: number): string {
  return `${value
    .toString(16)
    .toUpperCase()
    .padStart(Math.ceil(bits / 4), "0")}h`;
}
