// The dead-man: held while at least one thing that a person holds is held. Whatever makes it doubtful
// that the person still looks and holds lets it go at once, and then all must be taken anew.

/** @typedef {'pointer' | 'key' | 'gamepad'} Holder */

export class DeadMan {
  constructor() {
    /** @type {Set<Holder>} */
    this.holders = new Set();
    /** @type {((held: boolean, why: string) => void)[]} */
    this.listeners = [];
  }

  get held() {
    return this.holders.size > 0;
  }

  /** @param {(held: boolean, why: string) => void} listener */
  onChange(listener) {
    this.listeners.push(listener);
  }

  /** @param {Holder} holder */
  hold(holder) {
    const was = this.held;
    this.holders.add(holder);
    if (!was) this.tell('');
  }

  /** @param {Holder} holder @param {string} [why] */
  letGo(holder, why = '') {
    if (this.holders.delete(holder) && !this.held) this.tell(why);
  }

  /** @param {string} why for the person: "the tab was hidden" */
  letAllGo(why) {
    if (!this.held) return;
    this.holders.clear();
    this.tell(why);
  }

  /** @param {string} why */
  tell(why) {
    for (const listener of this.listeners) listener(this.held, why);
  }
}

/**
 * Lets go when the page can no longer be seen or typed into.
 * @param {DeadMan} deadMan
 */
export function watchPage(deadMan) {
  document.addEventListener('visibilitychange', () => {
    if (document.visibilityState !== 'visible') deadMan.letAllGo('the tab was hidden');
  });
  window.addEventListener('pagehide', () => deadMan.letAllGo('the page was left'));
  window.addEventListener('blur', () => deadMan.letAllGo('the window lost the focus'));
}
