// A bridge at a serial port of this window. Bytes go from the bridge to the worker, and from the worker to the bridge.

/** True if this browser can read serial ports: one based on Chromium, on a computer, over https or localhost. */
export const canReadPorts = (): boolean => "serial" in navigator;

export const NO_SERIAL =
  "This browser does not give pages a serial port. Use Chrome, Edge or Opera on a computer, over https or from " +
  "localhost, or run `zerorate serve --device bridge:/dev/ttyACM0`.";

/** Baud rate of a UART, enough for the full rate with every temperature. USB ignores it. */
const BAUD = 3_000_000;

export interface PortEvents {
  received(bytes: Uint8Array): void;
  gone(why: string): void;
}

/** Asks the user for a port, which the browser allows only in a click. Null if the user chose none. */
export async function choosePort(): Promise<SerialPort | null> {
  if (!canReadPorts()) throw new Error(NO_SERIAL);
  try {
    return await navigator.serial.requestPort();
  } catch (why) {
    if (why instanceof DOMException && why.name === "NotFoundError") return null;
    throw why;
  }
}

/** The port that the user chose before, so that a reload needs no click. Null if there are several or none. */
export async function knownPort(): Promise<SerialPort | null> {
  if (!canReadPorts()) return null;
  const ports = await navigator.serial.getPorts();
  return ports.length === 1 ? (ports[0] ?? null) : null;
}

export class OpenPort {
  private reader: ReadableStreamDefaultReader<Uint8Array> | undefined;
  private writing: Promise<void> = Promise.resolve();
  private ended = false;

  private constructor(
    private readonly port: SerialPort,
    private readonly events: PortEvents,
  ) {}

  static async open(port: SerialPort, events: PortEvents): Promise<OpenPort> {
    try {
      await port.open({ baudRate: BAUD, bufferSize: 65_536 });
    } catch (why) {
      const reason = why instanceof Error ? why.message : String(why);
      throw new Error(`The port cannot be opened (${reason}). Check that no other program or window uses it.`);
    }
    const opened = new OpenPort(port, events);
    void opened.read();
    return opened;
  }

  /** Writes bytes in order. An error ends the reading of the port, which reports it. */
  send(bytes: Uint8Array): void {
    this.writing = this.writing.then(() => this.write(bytes)).catch((why: unknown) => this.end(why));
  }

  async close(): Promise<void> {
    this.ended = true;
    await this.reader?.cancel().catch(() => {});
    await this.writing;
    await this.port.close().catch(() => {});
  }

  private async write(bytes: Uint8Array): Promise<void> {
    if (this.ended || this.port.writable === null) return;
    const writer = this.port.writable.getWriter();
    try {
      await writer.write(bytes);
    } finally {
      writer.releaseLock();
    }
  }

  /** Reads until the port is gone. Reading goes on after an error that the port survives, such as a framing error. */
  private async read(): Promise<void> {
    let why: unknown = "the port was closed";
    while (!this.ended && this.port.readable !== null) {
      this.reader = this.port.readable.getReader();
      try {
        for (;;) {
          const { value, done } = await this.reader.read();
          if (done) break;
          this.events.received(value);
        }
        break;
      } catch (error) {
        why = error;
      } finally {
        this.reader.releaseLock();
      }
    }
    this.end(why);
  }

  private end(why: unknown): void {
    if (this.ended) return;
    this.ended = true;
    this.events.gone(why instanceof Error ? why.message : String(why));
    void this.port.close().catch(() => {});
  }
}
