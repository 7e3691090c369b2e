// The buttons and keys that give orders.
import { OLD_MS, whyNoOrders, whyNoStop } from '../link/facts.js';
import { toolOrder } from '../link/tool_orders.js';
import { orderKeys, stopKeys } from '../hand/keys.js';
import { block, box, button, element, setData, setText, show } from './dom.js';

/** @typedef {import('../link/facts.js').Facts} Facts */
/** @typedef {import('../hand/engage.js').Engage} Engage */
/** @typedef {import('../link/wire.d.ts').Order} Order */
/** @typedef {import('../link/wire.d.ts').Tool['kind']} Kind */

/** @type {Record<string, string>} */
const ORDER_KEYS = { KeyE: 'engage', KeyD: 'disengage', KeyC: 'clutch', KeyR: 'reset', KeyG: 'grip', KeyW: 'record', KeyX: 'tool-off', KeyM: 'mark' };
/** @type {Record<string, Kind>} */
const TOOL_KEYS = { KeyL: 'LINE', KeyP: 'PLANE', KeyO: 'POINT', KeyN: 'N_ROTATION', KeyF: 'F_ROTATION' };

const all = () => /** @type {NodeListOf<HTMLButtonElement>} */ (document.querySelectorAll('[data-order], [data-tool], [data-named]'));

export class OrderPanel {
  /**
   * @param {Facts} facts @param {Engage} drive
   * @param {{stop: () => void, say: (text: string, mood?: string) => void}} parts
   */
  constructor(facts, drive, { stop, say }) {
    this.facts = facts;
    this.drive = drive;
    this.say = say;
    /** Whether the master's clutch was last ordered on. */
    this.clutched = false;
    this.clutchedAt = -Infinity;
    element('along', HTMLSelectElement).addEventListener('change', () => this.preferOneWay());
    button('stop').addEventListener('click', stop);
    stopKeys(stop);
    for (const node of all()) node.addEventListener('click', () => this.press(node));
    /** @type {Map<string, () => void>} */
    const keys = new Map();
    for (const [code, name] of Object.entries(ORDER_KEYS)) keys.set(code, () => this.byKey(`[data-order="${name}"]`));
    for (const [code, kind] of Object.entries(TOOL_KEYS)) keys.set(code, () => this.byKey(`[data-tool="${kind}"]`));
    for (let i = 1; i <= 9; ++i) keys.set(`Digit${i}`, () => this.byKey(`#named-tools button:nth-child(${i})`));
    /** The tools that the scene names, as they are shown. */
    this.namedTools = '';
    orderKeys(keys);
  }

  /** @param {string} selector */
  byKey(selector) {
    const node = document.querySelector(selector);
    if (!(node instanceof HTMLButtonElement)) return;
    if (node.hidden) this.say(node.dataset.without ?? 'that is not to be had here', 'bad');
    else if (node.disabled) this.say(node.title, 'bad');
    else this.press(node);
  }

  /** @param {HTMLButtonElement} node */
  async press(node) {
    const order = this.orderOf(node);
    if (!order) return;
    node.setAttribute('aria-busy', 'true');
    const { done } = await this.drive.give(order);
    node.removeAttribute('aria-busy');
    if (!done || order.clutch === undefined) return;
    this.clutched = order.clutch;
    this.clutchedAt = performance.now();
  }

  /** @param {HTMLButtonElement} node @returns {Order | null} */
  orderOf(node) {
    switch (node.dataset.order) {
      case 'engage': return { engage: true };
      case 'disengage': return { disengage: true };
      case 'reset': return { reset: true };
      case 'clutch': return { clutch: !this.clutched };
      case 'grip': return { grip: this.facts.status.gripper !== 'closed' };
      case 'record': return { record: { on: !this.facts.status.recording?.file } };
      case 'mark': return { mark: 'page' };
      case 'tool-off': return { tool_off: { position: true, orientation: true } };
      default:
    }
    const approach = element('approach', HTMLInputElement).checked;
    const { named } = node.dataset;
    if (named) {
      const turns = this.facts.status.named_tool?.find(({ name }) => name === named)?.kind?.endsWith('rotation');
      return { named_tool: named, ...(approach && !turns ? { approach } : {}) };
    }
    const kind = /** @type {Kind} */ (node.dataset.tool);
    const along = element('along', HTMLSelectElement).value;
    const made = toolOrder(this.facts, kind, along, element('one-way', HTMLInputElement).checked);
    if ('refused' in made) {
      this.say(made.refused, 'bad');
      return null;
    }
    return approach ? { ...made.order, approach } : made.order;
  }

