// Logs for the tests: white noise of known density in formats that a script can write. Other formats are fixtures.
import { readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { PATIENCE } from "./world.mjs";

const FIXTURES = new URL("../../crates/zerorate-logs/fixtures/", import.meta.url).pathname;

export const RATE_HZ = 100;
/** Standard deviation of a sample, °/s. Divided by √RATE_HZ, it is N = 0.01 °/√s. */
export const SD_DPS = 0.1;

/** Normal numbers, the same on every machine. */
function* normal(seed) {
  let state = seed >>> 0;
  const uniform = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state + 0.5) / 2 ** 32;
  };
  for (;;) yield Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

function rows(count) {
  const noise = normal(42);
  return Array.from({ length: count }, (_, k) => [
    k / RATE_HZ,
    ...[0, 0, 0].map(() => SD_DPS * noise.next().value),
  ]);
}

function text(count, head) {
  return [head, ...rows(count).map((row) => row.map((value) => value.toFixed(6)).join(","))].join("\n");
}

/** A log of half an hour at 10 Hz: a sensor that warms from 20 to 50 °C, whose bias rises by 0.002 °/s/°C. */
export function warming() {
  const noise = normal(43);
  const count = 18_000;
  const rows = Array.from({ length: count }, (_, k) => {
    const temp_c = 20 + (30 * k) / count;
    const rates = [0, 0, 0].map(() => 0.002 * temp_c + 0.2 * SD_DPS * noise.next().value);
    return [k / 10, ...rates, temp_c].map((value) => value.toFixed(6)).join(",");
  });
  return Buffer.from([`${STATED},temp_c`, ...rows].join("\n"));
}

function npy(count) {
  const table = rows(count).flatMap((row) => row.slice(1));
  return Buffer.concat([npyHead(count, 3), Buffer.from(Float64Array.from(table).buffer)]);
}

/** The header of an NPY file with f64 numbers, row by row. */
export function npyHead(rows, columns) {
  const head = `{'descr': '<f8', 'fortran_order': False, 'shape': (${rows}, ${columns}), }`;
  const padded = `${head.padEnd(Math.ceil((head.length + 11) / 64) * 64 - 11)}\n`;
  const bytes = Buffer.alloc(10 + padded.length);
  bytes.write("\x93NUMPY\x01\x00", "latin1");
  bytes.writeUInt16LE(padded.length, 8);
  bytes.write(padded, 10, "latin1");
  return bytes;
}

export const STATED = "time_s,gyro_x_dps,gyro_y_dps,gyro_z_dps";
const COUNT = 40_000;

/** Logs by name: their bytes, and answers to the page's questions if they do not state everything. */
export const LOGS = {
  "rest.csv": { bytes: () => Buffer.from(text(COUNT, STATED)) },
  "rest.csv.gz": { bytes: () => gzipSync(text(COUNT, STATED)) },
  "rest.npy": {
    bytes: () => npy(COUNT),
    answers: { rate_hz: String(RATE_HZ), gyro_unit: "dps", columns: "0,1,2" },
  },
};

/** Fixtures of the readers with a few messages each, enough to be recognised. */
export const SHORT = ["imu_none.bag", "imu_lz4.bag", "imu_bz2.bag", "imu_lz4.mcap", "imu_zstd.mcap", "imu.npz"];

/** Gives a log to the page and waits until its work is done. Returns the page's message. */
export async function giveLog(page, name, buffer, timeout = 2 * PATIENCE) {
  const file = typeof buffer === "string" ? buffer : { name, mimeType: "application/octet-stream", buffer };
  await page.setInputFiles(".intake input[type=file]", file);
  await logIsDone(page, timeout);
  return page.textContent(".log .doing");
}

export async function logIsDone(page, timeout = 2 * PATIENCE) {
  await page.waitForFunction(() => document.querySelector(".log .work button").hidden, null, { timeout });
}

export function fixture(name) {
  return readFileSync(`${FIXTURES}${name}`);
}
