/** The range of an axis. To keep a live chart still, it grows at once but shrinks only when much of it is empty. */
export class Extent {
  #min = NaN;
  #max = NaN;
  /** The smallest and largest value of the last drawing; undefined if it had none. */
  seen: [number, number] | undefined;

  constructor(readonly least: number) {}

  forget(): void {
    this.#min = this.#max = NaN;
  }

  around(low: Float64Array, high: Float64Array, count: number, scale: number): { min: number; max: number } {
    let [least, largest] = [Infinity, -Infinity];
    for (let bin = 0; bin < count; bin++) {
      if (low[bin]! < least) least = low[bin]!;
      if (high[bin]! > largest) largest = high[bin]!;
    }
    this.seen = least <= largest ? [least, largest] : undefined;
    if (this.seen) this.#fit(least, largest, scale);
    return Number.isFinite(this.#min) ? { min: this.#min, max: this.#max } : { min: -this.least, max: this.least };
  }

  #fit(least: number, largest: number, scale: number): void {
    const fits = least >= this.#min && largest <= this.#max;
    const needed = Math.max(largest - least, this.least);
    if (fits && this.#max - this.#min <= 2.2 * needed) return;
    const middle = (least + largest) / 2;
    const step = nice((1.3 * needed * scale) / 4) / scale;
    this.#min = Math.floor((middle - 0.65 * needed) / step) * step;
    this.#max = Math.ceil((middle + 0.65 * needed) / step) * step;
  }
}

/** The least value of 1, 2 or 5 times a power of ten that is not below `step`. */
function nice(step: number): number {
  const power = 10 ** Math.floor(Math.log10(step));
  const times = [1, 2, 5, 10].find((of) => of * power >= step * 0.999) ?? 10;
  return times * power;
}
