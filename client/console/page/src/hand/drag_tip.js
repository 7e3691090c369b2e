// Dragging the arm's tip in the picture: across the screen, by the wheel toward the eye and away, with
// Ctrl to turn. Held while pressed. What is not the tip is left to the camera.

import { onPointerMove } from './pointer_move.js';

/** @typedef {import('../link/wire.d.ts').Vec} Vec */

const GRAB_PX = 30; // a finger's width about the tip
const TURN_DEG_PX = 0.25; // a third of the picture's width turns by about a quarter
const WHEEL_MM = 0.04; // a notch, of 100, is 4 mm at the hand

/**
 * From S to M: the transpose of R, whose columns say where device X, Y, Z point.
 * @param {Vec} R row by row @param {Vec} v @returns {Vec}
 */
export function toHand(R, v) {
  return [0, 1, 2].map((i) => (R[i] ?? 0) * (v[0] ?? 0) + (R[i + 3] ?? 0) * (v[1] ?? 0) + (R[i + 6] ?? 0) * (v[2] ?? 0));
}

/** @param {number} a @param {Vec} u @param {number} b @param {Vec} v @returns {Vec} a u + b v */
const sum = (a, u, b, v) => u.map((value, i) => a * value + b * (v[i] ?? 0));

/**
 * @param {HTMLElement} frame around the canvas: hears the pointer before the camera does
 * @param {{cursor: import('./cursor.js').Cursor, deadMan: import('./dead_man.js').DeadMan,
 *   mayHold: () => boolean, view: import('../scene3d/view3d.js').View3d,
 *   mapping: () => {scale: number, R: Vec}}} parts
 */
export function dragTip(frame, { cursor, deadMan, mayHold, view, mapping }) {
  /** @type {{id: number, x: number, y: number} | null} */
  let drag = null;
  deadMan.onChange((held) => {
    if (!held) drag = null;
  });
  /** @param {PointerEvent} event */
  const overTip = (event) => {
    const box = view.canvas.getBoundingClientRect(), tip = view.tipOnScreen();
    return Math.hypot(event.clientX - box.left - tip.x, event.clientY - box.top - tip.y) < GRAB_PX;
  };
  /** @param {PointerEvent} event */
  const press = (event) => {
    if (drag || event.button !== 0 || event.target !== view.canvas || !overTip(event) || !mayHold()) return;
    event.preventDefault();
    event.stopPropagation();
    frame.setPointerCapture(event.pointerId);
    deadMan.hold('pointer');
    drag = { id: event.pointerId, x: event.clientX, y: event.clientY };
  };
  /** @param {PointerEvent} event */
  const move = (event) => {
    if (!drag) {
      frame.classList.toggle('over-tip', event.target === view.canvas && overTip(event));
      return;
    }
    event.stopPropagation();
    if (event.pointerId !== drag.id || !deadMan.held) return;
    const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
    drag.x = event.clientX;
    drag.y = event.clientY;
    const { mm, right, up } = view.screenAxes();
    const { scale, R } = mapping();
    if (event.ctrlKey) cursor.turn(toHand(R, sum(dx * TURN_DEG_PX, up, dy * TURN_DEG_PX, right)));
    else cursor.move(toHand(R, sum((dx * mm) / scale, right, (-dy * mm) / scale, up)));
  };
  /** @param {WheelEvent} event */
  const wheel = (event) => {
    if (!drag) return;
    event.preventDefault();
    event.stopPropagation();
    const { toward } = view.screenAxes();
    cursor.move(toHand(mapping().R, toward.map((value) => value * event.deltaY * WHEEL_MM)));
  };
  /** @param {PointerEvent} event */
  const end = (event) => {
    if (drag?.id !== event.pointerId) return;
    drag = null;
    deadMan.letGo('pointer');
  };
  frame.addEventListener('pointerdown', press, { capture: true });
  onPointerMove(frame, move, { capture: true });
  frame.addEventListener('wheel', wheel, { capture: true, passive: false });
  for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    frame.addEventListener(kind, (event) => end(/** @type {PointerEvent} */ (event)), { capture: true });
  }
}
