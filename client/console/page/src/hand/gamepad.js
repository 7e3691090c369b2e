// A gamepad: the right shoulder button is the dead-man, the sticks move the hand, B stops. It trembles
// for contact and for cues.
import { SPEED_MM_S } from './keys.js';

/** @typedef {import('../link/wire.d.ts').Status} Status */

const PERIOD_MS = 10;
const DEAD_ZONE = 0.12; // a stick at rest reads up to this
const HOLD = [5, 7], STOP = 1; // right bumper and trigger, and B, of the standard layout
const TREMBLE_MS = 120, TREMBLE_EVERY_MS = 100;
const FULL_TOUCH_N = 50; // the bumper's threshold trembles fully

/** @param {number | undefined} value */
const stick = (value = 0) => (Math.abs(value) < DEAD_ZONE ? 0 : value);

export class Pad {
  /**
   * @param {{cursor: import('./cursor.js').Cursor, deadMan: import('./dead_man.js').DeadMan,
   *   mayHold: () => boolean, stop: () => void, say: (text: string) => void}} parts
   */
  constructor(parts) {
    this.parts = parts;
    this.index = -1;
    this.timer = 0;
    this.stopped = false;
    this.pressed = false;
    this.last = 0;
    this.trembledAt = 0;
    window.addEventListener('gamepadconnected', (event) => this.plug(event.gamepad));
    window.addEventListener('gamepaddisconnected', (event) => this.unplug(event.gamepad));
  }

  /** @param {Gamepad} pad */
  plug(pad) {
    if (this.index >= 0) return;
    this.index = pad.index;
    this.last = performance.now();
    this.timer = window.setInterval(() => this.step(), PERIOD_MS);
    this.parts.say('gamepad: hold the right shoulder button to lead, sticks move, B stops');
  }

  /** @param {Gamepad} pad */
  unplug(pad) {
    if (pad.index === this.index) this.lose();
  }

  lose() {
    const { deadMan, say } = this.parts;
    window.clearInterval(this.timer);
    const moved = this.pressed;
    this.index = -1;
    this.pressed = false;
    deadMan.letGo('gamepad', 'the gamepad was unplugged');
    say(moved ? 'the gamepad was unplugged while it led: the hand was let go' : 'the gamepad was unplugged');
  }

  step() {
    const pad = navigator.getGamepads()[this.index];
    if (!pad?.connected) return this.lose();
    const { cursor, deadMan, mayHold, stop } = this.parts;
    const stopped = !!pad.buttons[STOP]?.pressed;
    if (stopped && !this.stopped) stop();
    this.stopped = stopped;
    const pressed = HOLD.some((i) => pad.buttons[i]?.pressed);
    if (pressed && !this.pressed && mayHold()) deadMan.hold('gamepad');
    if (!pressed && this.pressed) deadMan.letGo('gamepad');
    this.pressed = pressed;
    const now = performance.now(), way = (SPEED_MM_S * Math.min(50, now - this.last)) / 1000;
    this.last = now;
    if (!deadMan.holders.has('gamepad')) return;
    cursor.move([stick(pad.axes[0]) * way, -stick(pad.axes[1]) * way, stick(pad.axes[3]) * way]);
  }

  /** Trembles for what the newest status says. @param {Status} status */
  feel(status) {
    const pad = this.index >= 0 ? navigator.getGamepads()[this.index] : null;
    const actuator = pad?.vibrationActuator;
    const now = performance.now();
    if (!actuator || now - this.trembledAt < TREMBLE_EVERY_MS) return;
    const touch = status.has_contact_force ? Math.hypot(...(status.contact_force_n ?? [])) / FULL_TOUCH_N : 0;
    const most = status.haptic?.max_force_n ?? 3.3;
    const wall = status.walls?.touching ? (status.device_force?.magnitude_n ?? 0) / most : 0;
    const cue = (status.ledger?.cue?.magnitude_n ?? 0) > 0.01 ? 0.5 : 0;
    const strong = Math.min(1, Math.max(touch > 0.04 ? touch : 0, wall)), weak = Math.min(1, cue);
    if (strong + weak < 0.05) return;
    this.trembledAt = now;
    actuator.playEffect('dual-rumble', { duration: TREMBLE_MS, strongMagnitude: strong, weakMagnitude: weak }).catch(() => {});
  }
}
