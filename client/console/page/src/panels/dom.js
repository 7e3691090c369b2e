// Elements of the page by their id, and changes that cost nothing when nothing changes.

/** @template {HTMLElement} T @param {string} id @param {new () => T} kind @returns {T} */
export function element(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`the page has no ${kind.name} #${id}`);
  return found;
}

/** @param {string} id */
export const box = (id) => element(id, HTMLElement);

/** @param {string} id */
export const button = (id) => element(id, HTMLButtonElement);

/** @param {HTMLElement} node @param {string} text */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** @param {HTMLElement} node @param {string} name @param {string} value */
export function setData(node, name, value) {
  if (node.dataset[name] !== value) node.dataset[name] = value;
}

/** @param {HTMLElement} node @param {boolean} shown */
export function show(node, shown) {
  if (node.hidden === shown) node.hidden = !shown;
}

/**
 * Switches a button off with the reason, which a pointer over it and a screen reader tell.
 * @param {HTMLButtonElement | HTMLSelectElement} node @param {string} reason empty: switches it on
 */
export function block(node, reason) {
  const blocked = reason !== '';
  if (node.disabled !== blocked) node.disabled = blocked;
  if (node.title !== reason) node.title = reason;
}

/**
 * As many characters wide as `width`, so that nothing beside it moves.
 * @param {number | undefined} value @param {number} digits after the point @param {number} width
 */
export function number(value, digits, width) {
  const text = value === undefined || !Number.isFinite(value) || value < 0 ? '–' : value.toFixed(digits);
  return text.padStart(width, '\u2007');
}