  /** Directions that this scene offers. */
  setScene() {
    const select = element('along', HTMLSelectElement);
    const goals = (this.facts.scene.goal ?? []).map((_, i) => [`goal ${i}`, `to ${'ABCDEFGH'[i] ?? i + 1}`]);
    const axes = ['x', 'y', 'z'].flatMap((axis) => [[axis, `+${axis.toUpperCase()}`], [`-${axis}`, `−${axis.toUpperCase()}`]]);
    const options = [...axes, ['tip', 'tip’s axis'], ...goals];
    select.replaceChildren(...options.map(([value = '', text = '']) => new Option(`along ${text}`.replace('along to', 'to'), value)));
    select.value = goals.length > 1 ? 'goal 1' : '-y'; // the first goal is where one starts
    this.preferOneWay();
  }

  /** To a goal one way, along an axis both, until a person says otherwise. */
  preferOneWay() {
    element('one-way', HTMLInputElement).checked = element('along', HTMLSelectElement).value.startsWith('goal');
  }

  /** A button for each tool that the scene names; the first nine have a digit. */
  showNamedTools() {
    const tools = this.facts.status.named_tool ?? [];
    const names = JSON.stringify(tools);
    if (names === this.namedTools) return;
    this.namedTools = names;
    box('named-tools').replaceChildren(...tools.map(({ name = '', kind = '' }, i) => {
      const node = document.createElement('button');
      node.type = 'button';
      node.dataset.named = name;
      node.append(name);
      node.setAttribute('aria-label', `${name}, ${kind}`);
      if (i < 9) node.append(Object.assign(document.createElement('kbd'), { textContent: String(i + 1) }));
      node.addEventListener('click', () => this.press(node));
      return node;
    }));
    show(box('named-tools'), tools.length > 0);
  }

  update() {
    const { facts } = this;
    this.showNamedTools();
    const blocked = whyNoOrders(facts);
    const walls = facts.isWalls ? 'walls for the hand alone: no arm takes part' : '';
    for (const node of all()) block(node, blocked || (['reset', 'mark', 'record'].includes(node.dataset.order ?? '') ? '' : walls));
    block(button('stop'), whyNoStop(facts));
    setText(box('blocked'), blocked || walls ? sentence(blocked || walls) : '');
    this.seeClutch();
    document.querySelector('[data-order="clutch"]')?.setAttribute('aria-pressed', String(this.clutched));
    document.querySelector('[data-order="engage"]')?.classList.toggle('waits', this.drive.waits);
    document.querySelector('[data-order="engage"]')?.classList.toggle('primary', ['off', 'fault', undefined].includes(facts.status.state));
    this.markTools();
    show(box('tools-card'), !facts.isWalls);
    show(button('record'), !!facts.status.recording);
    setText(box('record-text'), facts.status.recording?.file ? 'End recording' : 'Record');
    button('record').setAttribute('aria-pressed', String(!!facts.status.recording?.file));
    button('record').title = facts.status.recording?.problem ?? facts.status.recording?.file ?? '';
    show(button('grip'), !facts.isWalls && !!facts.status.gripper);
    setText(box('grip-text'), facts.status.gripper === 'closed' ? 'Let go' : 'Grip');
    setData(document.documentElement, 'kind', facts.isWalls ? 'walls' : 'arm');
  }

  /** A hand that is not held looks clutched too; the way out of a clutch that was ordered is another. */
  seeClutch() {
    if (performance.now() - this.clutchedAt < OLD_MS) return; // the status may be from before
    const { state, ledger } = this.facts.status;
    if (ledger?.way_out_order?.some((order) => order.clutch === false)) this.clutched = true;
    else if (state !== 'clutched') this.clutched = false;
  }

  markTools() {
    const { position_tool: position, orientation_tool: orientation } = this.facts.status;
    const kinds = [position?.kind, orientation?.kind].filter((kind) => kind && kind !== 'none');
    for (const node of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll('[data-tool]'))) {
      const kind = (node.dataset.tool ?? '').toLowerCase().replace('_', '-');
      node.setAttribute('aria-pressed', String(kinds.includes(kind)));
    }
    const names = [position?.name, orientation?.name];
    for (const node of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll('[data-named]'))) {
      node.setAttribute('aria-pressed', String(names.includes(node.dataset.named)));
    }
    setText(box('tool-now'), kinds.join(' + ') || 'none');
  }
}

/** @param {string} text */
const sentence = (text) => (text[0]?.toUpperCase() ?? '') + text.slice(1) + '.';
