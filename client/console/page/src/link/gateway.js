// The WebSocket to the gateway: opens it, opens it again, and hands on what comes. Knows nothing of
// what the frames mean.

/** @typedef {import('./wire.d.ts').ToPage} ToPage */
/** @typedef {import('./wire.d.ts').FromPage} FromPage */
/** @typedef {keyof ToPage} Kind */

const SUBPROTOCOL = 'handrail.console.v1';
const FIRST_WAIT_MS = 250; // a gateway that is started anew is there within a second
const LONGEST_WAIT_MS = 4000; // short enough to watch a restart, long enough to cost nothing
const SILENCE_MS = 3000; // 180 statuses: a socket so silent is dead, whatever TCP believes

export class Gateway {
  /** @param {string} url of the WebSocket */
  constructor(url) {
    this.url = url;
    this.open = false;
    /** @type {number} when the next try comes, performance.now() [ms] */
    this.retryAt = 0;
    this.wait = FIRST_WAIT_MS;
    this.lastFrame = 0;
    /** What the gateway answers a page that it does not let in, as an HTTP status; 0: nothing. */
    this.refusal = 0;
    /** @type {WebSocket | null} */
    this.socket = null;
    /** @type {Map<string, ((value: any) => void)[]>} */
    this.listeners = new Map();
    setInterval(() => this.watch(), 500);
  }

  /**
   * Kinds: those of ToPage, and `open` and `closed`.
   * @param {Kind | 'open' | 'closed'} kind
   * @param {(value: any) => void} listener
   */
  on(kind, listener) {
    const all = this.listeners.get(kind) ?? [];
    all.push(listener);
    this.listeners.set(kind, all);
  }

  /** @param {string} kind @param {unknown} value */
  emit(kind, value) {
    for (const listener of this.listeners.get(kind) ?? []) listener(value);
  }

  connect() {
    this.retryAt = 0;
    const socket = new WebSocket(this.url, SUBPROTOCOL);
    this.socket = socket;
    this.lastFrame = performance.now();
    socket.onopen = () => {
      this.wait = FIRST_WAIT_MS;
      this.open = true;
      this.refusal = 0;
      this.emit('open', null);
    };
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => this.lost(socket, event.reason);
  }

  /** @param {unknown} data */
  receive(data) {
    this.lastFrame = performance.now();
    /** @type {Record<string, unknown>} */
    let frame;
    try {
      frame = JSON.parse(String(data));
    } catch {
      console.warn('gateway: a frame that is not JSON');
      return;
    }
    for (const kind of Object.keys(frame)) this.emit(kind, frame[kind]);
  }

  /** @param {WebSocket} socket @param {string} reason */
  lost(socket, reason) {
    if (socket !== this.socket) return;
    this.socket = null;
    const was = this.open;
    this.open = false;
    const wait = this.wait * (0.8 + 0.4 * Math.random()); // pages do not come back all at once
    this.retryAt = performance.now() + wait;
    this.wait = Math.min(2 * this.wait, LONGEST_WAIT_MS);
    setTimeout(() => this.connect(), wait);
    if (was) this.emit('closed', reason);
    else void this.askWhy();
  }

  /** A WebSocket does not say why it was refused; the page's own address does. */
  async askWhy() {
    try {
      const { status } = await fetch('/', { method: 'HEAD', cache: 'no-store' });
      if (!this.open) this.refusal = status;
    } catch {
      this.refusal = 0;
    }
  }

  /** Closes a socket that has been silent too long: then it is opened anew. */
  watch() {
    if (!this.socket || performance.now() - this.lastFrame < SILENCE_MS) return;
    const socket = this.socket;
    socket.close();
    this.lost(socket, 'nothing was heard for 3 s');
  }

  /**
   * @param {FromPage} frame
   * @returns {boolean} whether it was given to the socket
   */
  send(frame) {
    if (!this.open || !this.socket) return false;
    this.socket.send(JSON.stringify(frame));
    return true;
  }
}
