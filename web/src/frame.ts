import type { Frame } from "./protocol";

export interface Framed {
  frame: Frame;
  payload: Float32Array;
}

/** Parses a frame (docs/formats/page.md). */
export function unframe(bytes: ArrayBuffer): Framed {
  const length = new DataView(bytes).getUint32(0, true);
  if (length > bytes.byteLength - 4) throw new RangeError("a frame ends within its header");
  const frame = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as Frame;
  const from = Math.ceil((4 + length) / 4) * 4;
  const numbers = Math.max(0, Math.floor((bytes.byteLength - from) / 4));
  return { frame, payload: numbers > 0 ? new Float32Array(bytes, from, numbers) : new Float32Array(0) };
}
