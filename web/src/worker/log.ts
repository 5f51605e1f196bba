// Reads a log that was dropped on the page, static or served. The file is read in pieces and never loaded as a whole.

import init, { Log } from "../../gen/zerorate_log";
import type { LogAxis, LogBias, LogSettings, LogSummary, LogInspection } from "../protocol";
import { serveFile } from "./file";
import type { FromLog, ToLog } from "./log-messages";

const scope = self as unknown as DedicatedWorkerGlobalScope;
const tell = (told: FromLog) => scope.postMessage(told);

let log: Log | undefined;
const ready = init({ module_or_path: new URL("zerorate_log_bg.wasm", import.meta.url) });

function look(file: File, settings: LogSettings): void {
  log?.free();
  log = undefined;
  serveFile(file, (read, size) => {
    tell({ is: "progress", share: read / size, text: `reading: ${Math.round(read / 1e6)} MB` });
  });
  log = new Log(file.name, file.size, JSON.stringify(settings));
  tell({ is: "looked", looked: JSON.parse(log.looked()) as LogInspection });
}

function analyse(open: Log): void {
  const count = open.left();
  for (let done = 0; done < count; done += 1) {
    tell({ is: "progress", share: done / count, text: `analysing column ${done + 1} of ${count}` });
    const axis = open.analyse();
    if (axis !== undefined) tell({ is: "axis", axis: JSON.parse(axis) as LogAxis });
  }
  tell({ is: "progress", share: null, text: "fitting the bias over temperature" });
  const bias = open.bias();
  if (bias !== undefined) tell({ is: "bias", bias: JSON.parse(bias) as LogBias });
  tell({ is: "progress", share: null, text: "drawing" });
  tell({ is: "summary", summary: JSON.parse(open.summary()) as LogSummary });
}

function answer(asked: ToLog): void {
  if (asked.do === "look") look(asked.file, asked.settings);
  else if (log === undefined) tell({ is: "failed", why: "No log has been read yet." });
  else if (asked.do === "analyse") analyse(log);
  else tell({ is: "file", file: JSON.parse(log.noise_file(JSON.stringify(asked.command))) });
}

/** The reason of an error in words. A module that trapped does not run again. */
function reason(why: unknown): string {
  if (!(why instanceof WebAssembly.RuntimeError)) return why instanceof Error ? why.message : String(why);
  return "The reader gave up on this file: it is damaged, or needs more memory than a page can have. Try `zerorate imu`.";
}

scope.onmessage = async ({ data }: MessageEvent<ToLog>) => {
  try {
    await ready;
    answer(data);
  } catch (why) {
    tell({ is: "failed", why: reason(why) });
  }
};
