// The bar of a recording's time: plays, pauses, goes elsewhere, by mouse and by keys. All pages and
// viewers of a gateway look at the same moment.
import { box, button, element, setData, setText, show } from './dom.js';

/** @typedef {import('../link/facts.js').Facts} Facts */
/** @typedef {import('../link/orders.js').Orders} Orders */
/** @typedef {import('../link/wire.d.ts').PlayOrder} PlayOrder */
/** @typedef {import('../link/wire.d.ts').RecordingMark} RecordingMark */

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];
const STRIDE_S = 5; // of an arrow key
const SMALL_S = 0.1; // of comma and period: what a person tells apart in a picture
const LEAVES_PX = 5; // half of a mark's width
const AIM_MS = 500; // in which an order is seen in a status, on a busy computer too
const AT_MARK_S = 0.3; // of a mark that was passed so shortly ago one is at it
/** @type {Record<string, string>} */
const KINDS = { MARK: 'mark', STOP: 'stop', FAULT: 'fault', GAP: 'gap' };

/** 1:02.500, or 1:00:02.500. @param {number} seconds */
export function timeText(seconds) {
  const ms = Math.max(0, Math.round(seconds * 1000));
  const [hours, minutes] = [Math.floor(ms / 3600000), Math.floor(ms / 60000) % 60];
  const rest = ((ms % 60000) / 1000).toFixed(3).padStart(6, '0');
  return hours > 0 ? `${hours}:${String(minutes).padStart(2, '0')}:${rest}` : `${minutes}:${rest}`;
}

/** The mark after that time, or before it. @param {RecordingMark[]} marks @param {number} at @param {1 | -1} way */
export function markBeside(marks, at, way) {
  const times = marks.map((mark) => mark.at_s ?? 0);
  return way > 0 ? times.find((time) => time > at + 1e-3) : times.reverse().find((time) => time < at - AT_MARK_S);
}

/** @param {RecordingMark} mark */
const markText = ({ at_s = 0, kind = 'MARK', text = '', who = '' }) =>
  `${timeText(at_s)} ${KINDS[kind] ?? 'mark'}: ${text || '–'}${who ? ` (${who})` : ''}`;

/** Whether keys belong to what has the focus. @param {EventTarget | null} target */
const hasKeys = (target) => target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && target.type === 'text');

export class PlayBar {
  /** @param {Facts} facts @param {Orders} orders @param {(text: string, mood?: string) => void} say */
  constructor(facts, orders, say) {
    this.facts = facts;
    this.orders = orders;
    this.say = say;
    /** The recording that is on the bar. @type {import('../link/wire.d.ts').RecordingNews | null} */
    this.drawn = null;
    /** Where the knob is dragged to [s]; null: it is not. @type {number | null} */
    this.dragged = null;
    /** What waits for the answer before. @type {PlayOrder | null} */
    this.waits = null;
    this.asking = false;
    /** What was asked for and is not seen yet: a second key goes on from there. @type {PlayOrder} */
    this.aim = {};
    this.aimUntil = 0;
    this.speed = element('play-speed', HTMLSelectElement);
    this.speed.replaceChildren(...SPEEDS.map((speed) => new Option(`${speed}×`, String(speed))));
    this.speed.addEventListener('change', () => {
      void this.order({ speed: Number(this.speed.value) });
      this.speed.blur();
    });
    button('play-toggle').addEventListener('click', () => this.toggle());
    button('play-before').addEventListener('click', () => this.toMark(-1));
    button('play-next').addEventListener('click', () => this.toMark(1));
    this.setUpBar();
    this.setUpKeys();
  }

  get length() {
    return this.facts.recording?.length_s ?? 0;
  }

  get position() {
    return this.dragged ?? this.aim.position_s ?? this.facts.play.position_s ?? 0;
  }

  /** One order at a time is under way; of those that come meanwhile the newest of each kind counts. @param {PlayOrder} order */
  async order(order) {
    this.aim = { ...this.aim, ...order };
    this.aimUntil = performance.now() + AIM_MS;
    if (this.asking) {
      this.waits = { ...this.waits, ...order };
      return;
    }
    this.asking = true;
    for (let next = /** @type {PlayOrder | null} */ (order); next; ) {
      const { done, reason } = await this.orders.play(next);
      if (!done) this.say(reason, 'bad');
      next = this.waits;
      this.waits = null;
    }
    this.asking = false;
  }

  toggle() {
    void this.order({ playing: this.facts.play.state !== 'PLAYING' });
  }

  /** @param {number} at [s] */
  goTo(at) {
    void this.order({ position_s: Math.min(Math.max(at, 0), this.length) });
  }

  /** @param {1 | -1} way */
  toMark(way) {
    const at = markBeside(this.facts.recording?.mark ?? [], this.position, way);
    if (at === undefined) this.say(way > 0 ? 'there is no mark after this' : 'there is no mark before this');
    else this.goTo(at);
  }

  /** @param {1 | -1} way */
  changeSpeed(way) {
    const now = this.aim.speed ?? this.facts.play.speed ?? 1;
    const next = way > 0 ? SPEEDS.find((speed) => speed > now) : [...SPEEDS].reverse().find((speed) => speed < now);
    if (next !== undefined) void this.order({ speed: next });
  }

