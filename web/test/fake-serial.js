// A serial port whose bytes go through a WebSocket to a bridge. It is put into the page before the page's own script.
(() => {
  const makePort = () => {
    let socket;
    const port = { readable: null, writable: null, getInfo: () => ({}), addEventListener() {}, removeEventListener() {} };
    port.open = () =>
      new Promise((done, fail) => {
        socket = new WebSocket(window.__serialProxy);
        socket.binaryType = "arraybuffer";
        socket.onerror = () => fail(new DOMException("no such port", "NetworkError"));
        port.readable = new ReadableStream({
          start(control) {
            socket.onmessage = ({ data }) => control.enqueue(new Uint8Array(data));
            socket.onclose = () => {
              try {
                control.error(new DOMException("The device has been lost.", "NetworkError"));
              } catch {
                // the stream was cancelled before
              }
              port.readable = null;
            };
          },
          cancel() {
            socket.close();
          },
        });
        port.writable = new WritableStream({ write: (bytes) => socket.send(bytes) });
        socket.onopen = () => done();
      });
    port.close = async () => socket?.close();
    return port;
  };
  const serial = { requestPort: async () => makePort(), getPorts: async () => [], addEventListener() {}, removeEventListener() {} };
  Object.defineProperty(Navigator.prototype, "serial", { configurable: true, get: () => serial });
})();
