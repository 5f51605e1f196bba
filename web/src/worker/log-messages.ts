// What the page and the worker that reads a log say to each other. The worker is the same in both homes.

import type { Download, LogAxis, LogSettings, LogSummary, Looked, NoiseFileCommand } from "../protocol";

/** To the worker. Of one that is ended while it works, nothing is left. */
export type ToLog =
  | { do: "look"; file: File; settings: LogSettings }
  | { do: "analyse" }
  | { do: "noise-file"; command: NoiseFileCommand };

/** From it. `look` is answered by `looked`, `analyse` by `axis` for each column and then `summary`. */
export type FromLog =
  /** Of the work under way: 0 … 1, where that is known, and what is being done. */
  | { is: "progress"; share: number | null; text: string }
  | { is: "looked"; looked: Looked }
  | { is: "axis"; axis: LogAxis }
  | { is: "summary"; summary: LogSummary }
  | { is: "file"; file: Download }
  | { is: "failed"; why: string };
