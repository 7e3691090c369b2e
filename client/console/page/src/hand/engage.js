// Engaging with the hand on the dead-man. A master whose dead-man is the page's refuses an engage while
// nobody holds it; a person with one pointer cannot hold and press at once. So a refused engage is kept
// for a while, and given again the moment the hand is held.

/** @typedef {import('../link/wire.d.ts').Order} Order */
/** @typedef {import('../link/wire.d.ts').Outcome} Outcome */

const KEPT_MS = 20000; // time to reach for the tip; later a person has forgotten it
const RESET_SEEN_MS = 1000; // a status from before a reset is older than that

export class Engage {
  /**
   * @param {import('../link/lead.js').Lead} lead
   * @param {import('../link/facts.js').Facts} facts
   * @param {import('./dead_man.js').DeadMan} deadMan
   * @param {(text: string) => void} say
   */
  constructor(lead, facts, deadMan, say) {
    this.lead = lead;
    this.facts = facts;
    this.deadMan = deadMan;
    this.say = say;
    this.keptUntil = 0;
    this.resetAt = -Infinity;
  }

  /** Whether a stop or a fault is latched: then holding the hand does not help. */
  get latched() {
    return this.facts.status.state === 'fault' && performance.now() - this.resetAt > RESET_SEEN_MS;
  }

  /** Whether an engage waits for the hand. */
  get waits() {
    return performance.now() < this.keptUntil;
  }

  /** Gives any order. @param {Order} order @returns {Promise<Outcome>} */
  async give(order) {
    if (order.engage || order.stop || order.disengage) this.drop();
    const outcome = await this.lead.give(order);
    if (order.reset && outcome.done) this.resetAt = performance.now();
    const unheld = !this.deadMan.held && !!this.facts.status.haptic?.cursor;
    if (order.engage && !outcome.done && unheld && this.facts.leads && !this.latched) {
      this.keptUntil = performance.now() + KEPT_MS;
      this.say('now hold the ring at the tip, or Shift: it engages then');
    }
    return outcome;
  }

  drop() {
    this.keptUntil = 0;
  }

  /** With each status: the master has seen that the hand is held. */
  look() {
    const { facts, deadMan } = this;
    if (!this.waits || !deadMan.held || !facts.status.haptic?.cursor?.held) return;
    this.drop();
    if (facts.status.state === 'off') void this.give({ engage: true });
  }
}
