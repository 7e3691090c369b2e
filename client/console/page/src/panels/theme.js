// Dark or light: as the system says, until a person says otherwise.
import { button } from './dom.js';

const KEY = 'handrail.theme';

/** @returns {'dark' | 'light'} */
function theme() {
  const said = document.documentElement.dataset.theme;
  if (said === 'dark' || said === 'light') return said;
  return matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark';
}

/** @param {() => void} onChange */
export function setUpTheme(onChange) {
  const node = button('theme');
  const tell = () => {
    const other = theme() === 'dark' ? 'light' : 'dark';
    node.setAttribute('aria-label', `Theme: ${theme()}; switch to ${other}`);
    node.title = `switch to ${other}`;
  };
  const kept = keep.get(KEY);
  if (kept === 'dark' || kept === 'light') document.documentElement.dataset.theme = kept;
  tell();
  node.addEventListener('click', () => {
    const other = theme() === 'dark' ? 'light' : 'dark';
    document.documentElement.dataset.theme = other;
    keep.set(KEY, other);
    tell();
    onChange();
  });
  matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => {
    tell();
    onChange();
  });
}

/** What a browser remembers for us; one that refuses remembers nothing. */
export const keep = {
  /** @param {string} key */
  get(key) {
    try {
      return localStorage.getItem(key);
    } catch {
      return null;
    }
  },
  /** @param {string} key @param {string} value */
  set(key, value) {
    try {
      localStorage.setItem(key, value);
    } catch {
      // a private window: the next visit asks anew
    }
  },
};
