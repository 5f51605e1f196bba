// Reads a log that was dropped on the page, in both homes. The bytes are read where they lie, a piece at a time.

import init, { Log } from "../../gen/zerorate_log";
import type { LogAxis, LogSettings, LogSummary, Looked } from "../protocol";
import type { FromLog, ToLog } from "./log-messages";

const scope = self as unknown as DedicatedWorkerGlobalScope;
const tell = (told: FromLog) => scope.postMessage(told);

/** Bytes that are read at once: readers ask for a few at a time, and the browser takes its time for each. */
const PIECE = 1 << 20;

/** The file under work, with the piece that was read last. */
class Bytes {
  private piece = new Uint8Array(0);
  private from = 0;
  private furthest = 0;
  private readonly reader = new FileReaderSync();

  constructor(readonly file: File) {}

  readAt(at: number, into: Uint8Array): number {
    if (into.length >= PIECE) return this.copy(this.read(at, into.length), 0, into);
    if (at < this.from || at >= this.from + this.piece.length) {
      this.piece = this.read(at, PIECE);
      this.from = at;
    }
    return this.copy(this.piece, at - this.from, into);
  }

  private copy(bytes: Uint8Array, at: number, into: Uint8Array): number {
    const found = bytes.subarray(at, at + into.length);
    into.set(found);
    return found.length;
  }

  private read(at: number, length: number): Uint8Array<ArrayBuffer> {
    const bytes = new Uint8Array(this.reader.readAsArrayBuffer(this.file.slice(at, at + length)));
    if (at + bytes.length > this.furthest) {
      this.furthest = at + bytes.length;
      const megabytes = Math.round(this.furthest / 1e6);
      tell({ is: "progress", share: this.furthest / this.file.size, text: `reading: ${megabytes} MB` });
    }
    return bytes;
  }
}

let bytes: Bytes | undefined;
let log: Log | undefined;
// What the module calls; a worker reads one file at a time.
Object.assign(scope, { zerorate: { readAt: (at: number, into: Uint8Array) => bytes?.readAt(at, into) ?? 0 } });
const ready = init({ module_or_path: new URL("zerorate_log_bg.wasm", import.meta.url) });

function look(file: File, settings: LogSettings): void {
  log?.free();
  log = undefined;
  bytes = new Bytes(file);
  log = new Log(file.name, file.size, JSON.stringify(settings));
  tell({ is: "looked", looked: JSON.parse(log.looked()) as Looked });
}

function analyse(open: Log): void {
  const count = open.left();
  for (let done = 0; done < count; done += 1) {
    tell({ is: "progress", share: done / count, text: `analysing column ${done + 1} of ${count}` });
    const axis = open.analyse();
    if (axis !== undefined) tell({ is: "axis", axis: JSON.parse(axis) as LogAxis });
  }
  tell({ is: "progress", share: null, text: "drawing" });
  tell({ is: "summary", summary: JSON.parse(open.summary()) as LogSummary });
}

function answer(asked: ToLog): void {
  if (asked.do === "look") look(asked.file, asked.settings);
  else if (log === undefined) tell({ is: "failed", why: "there is no log that was read" });
  else if (asked.do === "analyse") analyse(log);
  else tell({ is: "file", file: JSON.parse(log.noise_file(JSON.stringify(asked.wish))) });
}

/** A module that trapped does not run again. */
function reason(why: unknown): string {
  if (!(why instanceof WebAssembly.RuntimeError)) return why instanceof Error ? why.message : String(why);
  return "the reader gave up on this file: it is damaged, or it takes more memory than a page can have; try `zerorate imu`";
}

scope.onmessage = async ({ data }: MessageEvent<ToLog>) => {
  try {
    await ready;
    answer(data);
  } catch (why) {
    tell({ is: "failed", why: reason(why) });
  }
};
