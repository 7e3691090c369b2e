// The line under the bar that says what is missing, and the line that says what became of an order.
import { block, box, button, setText, show } from './dom.js';

const SAID_MS = 8000; // long enough to read two lines

/** @type {Record<string, string>} */
const WORDS = {
  engage: 'engage', disengage: 'disengage', clutch: 'clutch', stop: 'stop', reset: 'reset', tool: 'tool',
  tool_off: 'tool off', scene_load: 'scene', stage: 'stage', mark: 'mark', grip: 'gripper', record: 'recording', lease: 'lease',
};

export class Said {
  constructor() {
    this.timer = 0;
  }

  /** @param {string} text @param {string} [mood] `good`, `bad` or nothing */
  say(text, mood = 'plain') {
    const node = box('said');
    setText(node, text);
    node.dataset.mood = mood;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => setText(node, ''), SAID_MS);
  }

  /** @param {import('../link/wire.d.ts').Order} order @param {import('../link/wire.d.ts').Outcome} outcome */
  outcome(order, { done, reason }) {
    const name = Object.keys(order).find((key) => WORDS[key]) ?? '';
    const word = WORDS[name] ?? 'order';
    this.say(done ? `${word}: ${reason || 'done'}` : `${word} refused: ${reason || 'no reason was given'}`, done ? 'good' : 'bad');
  }
}

/**
 * @param {string} text empty: no notice
 * @param {{text: string, press: () => void, blocked: string} | null} way a button beside it
 */
export function notice(text, way) {
  show(box('notice'), text !== '');
  setText(box('notice-text'), text);
  show(button('notice-button'), !!way);
  if (!way) return;
  setText(button('notice-button'), way.text);
  block(button('notice-button'), way.blocked);
  button('notice-button').onclick = way.press;
}
