// The way to the server: one websocket that comes back by itself.

const SOONEST = 200;
const LATEST = 3000;

export class Link {
  /**
   * @param {string} path of the websocket, such as "/stream"
   * @param {(buffer: ArrayBuffer) => void} receive is handed each message
   * @param {(connected: boolean) => void} tell is told when the way opens or closes
   */
  constructor(path, receive, tell) {
    this.url = new URL(path, window.location.href);
    this.url.protocol = this.url.protocol === "https:" ? "wss:" : "ws:";
    this.receive = receive;
    this.tell = tell;
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
      this.tell(true);
    };
    socket.onmessage = (event) => {
      if (event.data instanceof ArrayBuffer) this.receive(event.data);
    };
    socket.onclose = () => {
      if (this.ended) return;
      this.tell(false);
      this.timer = setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(LATEST, 1.6 * this.wait);
    };
  }

  /** Say something; what is said while there is no way is lost, on purpose: it would be old. */
  send(message) {
    if (this.connected) this.socket.send(JSON.stringify(message));
  }

  close() {
    this.ended = true;
    clearTimeout(this.timer);
    this.socket.close();
  }
}