  setUpBar() {
    const bar = box('play-bar');
    /** @param {PointerEvent} event */
    const seek = (event) => {
      const { left, width } = bar.getBoundingClientRect();
      this.dragged = Math.min(Math.max((event.clientX - left) / Math.max(width, 1), 0), 1) * this.length;
      this.goTo(this.dragged);
      this.update();
    };
    /** Where it was pressed; on a mark that is met exactly, until the pointer leaves it. @type {{x: number, mark: boolean} | null} */
    let pressed = null;
    bar.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      const mark = event.target instanceof HTMLElement ? event.target.dataset.at : undefined;
      pressed = { x: event.clientX, mark: mark !== undefined };
      bar.setPointerCapture(event.pointerId);
      if (mark === undefined) seek(event);
      else this.goTo(Number(mark));
    });
    bar.addEventListener('pointermove', (event) => {
      if (!pressed || (pressed.mark && Math.abs(event.clientX - pressed.x) < LEAVES_PX)) return;
      pressed.mark = false;
      seek(event);
    });
    for (const end of /** @type {const} */ (['pointerup', 'pointercancel'])) {
      bar.addEventListener(end, () => {
        pressed = null;
        this.dragged = null;
      });
    }
  }

  setUpKeys() {
    /** @type {Record<string, () => void>} */
    const keys = {
      KeyK: () => this.toggle(),
      ArrowLeft: () => this.goTo(this.position - STRIDE_S),
      ArrowRight: () => this.goTo(this.position + STRIDE_S),
      Comma: () => this.goTo(this.position - SMALL_S),
      Period: () => this.goTo(this.position + SMALL_S),
      Home: () => this.goTo(0),
      End: () => this.goTo(this.length),
      BracketLeft: () => this.toMark(-1),
      BracketRight: () => this.toMark(1),
      Minus: () => this.changeSpeed(-1),
      Equal: () => this.changeSpeed(1),
    };
    window.addEventListener('keydown', (event) => {
      if (!this.facts.recording || event.ctrlKey || event.altKey || event.metaKey || hasKeys(event.target)) return;
      const act = keys[event.code];
      if (!act || (event.repeat && event.code === 'KeyK')) return;
      event.preventDefault();
      act();
    });
  }

  /** What is the same as long as the recording is. */
  draw() {
    const { recording } = this.facts;
    if (recording === this.drawn) return;
    this.drawn = recording;
    show(box('play'), !!recording);
    show(box('recording-sign'), !!recording);
    setData(document.documentElement, 'recording', String(!!recording));
    setText(box('key-ring'), recording ? 'hand' : 'your cursor');
    const file = recording?.file ?? '';
    const name = file.slice(file.lastIndexOf('/') + 1);
    document.title = recording ? `Recording ${name} – Handrail` : 'Handrail';
    if (!recording) return;
    show(box('tour'), false); // it tells of orders
    const begun = new Date((recording.begins_s ?? 0) * 1000);
    setText(box('play-file'), name);
    box('play-file').title = `${file}: ${recording.program} ${recording.version}, begun ${begun.toLocaleString('en-GB')}`;
    setText(box('play-length'), timeText(this.length));
    box('play-bar').setAttribute('aria-valuemax', this.length.toFixed(3));
    box('play-marks').replaceChildren(...(recording.mark ?? []).map((mark) => {
      const node = document.createElement('span');
      node.className = 'play-mark';
      node.dataset.kind = mark.kind ?? 'MARK';
      node.dataset.at = String(mark.at_s ?? 0);
      node.title = markText(mark);
      node.style.left = `${(100 * (mark.at_s ?? 0)) / Math.max(this.length, 1e-9)}%`;
      return node;
    }));
    if (recording.marks_left_out) this.say(`this recording has more marks than can be shown: ${recording.marks_left_out} are left out`);
  }

  /** Whether the player stands where it was sent; or it takes too long to wait for. */
  seeAim() {
    if (this.asking && performance.now() < this.aimUntil) return;
    const { state, position_s: at = 0, speed = 1 } = this.facts.play;
    const { playing, position_s: to = at, speed: wanted = speed } = this.aim;
    const there = Math.abs(at - to) < (playing ?? state === 'PLAYING' ? AIM_MS / 1000 : 1e-3) && Math.abs(speed - wanted) < 1e-6;
    if (there || performance.now() > this.aimUntil) this.aim = {};
  }

  update() {
    this.draw();
    if (!this.facts.recording) return;
    this.seeAim();
    const { state = 'PAUSED', speed = 1 } = this.facts.play;
    const at = this.position, part = `${(100 * at) / Math.max(this.length, 1e-9)}%`;
    setText(box('play-word'), state === 'PLAYING' ? 'Pause' : state === 'ENDED' ? 'Again' : 'Play');
    setText(box('play-now'), timeText(at));
    box('play-done').style.width = part;
    box('play-knob').style.left = part;
    box('play-bar').setAttribute('aria-valuenow', at.toFixed(3));
    box('play-bar').setAttribute('aria-valuetext', `${timeText(at)} of ${timeText(this.length)}`);
    if (document.activeElement !== this.speed) this.speed.value = String(SPEEDS.find((each) => Math.abs(each - speed) < 1e-6) ?? '');
  }
}
