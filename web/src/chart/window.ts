import type { Ring } from "../ring";

/** The largest number of bins that are drawn. */
export const DRAWN = 2400;

/** The spans to choose from, s. */
export const SPANS = [1, 10, 60, 600, 3600] as const;
const SHORTEST_S = 0.02;
const LONGEST_S = 4 * 3600;

/** The displayed time: the newest `span_s` seconds, or an interval that is held. */
export class TimeWindow {
  span_s = 10;
  #held: { from: number; to: number } | undefined;
  #newest = 0;

  /** True if an interval is held, so that the view does not follow the newest samples. */
  get held(): boolean {
    return this.#held !== undefined;
  }

  /** Sets the newest time, s since the first sample. */
  follow(newest_s: number): void {
    this.#newest = newest_s;
  }

  get from(): number {
    return this.#held?.from ?? this.to - this.span_s;
  }

  get to(): number {
    return this.#held?.to ?? Math.max(this.#newest, this.span_s);
  }

  live(): void {
    this.#held = undefined;
  }

  hold(from = this.from, to = this.to): void {
    if (to - from < SHORTEST_S) return;
    this.#held = { from, to };
    this.span_s = Math.min(to - from, LONGEST_S);
  }

  choose(span_s: number): void {
    if (this.#held) {
      const middle = (this.from + this.to) / 2;
      this.#held = { from: middle - span_s / 2, to: middle + span_s / 2 };
    }
    this.span_s = span_s;
  }

  /** Zooms around a time, and then holds the interval. Without a time, a window that follows goes on to follow. */
  zoom(factor: number, around_s?: number): void {
    const span = Math.min(LONGEST_S, Math.max(SHORTEST_S, (this.to - this.from) * factor));
    if (!this.#held && around_s === undefined) {
      this.span_s = span;
      return;
    }
    const at = around_s ?? (this.from + this.to) / 2;
    const share = (at - this.from) / (this.to - this.from);
    this.hold(at - share * span, at - share * span + span);
  }

  /** Moves by a share of the displayed span. */
  pan(share: number): void {
    const by = share * (this.to - this.from);
    if (!this.#held && by > 0) return;
    this.hold(this.from + by, this.to + by);
    if (this.from > this.#newest) this.live();
  }
}

/** The ring with the shortest bins that covers the displayed time with at most `DRAWN` bins, or else the coarsest. */
export function levelFor(levels: readonly Ring[], from_s: number, to_s: number): Ring | undefined {
  const begin_s = Math.max(from_s, 0);
  for (const ring of levels) {
    const covers = ring.oldest * ring.bin_s <= begin_s + ring.bin_s || ring.oldest === 0;
    if ((to_s - from_s) / ring.bin_s <= DRAWN && covers) return ring;
  }
  return levels[levels.length - 1];
}
