// Tools as a person calls them, by a key and a direction, to tools as the master takes them.

/** @typedef {import('./wire.d.ts').Order} Order */
/** @typedef {import('./wire.d.ts').Vec} Vec */
/** @typedef {import('./facts.js').Facts} Facts */

/** Directions that a person can choose; frame S. @type {Record<string, Vec>} */
const AXES = { x: [1, 0, 0], '-x': [-1, 0, 0], y: [0, 1, 0], '-y': [0, -1, 0], z: [0, 0, 1], '-z': [0, 0, -1] };

/**
 * Turns a vector by a quaternion.
 * @param {Vec} q w x y z @param {Vec} v @returns {Vec}
 */
export function turned([w = 1, x = 0, y = 0, z = 0], [a = 0, b = 0, c = 0]) {
  const tx = 2 * (y * c - z * b), ty = 2 * (z * a - x * c), tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}

/**
 * @param {Facts} facts
 * @param {string} along `x` to `-z`, `tip`, or `goal 0` and so on
 * @returns {{direction: Vec, end?: Vec} | null} null: there is no such direction now
 */
function chosen(facts, along) {
  const axis = AXES[along];
  if (axis) return { direction: axis };
  const tip = facts.status.command ?? facts.status.tip;
  if (along === 'tip') return { direction: turned(tip?.quaternion ?? [], [0, 0, 1]) };
  const goal = facts.scene.goal?.[Number(along.replace('goal ', ''))]?.position_mm;
  const from = tip?.position_mm;
  if (!goal || !from) return null;
  const way = goal.map((value, i) => value - (from[i] ?? 0));
  return Math.hypot(...way) < 0.1 ? null : { direction: way, end: goal };
}

/**
 * The order that calls a tool at the tip.
 * @param {Facts} facts
 * @param {import('./wire.d.ts').Tool['kind']} kind
 * @param {string} along of a line and its end; of a plane the normal
 * @param {boolean} oneWay of a line
 * @returns {{order: Order} | {refused: string}}
 */
export function toolOrder(facts, kind, along, oneWay) {
  if (kind === 'POINT' || kind === 'N_ROTATION' || kind === 'F_ROTATION') return { order: { tool: { kind } } };
  // A plane toward a goal would stand across the way: it lies flat.
  const found = chosen(facts, kind === 'PLANE' && along.startsWith('goal') ? 'z' : along);
  if (!found) return { refused: 'no way to go: the tip is there already, or nobody says where it is' };
  if (kind === 'PLANE') return { order: { tool: { kind, normal: found.direction } } };
  const line = { kind, direction: found.direction, one_way: oneWay };
  return { order: { tool: found.end ? { ...line, end_mm: found.end } : line } };
}
