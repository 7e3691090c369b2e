// A painted map in the page's own colours: each pixel by the regions whose colours it is mixed of.

/** @typedef {import('../link/wire.d.ts').SceneMap} SceneMap */
/** @typedef {[number, number, number]} Rgb */

/** @param {string} text `#rrggbb` @returns {Rgb | null} */
export function rgb(text) {
  const found = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(text.trim());
  return found ? [parseInt(found[1] ?? '', 16), parseInt(found[2] ?? '', 16), parseInt(found[3] ?? '', 16)] : null;
}

/** @param {Rgb} a @param {ArrayLike<number>} b @param {number} at */
const distance = (a, b, at) => Math.hypot(a[0] - (b[at] ?? 0), a[1] - (b[at + 1] ?? 0), a[2] - (b[at + 2] ?? 0));

/**
 * @param {SceneMap} map
 * @param {string[]} without wall regions that are not there in this stage
 * @param {(kind: string) => Rgb} paint the page's colour of a kind of region
 * @returns {{from: Rgb, to: Rgb}[]}
 */
export function palette(map, without, paint) {
  return (map.region ?? []).flatMap((region) => {
    const from = rgb(region.colour ?? '');
    const gone = without.includes(region.name ?? '');
    return from ? [{ from, to: paint(gone ? 'free' : region.kind ?? 'wall') }] : [];
  });
}

/**
 * Changes pixels in place. One that an edge crosses lies between two colours, and stays as far between.
 * @param {Uint8ClampedArray} data RGBA
 * @param {{from: Rgb, to: Rgb}[]} colours
 */
export function recolour(data, colours) {
  if (colours.length === 0) return;
  /** What was found for a colour before: a map has few. @type {Map<number, Rgb>} */
  const known = new Map();
  for (let at = 0; at < data.length; at += 4) {
    const key = ((data[at] ?? 0) << 16) | ((data[at + 1] ?? 0) << 8) | (data[at + 2] ?? 0);
    let to = known.get(key);
    if (!to) {
      to = mixed(data, at, colours);
      known.set(key, to);
    }
    data[at] = to[0];
    data[at + 1] = to[1];
    data[at + 2] = to[2];
  }
}

/**
 * Of all pairs the one whose line passes nearest: an edge mixes two colours.
 * @param {Uint8ClampedArray} data @param {number} at @param {{from: Rgb, to: Rgb}[]} colours @returns {Rgb}
 */
function mixed(data, at, colours) {
  /** @type {Rgb} */
  let best = [0, 0, 0];
  let least = Infinity;
  for (const a of colours) {
    const alone = distance(a.from, data, at);
    if (alone < least) [best, least] = [a.to, alone];
  }
  if (least < 1) return best;
  colours.forEach((a, i) => {
    for (const b of colours.slice(i + 1)) {
      const share = along(a.from, b.from, data, at);
      const far = distance(between(a.from, b.from, share), data, at);
      if (far < least - 1e-9) [best, least] = [between(a.to, b.to, share), far];
    }
  });
  return best;
}

/** @param {Rgb} a @param {Rgb} b @param {number} share of b @returns {Rgb} */
const between = (a, b, share) =>
  [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])];

/** How far from a to b the pixel lies, 0 to 1. @param {Rgb} a @param {Rgb} b @param {ArrayLike<number>} p @param {number} at */
function along(a, b, p, at) {
  let dot = 0, square = 0;
  for (const i of /** @type {(0 | 1 | 2)[]} */ ([0, 1, 2])) {
    const way = b[i] - a[i];
    dot += way * ((p[at + i] ?? 0) - a[i]);
    square += way * way;
  }
  return square > 0 ? Math.min(1, Math.max(0, dot / square)) : 0;
}
