/** The messages between a window and the live worker: docs/formats/page.md. */

/** The device to read. */
export type Opening =
  /** The twin; `keys` is the text after `twin:`. */
  | { is: "twin"; keys: string }
  | { is: "capture"; file: File }
  /** A bridge at the serial port of the window that sends this. */
  | { is: "serial" };

export type ToLive =
  | { do: "hello"; calibrations: string[]; applied: string | null; open: Opening }
  | { do: "ask"; text: string }
  | { do: "open"; what: Opening }
  | { do: "serial-bytes"; bytes: Uint8Array }
  | { do: "serial-gone"; why: string }
  | { do: "bye" };

export type FromLive =
  | { is: "frame"; bytes: ArrayBuffer }
  | { is: "answer"; text: string }
  | { is: "serial-send"; bytes: Uint8Array }
  /** Another window opened another device, so the session no longer reads the port of this window. */
  | { is: "serial-release" }
  /** There is no session: its module does not run here, broke down, or could not open a device. */
  | { is: "failed"; why: string };
