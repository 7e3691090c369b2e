// A pointer's moves, as soon as the browser knows of them.

/**
 * A browser holds `pointermove` back until it is about to draw: by a frame, and more where drawing is slow.
 * `pointerrawupdate` (Pointer Events 3) comes at once, where there is one; `pointermove` follows all the
 * same, and says where the pointer is once more.
 * @param {HTMLElement} node @param {(event: PointerEvent) => void} listener @param {AddEventListenerOptions} [options]
 */
export function onPointerMove(node, listener, options) {
  for (const kind of ['pointerrawupdate', 'pointermove']) {
    node.addEventListener(kind, (event) => listener(/** @type {PointerEvent} */ (event)), options);
  }
}
