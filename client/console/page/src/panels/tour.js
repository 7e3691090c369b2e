// What a first visitor is told: a card in the corner of the picture, never over the stop button.
import { box, button, setText, show } from './dom.js';
import { keep } from './theme.js';

const KEY = 'handrail.tour';

/** @type {[string, string][]} */
const STEPS = [
  ['Stop, always', 'The red button, Escape or Space stop the arm at once, whatever has the focus. It stays stopped until Reset, then Engage.'],
  ['Feel a wall with the mouse', 'In a scene of walls (gearshift), drag the lever. The ring is your cursor, the disc the lever: where a wall holds the lever back they part, and the arrow is the force you would feel.'],
  ['Lead the arm', 'In a scene with an arm (linear-movement): Engage, then drag the ring at the arm’s tip. It follows while you hold, and holds when you let go, hide the tab or lose the network. Elsewhere the mouse looks around.'],
  ['Call a tool', 'Line keeps the hand on a line, N-rotation keeps its orientation, and so on. Each has a key; the tool is drawn where it constrains, and the arm cannot leave it.'],
  ['Ask why', 'Below the picture one sentence says why the arm is not where the hand is, with the way out as a button. Data age says how old all you see is; red means do not trust it.'],
];

export class Tour {
  constructor() {
    this.step = 0;
    button('tour-open').addEventListener('click', () => this.open());
    button('tour-skip').addEventListener('click', () => this.close());
    button('tour-next').addEventListener('click', () => (this.step + 1 < STEPS.length ? this.go(this.step + 1) : this.close()));
    if (keep.get(KEY) !== 'seen') this.open();
  }

  open() {
    this.go(0);
    show(box('tour'), true);
  }

  close() {
    show(box('tour'), false);
    keep.set(KEY, 'seen');
  }

  /** @param {number} step */
  go(step) {
    this.step = step;
    const [title = '', text = ''] = STEPS[step] ?? [];
    setText(box('tour-step'), `${step + 1} of ${STEPS.length}`);
    setText(box('tour-title'), title);
    setText(box('tour-text'), text);
    setText(button('tour-next'), step + 1 < STEPS.length ? 'Next' : 'Done');
  }
}
