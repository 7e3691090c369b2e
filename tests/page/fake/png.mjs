// A picture of the gearshift's walls, as a PNG without a library.
import { deflateSync } from 'node:zlib';

const SIZE_MM = 120, PIXELS = 480;
export const WALL = [43, 54, 62], GATE = [48, 160, 80];

/** Whether a place [mm] is in the gate: one aisle across, three along, round ends. */
export function free(x, y) {
  const aisle = (cx, cy, w, h) => Math.abs(x - cx) <= w / 2 && Math.abs(y - cy) <= h / 2;
  if (aisle(0, 0, 94, 14)) return true;
  return [-40, 0, 40].some((cx) => aisle(cx, 0, 14, 90) || Math.hypot(x - cx, Math.abs(y) - 45) <= 7);
}

/** The nearest free place, for a proxy that never enters a wall. */
export function nearestFree(x, y) {
  if (free(x, y)) return [x, y];
  let best = [0, 0], least = Infinity;
  const consider = (px, py) => {
    const far = Math.hypot(px - x, py - y);
    if (far < least) [best, least] = [[px, py], far];
  };
  const clamp = (value, most) => Math.max(-most, Math.min(most, value));
  consider(clamp(x, 47), clamp(y, 7));
  for (const cx of [-40, 0, 40]) {
    consider(cx + clamp(x - cx, 7), clamp(y, 45));
    const cy = y < 0 ? -45 : 45, far = Math.hypot(x - cx, y - cy) || 1;
    consider(cx + ((x - cx) * Math.min(7, far)) / far, cy + ((y - cy) * Math.min(7, far)) / far);
  }
  return best;
}

function crc(bytes) {
  let c = ~0;
  for (const byte of bytes) {
    c ^= byte;
    for (let k = 0; k < 8; ++k) c = c & 1 ? (c >>> 1) ^ 0xedb88320 : c >>> 1;
  }
  return ~c >>> 0;
}

function chunk(name, body) {
  const typed = Buffer.concat([Buffer.from(name), body]);
  const out = Buffer.alloc(8);
  out.writeUInt32BE(body.length, 0);
  out.writeUInt32BE(crc(typed), 4);
  return Buffer.concat([out.subarray(0, 4), typed, out.subarray(4)]);
}

/** The picture; or one in which `isFree` says what is free. */
export function gearshiftPng(isFree = free) {
  const rows = Buffer.alloc(PIXELS * (1 + 3 * PIXELS));
  for (let row = 0, at = 0; row < PIXELS; ++row) {
    rows[at++] = 0;
    for (let column = 0; column < PIXELS; ++column) {
      const x = ((column + 0.5) / PIXELS - 0.5) * SIZE_MM, y = (0.5 - (row + 0.5) / PIXELS) * SIZE_MM;
      for (const value of isFree(x, y) ? GATE : WALL) rows[at++] = value;
    }
  }
  const head = Buffer.alloc(13);
  head.writeUInt32BE(PIXELS, 0);
  head.writeUInt32BE(PIXELS, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const magic = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([magic, chunk('IHDR', head), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}

export const gearshiftMap = {
  picture: '/scene/map.png',
  size_mm: [SIZE_MM, SIZE_MM],
  region: [
    { name: 'gate', kind: 'aisle', colour: '#30a050' },
    { name: 'wall', kind: 'wall', colour: '#2b363e' },
  ],
  stage: [{ at_mm: [0, 0], turn_deg: 0 }],
  place: [['1', -40, 47], ['2', -40, -47], ['3', 0, 47], ['4', 0, -47], ['5', 40, 47], ['R', 40, -47]].map(
    ([name, x, y]) => ({ name, at_mm: [x, y], radius_mm: 8 })),
};
