// Joint angles of the RV-2A from a tip pose: only to draw the arm where nobody says the joints, the
// ghost that shows where the hand wants it. Closed form, shoulder forward and elbow up as the arm works.

/** @typedef {import('../link/wire.d.ts').Vec} Vec */

/** Lengths of the chain [mm]: shoulder height, shoulder forward, upper arm, elbow offset, forearm, flange. */
export const LENGTHS = { d1: 350, a1: 100, a2: 250, a3: 130, d4: 250, flange: 85 };

/** Columns of the rotation. @param {Vec} q w x y z @returns {{x: Vec, y: Vec, z: Vec}} */
export function axes([w = 1, x = 0, y = 0, z = 0]) {
  return {
    x: [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    y: [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    z: [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  };
}

/** @param {number} a @param {number} seed @returns {number} a, by whole turns nearest to the seed */
const nearest = (a, seed) => a + 2 * Math.PI * Math.round((seed - a) / (2 * Math.PI));

/**
 * The place and turn of the point on the flange's axis that a tool is mounted at.
 * @param {Vec} p of the tip, S [mm] @param {Vec} q w x y z
 * @param {{position_mm?: Vec, quaternion?: Vec}} mount of the tip, from there
 * @returns {{p: Vec, q: Vec}}
 */
export function mountedAt(p, [w = 1, x = 0, y = 0, z = 0], { position_mm: m = [], quaternion: [a = 1, b = 0, c = 0, d = 0] = [] }) {
  // The tip's turn, and the mount's taken back.
  const turn = [w * a + x * b + y * c + z * d, x * a - w * b - y * d + z * c, y * a - w * c - z * b + x * d, z * a - w * d - x * c + y * b];
  const R = axes(turn);
  return { p: p.map((value, i) => value - (R.x[i] ?? 0) * (m[0] ?? 0) - (R.y[i] ?? 0) * (m[1] ?? 0) - (R.z[i] ?? 0) * (m[2] ?? 0)), q: turn };
}

/**
 * @param {Vec} p of the tip, S [mm]
 * @param {Vec} q w x y z
 * @param {number} tip from the wrist's centre to the tip [mm]
 * @param {Vec} seed joints [rad], to choose wrist and turns by
 * @returns {Vec | null} J1 to J6 [rad]; null: out of reach
 */
export function inverse(p, q, tip, seed) {
  const { a1, a2, a3, d1, d4 } = LENGTHS;
  const R = axes(q);
  const [cx = 0, cy = 0, cz = 0] = p.map((value, i) => value - tip * (R.z[i] ?? 0));
  const q1 = Math.atan2(cy, cx);
  const r = Math.hypot(cx, cy) - a1, h = cz - d1;
  const l = Math.hypot(a3, d4), lean = Math.atan2(a3, d4);
  const cosine = (r * r + h * h - a2 * a2 - l * l) / (2 * a2 * l);
  if (!(Math.abs(cosine) <= 1)) return null;
  const bend = Math.acos(cosine);
  const q2 = Math.atan2(r, h) - Math.atan2(l * Math.sin(bend), a2 + l * Math.cos(bend));
  const q3 = bend + lean;

  // What is left for the wrist: Ry(-(J2+J3)) Rz(-J1) R.
  const c1 = Math.cos(q1), s1 = Math.sin(q1), c = Math.cos(q2 + q3), s = Math.sin(q2 + q3);
  /** @param {Vec} v */
  const inForearm = ([x = 0, y = 0, z = 0]) => {
    const u = c1 * x + s1 * y, v = -s1 * x + c1 * y;
    return [c * u - s * z, v, s * u + c * z];
  };
  const [zx = 0, zy = 0, zz = 1] = inForearm(R.z);
  const [, , xz = 0] = inForearm(R.x), [, , yz = 0] = inForearm(R.y);
  const sine = Math.hypot(zx, zy);
  const flip = (seed[4] ?? 0) < 0 ? -1 : 1;
  const q5 = flip * Math.atan2(sine, zz);
  let q4 = seed[3] ?? 0, q6 = seed[5] ?? 0;
  if (sine > 1e-6) {
    q4 = nearest(Math.atan2(flip * zy, flip * zx), q4);
    q6 = nearest(Math.atan2(flip * yz, -flip * xz), q6);
  } else {
    const [xx = 1, xy = 0] = inForearm(R.x);
    q6 = nearest(zz > 0 ? Math.atan2(xy, xx) - q4 : Math.atan2(xy, -xx) + q4, q6);
  }
  return [q1, q2, q3, q4, q5, q6];
}

/**
 * @param {Vec} joints [rad]
 * @param {number} tip [mm]
 * @returns {Vec} the tip's place, S [mm]
 */
export function tipOf(joints, tip) {
  const { a1, a2, a3, d1, d4 } = LENGTHS;
  const [q1 = 0, q2 = 0, q3 = 0, q4 = 0, q5 = 0] = joints;
  const c = Math.cos(q2 + q3), s = Math.sin(q2 + q3);
  const radius = a1 + a2 * Math.sin(q2) - a3 * c + d4 * s;
  const height = d1 + a2 * Math.cos(q2) + a3 * s + d4 * c;
  const x = Math.sin(q5) * Math.cos(q4) * tip, y = Math.sin(q5) * Math.sin(q4) * tip, z = Math.cos(q5) * tip;
  const u = radius + c * x + s * z, w = height - s * x + c * z;
  return [Math.cos(q1) * u - Math.sin(q1) * y, Math.sin(q1) * u + Math.cos(q1) * y, w];
}
