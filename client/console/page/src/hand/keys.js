// The keyboard: Escape and Space stop, always; a letter gives an order; Shift held is the dead-man, and
// with it the arrows move the hand.

/** @typedef {import('./cursor.js').Cursor} Cursor */
/** @typedef {import('./dead_man.js').DeadMan} DeadMan */

const PERIOD_MS = 10;
export const SPEED_MM_S = 50; // of the hand by arrows or stick: a gear is reached in a second

/** Directions in M: right, up, toward the person. @type {Record<string, [number, number, number]>} */
const WAYS = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0],
  PageUp: [0, 0, -1], PageDown: [0, 0, 1],
};

/** Whether letters belong to what has the focus. @param {EventTarget | null} target */
function typesText(target) {
  return (target instanceof HTMLInputElement && target.type === 'text') || target instanceof HTMLSelectElement;
}

/**
 * Escape and Space, before anything else hears them, from wherever the focus is.
 * @param {() => void} stop
 */
export function stopKeys(stop) {
  /** @param {KeyboardEvent} event */
  const hear = (event) => {
    if (event.code !== 'Escape' && event.code !== 'Space') return;
    event.preventDefault(); // a button that has the focus is not pressed by it
    event.stopImmediatePropagation();
    if (event.type === 'keydown' && !event.repeat) stop();
  };
  for (const kind of ['keydown', 'keyup', 'keypress']) {
    window.addEventListener(kind, (event) => hear(/** @type {KeyboardEvent} */ (event)), { capture: true });
  }
}

/**
 * One key an order, by the key's place on the board: `KeyL`.
 * @param {Map<string, () => void>} orders
 */
export function orderKeys(orders) {
  document.addEventListener('change', ({ target }) => {
    if (target instanceof HTMLSelectElement) target.blur(); // chosen: letters are orders again
  });
  window.addEventListener('keydown', (event) => {
    if (event.repeat || event.ctrlKey || event.altKey || event.metaKey || typesText(event.target)) return;
    const order = orders.get(event.code);
    if (!order) return;
    event.preventDefault();
    order();
  });
}

/** @param {{cursor: Cursor, deadMan: DeadMan, mayHold: () => boolean}} parts */
export function handKeys({ cursor, deadMan, mayHold }) {
  /** @type {Set<string>} */
  const down = new Set();
  let timer = 0;
  let last = 0;
  const step = () => {
    const now = performance.now(), way = (SPEED_MM_S * Math.min(50, now - last)) / 1000;
    last = now;
    for (const code of down) cursor.move((WAYS[code] ?? [0, 0, 0]).map((value) => value * way));
  };
  deadMan.onChange((held) => {
    window.clearInterval(timer);
    if (!held) down.clear();
    else timer = window.setInterval(step, PERIOD_MS);
    last = performance.now();
  });
  window.addEventListener('keydown', (event) => {
    if (event.key === 'Shift' && !event.repeat && !typesText(event.target) && mayHold()) deadMan.hold('key');
    if (!WAYS[event.code] || !deadMan.held) return;
    event.preventDefault();
    down.add(event.code);
  });
  window.addEventListener('keyup', (event) => {
    if (event.key === 'Shift') deadMan.letGo('key');
    down.delete(event.code);
  });
}
