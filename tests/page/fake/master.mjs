// What a master would say, made up from statuses that real ones gave: enough for the page to be looked
// at and tested without one. Nothing here is physics.
import { readFileSync } from 'node:fs';
import { gearshiftMap, nearestFree } from './png.mjs';

const data = (name) => JSON.parse(readFileSync(new URL(`../data/${name}`, import.meta.url), 'utf8'));
const STIFFNESS_N_MM = 5; // of the gearshift's walls
const LAG = 0.12; // share of the way to the hand that the arm goes in a status

const ARM_SCENE = {
  name: 'linear-movement', kind: 'ARM', scale: 2, number: '1',
  description: 'Free hand, 1:2 mapping, published smoother. Call line, point and n-rotation tools as the task goes on.',
  rotation: [0, 0, -1, -1, 0, 0, 0, 1, 0], arm: { tip_mm: 301 },
  body: [{ kind: 'SOCKET', pose: { position_mm: [350, 0, 260], quaternion: [1, 0, 0, 0] }, size_mm: [6.05, 5] }],
  goal: [[350, 37.5, 329], [350, -37.5, 329], [350, -37.5, 254]].map((position_mm) => ({ position_mm, quaternion: [0, 0, 1, 0] })),
};
const WALLS_SCENE = {
  name: 'gearshift', kind: 'WALLS', number: '2', map: gearshiftMap,
  description: 'Five gears and reverse, each with a lock; out of gear the lever returns to neutral.',
};

export class FakeMaster {
  constructor(scene = 'linear-movement') {
    this.load(scene);
    this.cursor = { held: false, position_mm: [0, 0, 0] };
    this.from = null;
    this.tip = [350, 0, 329];
  }

  load(name) {
    this.walls = name === 'gearshift' || name === 'unknown-map';
    this.scene = name === 'gearshift' ? WALLS_SCENE : name === 'linear-movement' ? ARM_SCENE
      : { name, problem: `no drawing of '${name}' is known`, number: name };
    this.status = structuredClone(data(this.walls ? 'status_gear.json' : 'status_line.json'));
    Object.assign(this.status, { scene: name, state: 'off', desired: 'off', lease: {}, device: 'page' });
    if (!this.walls) for (const tool of ['position_tool', 'orientation_tool']) this.status[tool] = { kind: 'none' };
    this.status.named_tool = this.walls ? [] : [{ name: 'upright', kind: 'n-rotation' }, { name: 'to <b>', kind: 'line' }];
  }

  /** @returns {string} why not; empty: done */
  order(order) {
    const { status } = this;
    if (order.stop) Object.assign(status, { state: 'fault', desired: 'off', reason: 'a stop was requested' });
    else if (order.engage && status.state === 'fault') return 'a stop was requested: reset first';
    else if (order.engage) Object.assign(status, { state: 'engaged', desired: 'engaged', reason: 'none' });
    else if (order.record) status.recording = order.record.on ? { folder: '/r', file: '/r/one.mcap', mb: 1 } : { folder: '/r' };
    else if (order.grip !== undefined) status.gripper = order.grip ? 'closed' : 'open';
    else if (order.disengage || order.reset) Object.assign(status, { state: 'off', desired: 'off', reason: 'not engaged' });
    else if ('clutch' in order) status.state = status.desired = order.clutch ? 'clutched' : 'engaged';
    else if (order.tool) this.call(order.tool);
    else if (order.named_tool) return this.callNamed(order.named_tool);
    else if (order.tool_off) status.position_tool = status.orientation_tool = { kind: 'none' };
    else if (order.scene_load) this.load(order.scene_load);
    return '';
  }

  callNamed(name) {
    const tool = this.status.named_tool.find((each) => each.name === name);
    if (!tool) return `the scene names no tool '${name}'`;
    this.call({ kind: tool.kind, direction: [0, 1, 0], normal: [0, 0, 1] });
    this.status[tool.kind.includes('rotation') ? 'orientation_tool' : 'position_tool'].name = name;
    return '';
  }

