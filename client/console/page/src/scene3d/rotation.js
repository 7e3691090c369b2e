// Rotation vectors.

/** @typedef {import('../link/wire.d.ts').Vec} Vec */

/** @param {Vec} q w x y z; empty: none @returns {Vec} [deg] */
export function rotationVector([w = 1, x = 0, y = 0, z = 0]) {
  const size = Math.hypot(x, y, z);
  if (size < 1e-9) return [0, 0, 0];
  const sign = w < 0 ? -1 : 1; // the shorter way round
  const deg = (2 * Math.atan2(size, sign * w) * 180) / Math.PI;
  return [x, y, z].map((value) => (sign * value * deg) / size);
}
