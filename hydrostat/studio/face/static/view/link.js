// The way to the server: one websocket that comes back by itself.

const SOONEST = 200;
const LATEST = 3000;
const SILENT = 10000; // the server answers each grab sooner, unless it sleeps or is out of reach

export class Link {
  /**
   * @param {string} path of the websocket, such as "/stream"
   * @param {(buffer: ArrayBuffer) => void} receive is handed each message
   * @param {(connected: boolean) => void} onChange is called when the connection opens or closes
   */
  constructor(path, receive, onChange) {
    this.url = new URL(path, window.location.href);
    this.url.protocol = this.url.protocol === "https:" ? "wss:" : "ws:";
    this.receive = receive;
    this.onChange = onChange;
    this.wait = SOONEST;
    this.open();
  }

  get connected() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  open() {
    const socket = new WebSocket(this.url);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.wait = SOONEST;
      this.onChange(true);
    };
    socket.onmessage = (event) => {
      this.noteAnswer();
      if (event.data instanceof ArrayBuffer) this.receive(event.data);
    };
    socket.onclose = () => this.retry();
  }

  noteAnswer() {
    clearTimeout(this.silentTimer);
    this.silentTimer = undefined;
  }

  retry() {
    this.noteAnswer();
    if (this.ended) return;
    this.onChange(false);
    this.timer = setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(LATEST, 1.6 * this.wait);
  }

  /** Close a connection that sends no answer, and open it again; a browser alone notices after minutes. */
  reconnect() {
    this.socket.onopen = this.socket.onmessage = this.socket.onclose = null;
    this.socket.close();
    this.retry();
  }

  /** Say something; what is said while there is no way is lost, on purpose: it would be old. */
  send(message) {
    if (!this.connected) return;
    this.socket.send(JSON.stringify(message));
    if (message.kind === "grab") this.silentTimer ??= setTimeout(() => this.reconnect(), SILENT);
  }

  close() {
    this.ended = true;
    clearTimeout(this.timer);
    this.noteAnswer();
    this.socket.close();
  }
}
