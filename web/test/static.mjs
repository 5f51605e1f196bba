// A file server for tests. It serves a folder, and connects WebSockets to a TCP port if one is given.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { after, before } from "node:test";
import { WebSocketServer } from "ws";
import { launch, PAGE, stopAll } from "./world.mjs";

const TYPES = {
  html: "text/html; charset=utf-8",
  js: "text/javascript",
  css: "text/css",
  wasm: "application/wasm",
  json: "application/json",
  svg: "image/svg+xml",
  webmanifest: "application/manifest+json",
};

/** A browser, the static page and a folder for all tests of a file. `begin` is called once they are there. */
export function staticHome(begin = async () => {}) {
  const home = { browser: undefined, site: undefined, folder: undefined };
  before(async () => {
    home.folder = mkdtempSync(`${tmpdir()}/zerorate-page-`);
    home.browser = await launch();
    home.site = await serveFolder(PAGE);
    await begin(home);
  });
  after(async () => {
    await home.browser?.close();
    home.site?.stop();
    if (home.folder) rmSync(home.folder, { recursive: true });
    stopAll();
  });
  return home;
}

/** Serves a folder, optionally below a path. `held` returns a promise that a file waits for. */
export async function serveFolder(folder, below = "/", held = async () => {}) {
  const asked = [];
  const server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url, "http://host");
    asked.push(pathname);
    const name = pathname.startsWith(below)
      ? pathname.slice(below.length).replace(/(^|\/)$/, "$1index.html")
      : "../none";
    await held(name);
    try {
      const type = TYPES[name.split(".").pop()] ?? "application/octet-stream";
      const bytes = name.includes("..") ? undefined : readFileSync(`${folder}/${name}`);
      response.writeHead(bytes ? 200 : 404, { "content-type": type }).end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const url = `http://127.0.0.1:${server.address().port}${below}`;
  const stop = () => {
    server.closeAllConnections();
    server.close();
  };
  return { server, url, stop, asked };
}

/** Connects a TCP port to a WebSocket of this server, because the page's policy allows no other host. */
export function proxy(server, path, port) {
  const sockets = new WebSocketServer({ server, path });
  sockets.on("connection", (socket) => {
    const wire = connect(port, "127.0.0.1").setNoDelay(true);
    wire.on("data", (bytes) => socket.send(bytes));
    wire.on("error", () => socket.close());
    wire.on("close", () => socket.close());
    socket.on("message", (bytes) => wire.write(bytes));
    socket.on("close", () => wire.destroy());
  });
  return sockets;
}
