// Dragging the lever of a scene of walls, by mouse, pen or finger: held while pressed.

import { onPointerMove } from './pointer_move.js';

/**
 * @param {HTMLElement} canvas
 * @param {{cursor: import('./cursor.js').Cursor, deadMan: import('./dead_man.js').DeadMan,
 *   mayHold: () => boolean, scale: () => number}} parts scale: pixels a millimetre
 */
export function dragMap(canvas, { cursor, deadMan, mayHold, scale }) {
  /** @type {{id: number, x: number, y: number, from: number[]} | null} */
  let drag = null;
  deadMan.onChange((held) => {
    if (!held) drag = null;
  });
  canvas.addEventListener('pointerdown', (event) => {
    if (drag || event.button !== 0 || !mayHold()) return;
    event.preventDefault();
    canvas.setPointerCapture(event.pointerId);
    deadMan.hold('pointer');
    drag = { id: event.pointerId, x: event.clientX, y: event.clientY, from: [...cursor.position] };
  });
  onPointerMove(canvas, (event) => {
    if (!drag || event.pointerId !== drag.id || !deadMan.held) return;
    const [x = 0, y = 0, z = 0] = drag.from;
    cursor.moveTo([x + (event.clientX - drag.x) / scale(), y - (event.clientY - drag.y) / scale(), z]);
  });
  /** @param {PointerEvent} event */
  const end = (event) => {
    if (drag?.id !== event.pointerId) return;
    drag = null;
    deadMan.letGo('pointer');
  };
  for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    canvas.addEventListener(kind, (event) => end(/** @type {PointerEvent} */ (event)));
  }
}
