import type { App } from "./app";
import { storage } from "./storage";
import type { Inside } from "./link/inside";
import { choosePort, knownPort, OpenPort } from "./serial";

let open: OpenPort | undefined;

/** Reads the port that the user chooses. The browser allows this only in a click. */
export async function connectChosen(app: App, inside: Inside): Promise<void> {
  try {
    const port = await choosePort();
    if (port) await connect(inside, port);
  } catch (why) {
    app.tell(why instanceof Error ? why.message : String(why), "wrong");
  }
}

/** After a reload, reads the port that was read before, unless another window has it. */
export async function connectAgain(inside: Inside): Promise<void> {
  const port = await knownPort().catch(() => null);
  if (port) await connect(inside, port).catch(() => {});
}

async function connect(inside: Inside, port: SerialPort): Promise<void> {
  await open?.close();
  const own = await OpenPort.open(port, {
    received: (bytes) => inside.tell({ do: "serial-bytes", bytes }, [bytes.buffer]),
    gone: (why) => inside.tell({ do: "serial-gone", why }),
  });
  open = own;
  inside.onserial = (bytes) => own.send(bytes);
  inside.onrelease = () => void close(inside);
  inside.open({ is: "serial" });
  storage.keepPort(true);
}

/** Gives the port back, for example when another device is opened. */
export async function release(inside: Inside): Promise<void> {
  storage.keepPort(false);
  await close(inside);
}

/** Closes the port and tells the session, which may still read it if no other device could be opened. */
async function close(inside: Inside): Promise<void> {
  const closing = open;
  if (closing === undefined) return;
  open = undefined;
  await closing.close();
  inside.tell({ do: "serial-gone", why: "the port was closed" });
}
