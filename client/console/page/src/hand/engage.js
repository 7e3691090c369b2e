// Engaging with the hand on the dead-man. A master whose device is the page's refuses an engage while
// nobody holds it, after it has waited for that; and a person with one pointer cannot hold and press at
// once. So an engage waits here for the hand, and is given the moment the master has seen it held.

/** @typedef {import('../link/wire.d.ts').Order} Order */
/** @typedef {import('../link/wire.d.ts').Outcome} Outcome */

const KEPT_MS = 20000; // time to reach for the tip; later a person has forgotten it
const RESET_SEEN_MS = 1000; // a status from before a reset is older than that
const HOLD_ON = 'now hold the ring at the tip, or Shift: it engages then';

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

  /** Whether an engage waits for the hand. */
  get waits() {
    return performance.now() < this.keptUntil;
  }

  /** Whether a stop or a fault is latched: then the master says why not. */
  get latched() {
    return this.facts.status.state === 'fault' && performance.now() - this.resetAt > RESET_SEEN_MS;
  }

  /** Whether the master has seen that the hand is held. */
  get seen() {
    return this.deadMan.held && !!this.facts.status.haptic?.cursor?.held;
  }

  /** Gives any order. @param {Order} order @returns {Promise<Outcome>} */
  async give(order) {
    if (order.engage && this.facts.status.haptic?.cursor && !this.seen && !this.latched) {
      this.keptUntil = performance.now() + KEPT_MS;
      if (!this.deadMan.held) this.say(HOLD_ON);
      return { done: false, reason: HOLD_ON };
    }
    if (order.engage || order.disengage) this.drop();
    const outcome = await this.lead.give(order);
    if (order.reset && outcome.done) this.resetAt = performance.now();
    return outcome;
  }

  drop() {
    this.keptUntil = 0;
  }

  /** With each status. */
  look() {
    if (!this.waits || !this.seen) return;
    this.drop();
    if (this.facts.status.state !== 'engaged') void this.give({ engage: true });
  }
}
