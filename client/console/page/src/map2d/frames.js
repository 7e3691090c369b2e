// Between the walls' frame, the device's frame M and the picture.

/** @typedef {import('../link/wire.d.ts').Vec} Vec */
/** @typedef {import('../link/wire.d.ts').SceneMap} SceneMap */

/** How the walls lie in M. @typedef {{x: number, y: number, turn: number}} Lie */

/** @param {SceneMap} map @param {number} stage @returns {Lie} turn in radians */
export function lieOf(map, stage) {
  const now = map.stage?.[stage];
  return { x: now?.at_mm?.[0] ?? 0, y: now?.at_mm?.[1] ?? 0, turn: ((now?.turn_deg ?? 0) * Math.PI) / 180 };
}

/** From the walls' frame to M. @param {Lie} lie @param {Vec} p @returns {[number, number]} */
export function toDevice({ x, y, turn }, [a = 0, b = 0]) {
  const c = Math.cos(turn), s = Math.sin(turn);
  return [x + c * a - s * b, y + s * a + c * b];
}

/** A direction, likewise. @param {Lie} lie @param {Vec} v @returns {[number, number]} */
export function wayToDevice({ turn }, v) {
  return toDevice({ x: 0, y: 0, turn }, v);
}

/**
 * What part of M is shown: all of the map, in the middle of the canvas.
 * @param {Lie} lie @param {Vec} size of the map [mm] @param {number} width @param {number} height [px]
 * @returns {{scale: number, px: (p: Vec) => [number, number], mm: (x: number, y: number) => [number, number]}}
 */
export function window2d(lie, [w = 100, h = 100], width, height) {
  const c = Math.abs(Math.cos(lie.turn)), s = Math.abs(Math.sin(lie.turn));
  const scale = 0.92 * Math.min(width / (c * w + s * h), height / (s * w + c * h));
  return {
    scale,
    px: ([x = 0, y = 0]) => [width / 2 + scale * (x - lie.x), height / 2 - scale * (y - lie.y)],
    mm: (x, y) => [lie.x + (x - width / 2) / scale, lie.y - (y - height / 2) / scale],
  };
}
