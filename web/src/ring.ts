/** The quantities of a bin, in the order of the payload, which has the smallest and then the largest value of each. */
export const COLUMNS = ["rate", "corrected", "temp"] as const;
export type Column = (typeof COLUMNS)[number];

/** The newest bins of one axis with one bin width, in fixed memory. */
export class Ring {
  readonly #columns: Float32Array[];
  #first = 0;
  /** Number of the bin after the newest. */
  next = 0;

  constructor(
    readonly size: number,
    readonly bin_s: number,
  ) {
    this.#columns = Array.from({ length: 6 }, () => new Float32Array(size).fill(NaN));
  }

  /** Number of the oldest bin that is kept. */
  get oldest(): number {
    return Math.max(this.#first, this.next - this.size);
  }

  /** Takes complete bins; some of them may be known already. Bins that did not arrive stay empty. */
  write(first: number, count: number, payload: Float32Array, at: number): void {
    if (this.next === 0 || first - this.next >= this.size) this.#first = this.next = first;
    for (; this.next < first; this.next++)
      this.#columns.forEach((column) => {
        column[this.next % this.size] = NaN;
      });
    const skip = Math.max(0, count - this.size);
    for (let column = 0; column < 6; column++) {
      const from = at + column * count;
      for (let bin = skip; bin < count; bin++)
        this.#columns[column]![(first + bin) % this.size] = payload[from + bin]!;
    }
    this.next = Math.max(this.next, first + count);
  }

  /** Copies the bins `from` to `to` − 1, which the ring must have, as far as they fit. Returns their number. */
  copy(column: Column, from: number, to: number, least: Float64Array, largest: Float64Array): number {
    const low = this.#columns[2 * COLUMNS.indexOf(column)]!;
    const high = this.#columns[2 * COLUMNS.indexOf(column) + 1]!;
    const count = Math.min(to - from, least.length);
    for (let bin = 0; bin < count; bin++) {
      least[bin] = low[(from + bin) % this.size]!;
      largest[bin] = high[(from + bin) % this.size]!;
    }
    return Math.max(0, count);
  }
}
