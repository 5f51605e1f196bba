/** What a window and the live worker say to each other: docs/formats/page.md. */

/** What is to be read. */
export type Opening =
  /** The twin; `keys` are those after `twin:`. */
  | { is: "twin"; keys: string }
  /** A recording. */
  | { is: "capture"; file: File }
  /** A bridge behind the serial port of the window that says so. */
  | { is: "serial" };

/** From a window. */
export type ToLive =
  | { do: "hello"; calibrations: string[]; applied: string | null; open: Opening }
  | { do: "ask"; text: string }
  | { do: "open"; what: Opening }
  | { do: "serial-bytes"; bytes: Uint8Array }
  | { do: "serial-gone"; why: string }
  | { do: "bye" };

/** To a window. */
export type FromLive =
  | { is: "frame"; bytes: ArrayBuffer }
  | { is: "answer"; text: string }
  | { is: "serial-send"; bytes: Uint8Array }
  /** Another window opened another device. */
  | { is: "serial-release" }
  /** There will be no session: the module does not run here. */
  | { is: "failed"; why: string };
