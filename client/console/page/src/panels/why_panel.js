// Why the robot is not where the hand is, in one line, with the way out as a button.
import { whyNoOrders } from '../link/facts.js';
import { block, box, button, setText, show } from './dom.js';

/** @typedef {import('../link/facts.js').Facts} Facts */
/** @typedef {import('../hand/engage.js').Engage} Engage */

/** @param {string} text */
const sentence = (text) => (text ? text[0]?.toUpperCase() + text.slice(1) : text);

/** What an order is called on a button. @type {Record<string, string>} */
const NAMES = { engage: 'engage', reset: 'reset', clutch: 'let the clutch go', lease: 'take the lease' };

/** @param {import('../link/wire.d.ts').Order[]} orders */
const named = (orders) =>
  orders.map((order) => NAMES[Object.keys(order).find((key) => NAMES[key]) ?? ''] ?? 'the way out').join(', then ');

/** @param {Facts} facts @param {Engage} drive */
export function setUpWhy(facts, drive) {
  button('way-out').addEventListener('click', async () => {
    for (const order of facts.status.ledger?.way_out_order ?? []) {
      const { done } = await drive.give(order);
      if (!done) return;
    }
  });
}

/** @param {Facts} facts */
export function updateWhy(facts) {
  const ledger = facts.status.ledger ?? {};
  const orders = ledger.way_out_order ?? [];
  const way = ledger.way_out ?? '';
  const text = ledger.sentence ?? (facts.hasStatus ? 'nothing keeps the robot from the hand' : 'waiting for the first news');
  setText(box('why'), sentence(text) + (way ? `. Way out: ${way}` : '') + '.');
  show(button('way-out'), orders.length > 0);
  setText(button('way-out'), sentence(named(orders)));
  block(button('way-out'), whyNoOrders(facts));
}
