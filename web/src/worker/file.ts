// Reads a file for the module of a worker, a piece at a time, without loading all of it.

/** Bytes that are read at once. Readers ask for a few bytes at a time, and each read of the browser is slow. */
const PIECE = 1 << 20;

class Pieces {
  private piece = new Uint8Array(0);
  private from = 0;
  private furthest = 0;
  private readonly reader = new FileReaderSync();

  constructor(
    private readonly file: File,
    private readonly progress: (read: number, size: number) => void,
  ) {}

  readAt(at: number, into: Uint8Array): number {
    if (into.length >= PIECE) return copied(this.read(at, into.length), 0, into);
    if (at < this.from || at >= this.from + this.piece.length) {
      this.piece = this.read(at, PIECE);
      this.from = at;
    }
    return copied(this.piece, at - this.from, into);
  }

  private read(at: number, length: number): Uint8Array<ArrayBuffer> {
    const bytes = new Uint8Array(this.reader.readAsArrayBuffer(this.file.slice(at, at + length)));
    if (at + bytes.length > this.furthest) {
      this.furthest = at + bytes.length;
      this.progress(this.furthest, this.file.size);
    }
    return bytes;
  }
}

function copied(bytes: Uint8Array, at: number, into: Uint8Array): number {
  const found = bytes.subarray(at, at + into.length);
  into.set(found);
  return found.length;
}

/**
 * Lets the module of this worker read a file. `progress` is called with the bytes read and the size. The returned
 * function restores the previous file.
 */
export function serveFile(file: File, progress: (read: number, size: number) => void = () => {}): () => void {
  const before = (self as { zerorate?: unknown }).zerorate;
  const pieces = new Pieces(file, progress);
  Object.assign(self, { zerorate: { readAt: (at: number, into: Uint8Array) => pieces.readAt(at, into) } });
  return () => Object.assign(self, { zerorate: before });
}