  call(tool) {
    const kind = tool.kind.toLowerCase().replace('_', '-');
    const geometry = { anchor_mm: this.tip, direction: unit(tool.direction), normal: unit(tool.normal), end_mm: tool.end_mm, one_way: tool.one_way, axis: [0, 0, -1], quaternion: [0, 0, 1, 0] };
    this.status[kind.includes('rotation') ? 'orientation_tool' : 'position_tool'] = { kind, geometry, deviation_deg: 4 };
  }

  move(cursor) {
    if (cursor.held && !this.cursor.held) this.from = { cursor: cursor.position_mm, tip: this.tip };
    this.cursor = cursor;
  }

  /** The next status. */
  next() {
    const { status, cursor } = this;
    status.haptic = { workspace_half_mm: this.walls ? [60, 60, 1] : [80, 60, 35], max_force_n: this.walls ? 20 : 3.3, cursor: { ...cursor, sequence: String(cursor.sequence ?? 0), age_ms: 5 } };
    if (this.walls) this.lever();
    else this.arm();
    return status;
  }

  lever() {
    const { status, cursor } = this;
    const [x, y] = cursor.held ? cursor.position_mm : status.hand.position_mm;
    const [px, py] = nearestFree(x, y);
    const into = Math.hypot(x - px, y - py), hand = [px + (x - px) * 0.12, py + (y - py) * 0.12, 0];
    const force = cursor.held ? [(px - hand[0]) * STIFFNESS_N_MM, (py - hand[1]) * STIFFNESS_N_MM, 0] : [0, 0, 0];
    const place = gearshiftMap.place.find(({ at_mm: [a, b] }) => Math.hypot(a - px, b - py) < 4)?.name ?? '';
    status.hand.position_mm = hand;
    Object.assign(status.walls, { touching: into > 0.01, penetration_mm: 0.12 * into, proxy_mm: [px, py], hand_mm: hand, force_n: force, place, locked: !!place });
    status.device_force = { magnitude_n: Math.hypot(...force), force_n: force };
  }

  arm() {
    const { status, cursor, from } = this;
    const leads = cursor.held && status.state === 'engaged' && from;
    const [right = 0, up = 0, back = 0] = leads ? cursor.position_mm.map((value, i) => value - from.cursor[i]) : [];
    const wanted = leads ? [from.tip[0] - 2 * back, from.tip[1] - 2 * right, from.tip[2] + 2 * up] : this.tip;
    this.tip = this.tip.map((value, i) => value + LAG * (wanted[i] - value));
    const behind = Math.hypot(...wanted.map((value, i) => value - this.tip[i]));
    if (leads) status.hand.position_mm = cursor.position_mm;
    status.desired_tip = { position_mm: wanted, quaternion: [0, 0, 1, 0] };
    for (const name of ['tip', 'command', 'slave_command']) status[name] = { position_mm: this.tip, quaternion: [0, 0, 1, 0] };
    status.ledger.behind_mm = behind;
    const off = status.state === 'off', fault = status.state === 'fault';
    status.ledger.sentence = off ? 'the arm holds: not engaged' : fault ? 'the arm holds: a stop was requested'
      : `the arm is ${behind.toFixed(1)} mm from the hand: ${behind.toFixed(1)} mm smoothing`;
    status.ledger.way_out = off ? 'engage' : fault ? 'reset, then engage' : '';
    status.ledger.way_out_order = status.state === 'clutched' ? [{ clutch: false }] : off ? [{ engage: true }] : fault ? [{ reset: true }, { engage: true }] : [];
    const pull = wanted.map((value, i) => 0.02 * (this.tip[i] - value));
    status.spring_force = { magnitude_n: Math.hypot(...pull), force_n: [-pull[1], pull[2], -pull[0]] };
    status.tool_force = status.position_tool.geometry && leads ? { magnitude_n: 0.9, force_n: [0, 0.8, 0.4] } : { magnitude_n: 0, force_n: [0, 0, 0] };
    status.device_force = { magnitude_n: status.spring_force.magnitude_n + status.tool_force.magnitude_n };
    status.contact_force_n = this.tip[2] < 300 ? [0, 4, (300 - this.tip[2]) * 2] : [0, 0, 0];
    status.has_contact_force = true;
  }
}

function unit(v) {
  if (!v) return undefined;
  const size = Math.hypot(...v);
  return v.map((value) => value / size);
}
