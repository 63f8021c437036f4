// The WebSocket: newest state in, input and commands out. It comes back by itself.
const kRetry_ms = 300;

export class Link {
  constructor(heard) {
    this.heard = heard;       // {state, mark, depths, words, hello, lease, refused, pong, open, closed}
    this.fields = [];
    this.stopWaits = false;   // a stop that was said while nobody could hear it
    this.state_ms = -Infinity;
    this.connect();
  }

  connect() {
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      if (this.stopWaits) this.command("stop");
      this.stopWaits = false;
      this.heard.open();
    };
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.words(JSON.parse(data)) : this.numbers(data));
    socket.onclose = () => {
      this.heard.closed();
      setTimeout(() => this.connect(), kRetry_ms);
    };
  }

  get open() { return this.socket.readyState === WebSocket.OPEN; }

  words(message) {
    if (message.type === "hello") this.fields = message.fields;
    this.heard[message.type]?.(message);
  }

  numbers(buffer) {
    const view = new DataView(buffer);
    const count = view.getUint16(2, true);
    if (view.getUint8(0) === 3) {
      this.heard.depths(new Float32Array(buffer, 8, count));
      return;
    }
    if (view.getUint8(0) === 2) {
      this.heard.mark(view.getUint32(4, true), new Float32Array(buffer, 8, 2 * count));
      return;
    }
    const state = { server_ms: view.getFloat64(8, true), echo_ms: view.getFloat64(16, true) };
    const numbers = new Float32Array(buffer, 24, count);
    this.fields.forEach((name, n) => { state[name] = numbers[n]; });
    this.state_ms = performance.now();
    this.heard.state(state);
  }

  command(what, more = {}) {
    if (!this.open) {
      if (what === "stop") this.stopWaits = true;
      return;
    }
    this.socket.send(JSON.stringify({ do: what, ...more }));
  }

  // One sample of the hand, 32 bytes; see page_protocol.h.
  frame(flags, sequence, page_ms, x_m, y_m, pressure, lease) {
    if (!this.open) return;
    const view = new DataView(new ArrayBuffer(32));
    view.setUint8(0, 1);
    view.setUint8(1, 1);
    view.setUint16(2, flags, true);
    view.setUint32(4, sequence, true);
    view.setFloat64(8, page_ms, true);
    view.setFloat32(16, x_m, true);
    view.setFloat32(20, y_m, true);
    view.setFloat32(24, pressure, true);
    view.setUint32(28, lease, true);
    this.socket.send(view.buffer);
  }
}
