// The cursor: where a person wants the device's hand to be, told to the gateway while the dead-man is
// held, and the moment it is let go.

/** @typedef {import('../link/gateway.js').Gateway} Gateway */
/** @typedef {import('./dead_man.js').DeadMan} DeadMan */
/** @typedef {import('../link/wire.d.ts').Vec} Vec */

const PERIOD_MS = 10; // 100 a second: the gateway takes 60 to 125
const LEAST_MS = 8; // between two of these: a move that comes later than this after the last is told at once
const RETURN_FRAMES = 50; // the device is back within its two lags of 16 ms; the rest is patience

export class Cursor {
  /** @param {Gateway} gateway @param {DeadMan} deadMan */
  constructor(gateway, deadMan) {
    this.gateway = gateway;
    this.held = false;
    this.takenAt = 0;
    // Rises from page to page: a page sends fewer than a thousand a second.
    this.sequence = Date.now();
    /** Device frame M [mm]. @type {Vec} */
    this.position = [0, 0, 0];
    /** Rotation vector in M [deg]. @type {Vec} */
    this.rotation = [0, 0, 0];
    /** Half edges of the device's box about M's origin [mm]. @type {Vec} */
    this.half = [80, 60, 35];
    /** Where the device is; the cursor starts there. @type {() => Vec} */
    this.deviceAt = () => [0, 0, 0];
    /** Where and how turned, for a fresh start. @type {() => Vec} */
    this.deviceTurn = () => this.rotation;
    /** Whether a hand that was let go goes back to the middle, as the arm then holds. @type {() => boolean} */
    this.returns = () => false;
    this.timer = 0;
    this.sentAt = -Infinity;
    deadMan.onChange((held) => (held ? this.take() : this.letGo()));
  }

  /** Starts where the device is, so that nothing jumps. */
  take() {
    this.position = [...this.deviceAt()];
    this.rotation = [...this.deviceTurn()];
    this.held = true;
    this.takenAt = performance.now();
    window.clearInterval(this.timer);
    this.send();
    this.timer = window.setInterval(() => this.sendWhereDue(), PERIOD_MS);
  }

  /** Says so at once; then, where the hand returns, it has all of its work space again when it is taken anew. */
  letGo() {
    this.held = false;
    window.clearInterval(this.timer);
    this.send();
    if (!this.returns()) return;
    this.position = [0, 0, 0];
    let left = RETURN_FRAMES;
    this.timer = window.setInterval(() => {
      this.send();
      if (--left === 0) window.clearInterval(this.timer);
    }, PERIOD_MS);
  }

  /** For how long it has been held [ms]. */
  heldFor() {
    return this.held ? performance.now() - this.takenAt : 0;
  }

  /** Whether it cannot go further some way. */
  get atEdge() {
    return this.held && this.position.some((value, i) => Math.abs(value) >= (this.half[i] ?? 0) - 1e-6);
  }

  /** @param {Vec} by [mm], M */
  move(by) {
    this.moveTo(this.position.map((value, i) => value + (by[i] ?? 0)));
  }

  /** @param {Vec} to [mm], M; kept within the device's box */
  moveTo(to) {
    this.position = to.map((value, i) => {
      const most = this.half[i] ?? 0;
      return Math.max(-most, Math.min(most, value));
    });
    if (this.held) this.sendWhereDue();
  }

  /** @param {Vec} by rotation vector [deg], M; small */
  turn(by) {
    const sum = this.rotation.map((value, i) => value + (by[i] ?? 0));
    const size = Math.hypot(...sum);
    const most = 170; // below half a turn, where a rotation vector is no longer one
    this.rotation = size > most ? sum.map((value) => (value * most) / size) : sum;
  }

  sendWhereDue() {
    if (performance.now() - this.sentAt >= LEAST_MS) this.send();
  }

  send() {
    this.sentAt = performance.now();
    this.sequence += 1;
    this.gateway.send({
      hand: {
        sequence: this.sequence,
        position_mm: this.position,
        rotation_deg: this.rotation,
        held: this.held,
      },
    });
  }
}
