// The way to the server: one websocket that comes back by itself.

const SOONEST = 200;
const LATEST = 3000;
const SILENT = 10000; // a grab is answered sooner, or the other end sleeps or is out of reach

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
      this.hear();
      if (event.data instanceof ArrayBuffer) this.receive(event.data);
    };
    socket.onclose = () => this.retry();
  }

  hear() {
    clearTimeout(this.silence);
    this.silence = undefined;
  }

  retry() {
    this.hear();
    if (this.ended) return;
    this.tell(false);
    this.timer = setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(LATEST, 1.6 * this.wait);
  }

  /** Leave a way whose other end says nothing; a browser alone notices that after minutes. */
  leave() {
    this.socket.onopen = this.socket.onmessage = this.socket.onclose = null;
    this.socket.close();
    this.retry();
  }

  /** Say something; what is said while there is no way is lost, on purpose: it would be old. */
  send(message) {
    if (!this.connected) return;
    this.socket.send(JSON.stringify(message));
    if (message.kind === "grab") this.silence ??= setTimeout(() => this.leave(), SILENT);
  }

  close() {
    this.ended = true;
    clearTimeout(this.timer);
    this.hear();
    this.socket.close();
  }
}
