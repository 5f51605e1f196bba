// The messages between the page and the worker that reads a log. Static and served pages have the same worker.

import type { Download, LogAxis, LogBias, LogSettings, LogSummary, LogInspection, NoiseFileCommand } from "../protocol";

/** Messages to the worker. The page can end the worker at any time. */
export type ToLog =
  | { do: "look"; file: File; settings: LogSettings }
  | { do: "analyse" }
  | { do: "noise-file"; command: NoiseFileCommand };

/** Messages from the worker. `looked` answers `look`. `analyse` is answered by an `axis` for each column, a `bias` if
 * there is one, and then the `summary`. */
export type FromLog =
  /** Progress of the work: its share (0 … 1, if known), and what is being done. */
  | { is: "progress"; share: number | null; text: string }
  | { is: "looked"; looked: LogInspection }
  | { is: "axis"; axis: LogAxis }
  | { is: "bias"; bias: LogBias }
  | { is: "summary"; summary: LogSummary }
  | { is: "file"; file: Download }
  | { is: "failed"; why: string };
