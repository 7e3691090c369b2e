// Orders: from an event handler straight to the socket. Nothing here draws or waits to be drawn.

/** @typedef {import('./wire.d.ts').Order} Order */
/** @typedef {import('./wire.d.ts').LeadAct} LeadAct */
/** @typedef {import('./wire.d.ts').Outcome} Outcome */
/** @typedef {import('./gateway.js').Gateway} Gateway */

const PATIENCE_MS = 15000; // a lease asked for is answered within 10 s, an engage within 4

export class Orders {
  /** @param {Gateway} gateway */
  constructor(gateway) {
    this.gateway = gateway;
    this.nextId = 1;
    /** @type {Map<number, (outcome: Outcome) => void>} */
    this.waiting = new Map();
    /** Told each order and what became of it. @type {(order: Order, outcome: Outcome) => void} */
    this.onOutcome = () => {};
    gateway.on('reply', (reply) => this.settle(reply.id ?? 0, !!reply.done, reply.reason ?? ''));
    gateway.on('closed', () => this.dropAll());
  }

  /** @param {number} id @param {boolean} done @param {string} reason */
  settle(id, done, reason) {
    const answer = this.waiting.get(id);
    this.waiting.delete(id);
    answer?.({ done, reason });
  }

  dropAll() {
    for (const id of [...this.waiting.keys()]) {
      this.settle(id, false, 'the connection was lost before the answer: look at the state below');
    }
  }

  /**
   * @param {(id: number) => import('./wire.d.ts').FromPage} frame
   * @returns {Promise<Outcome>}
   */
  ask(frame) {
    const id = this.nextId++;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      if (!this.gateway.send(frame(id))) {
        this.settle(id, false, 'not sent: the gateway is not connected');
        return;
      }
      setTimeout(() => this.settle(id, false, 'no answer within 15 s'), PATIENCE_MS);
    });
  }

  /**
   * Sends an order. Never rejects: what went wrong is in the outcome.
   * @param {Order} order
   * @returns {Promise<Outcome>}
   */
  async give(order) {
    const outcome = await this.ask((id) => ({ request: { id, order } }));
    this.onOutcome(order, outcome);
    return outcome;
  }

  /** Stops the arm: sent in the moment of the call, whatever else waits for its answer. */
  stop() {
    return this.give({ stop: true });
  }

  /** Of a recording. @param {import('./wire.d.ts').PlayOrder} order @returns {Promise<Outcome>} */
  play(order) {
    return this.ask((id) => ({ play: { id, ...order } }));
  }

  /** @param {LeadAct} act @returns {Promise<Outcome>} */
  lead(act) {
    return this.ask((id) => ({ lead: { id, act } }));
  }
}
