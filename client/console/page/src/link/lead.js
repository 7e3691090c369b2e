// One page leads at a time. Who gives an order or takes the hand while nobody leads takes the lead
// with it; from another page it is taken by its own button only.

/** @typedef {import('./wire.d.ts').Order} Order */
/** @typedef {import('./wire.d.ts').Outcome} Outcome */

export class Lead {
  /**
   * @param {import('./orders.js').Orders} orders
   * @param {import('./facts.js').Facts} facts
   */
  constructor(orders, facts) {
    this.orders = orders;
    this.facts = facts;
    /** A question under way. @type {Promise<Outcome> | null} */
    this.asking = null;
  }

  /**
   * Takes the lead unless this page has it, and the master's lease with it: a master that was started
   * anew has forgotten the lease, and one that nobody orders ends by itself.
   * @returns {Promise<Outcome>}
   */
  ensure() {
    if (this.facts.leads && this.facts.status.lease?.holder) return Promise.resolve({ done: true, reason: '' });
    this.asking ??= this.orders.lead('TAKE').finally(() => (this.asking = null));
    return this.asking;
  }

  /** Gives an order, taking the lead first if nobody has it. @param {Order} order @returns {Promise<Outcome>} */
  async give(order) {
    if (order.stop) return this.orders.stop();
    const led = await this.ensure();
    if (led.done) return this.orders.give(order);
    this.orders.onOutcome(order, led);
    return led;
  }
}
