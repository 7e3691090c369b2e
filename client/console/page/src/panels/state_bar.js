// The bar: session, link, who leads, lease, and how old all of it is.
import { OLD_MS } from '../link/facts.js';
import { box, number, setData, setText } from './dom.js';

/** @typedef {import('../link/facts.js').Facts} Facts */

/** How good a state is. @type {Record<string, string>} */
const MOOD = { engaged: 'good', homing: 'info', aligning: 'info', clutched: 'warn', hold: 'warn', fault: 'bad' };
/** @type {Record<string, string>} */
const QUALITY = { EXCELLENT: 'good', GOOD: 'good', FAIR: 'warn', POOR: 'bad' };
const ORDER = ['none', 'POOR', 'FAIR', 'GOOD', 'EXCELLENT'];

/** The worse of the two ways. @param {string} a @param {string} b */
const worse = (a, b) => (ORDER.indexOf(a) < ORDER.indexOf(b) ? a : b);

/** @param {Date | null} when */
const clock = (when) => (when ? when.toLocaleTimeString('en-GB') : 'the start');

/** @param {Facts} facts */
function leaderText({ hello, connected, leads }) {
  if (!connected) return '–';
  if (leads) return 'this page';
  return hello.leader ? `page ${hello.leader}` : 'nobody';
}

/** @param {Facts} facts */
function leaseText({ status, hello }) {
  const lease = status.lease;
  if (!lease?.holder) return 'free';
  const who = lease.holder === hello.name ? `${lease.holder} (here)` : lease.holder;
  return lease.asked_by ? `${who}, asked by ${lease.asked_by}` : `${who}, ${Math.round(lease.held_s ?? 0)} s`;
}

/** @param {Facts} facts */
export function updateBar(facts) {
  const { status, isWalls, hasStatus } = facts;
  const age = facts.age(), old = age > OLD_MS;
  document.documentElement.classList.toggle('old', old);
  const walls = isWalls && status.state === 'off'; // no robot takes part: off is how it should be
  const state = walls ? 'hand only' : status.state ?? '–';
  setText(box('state'), state);
  setData(box('state'), 'mood', old ? 'old' : walls ? 'good' : MOOD[status.state ?? ''] ?? 'plain');
  const quality = isWalls ? 'no arm' : worse(status.link_quality ?? 'none', status.peer_quality ?? 'none');
  setText(box('quality'), hasStatus ? quality.toLowerCase() : '–');
  setData(box('quality'), 'mood', old ? 'old' : QUALITY[quality] ?? 'plain');
  setText(box('leader'), leaderText(facts));
  setText(box('lease'), hasStatus ? leaseText(facts) : '–');
  setText(box('age'), number(Math.min(age, 99999), 0, 5));
  setData(box('age-fact'), 'mood', old ? 'bad' : 'good');
}

/**
 * What is missing, and since when; empty: nothing.
 * @param {Facts} facts @param {{retryAt: number, refusal: number}} gateway
 */
export function whatIsMissing(facts, { retryAt, refusal }) {
  if (facts.recording) {
    if (!facts.connected) return 'The gateway does not answer: is handrail play running? One that was started anew has printed a new address: open that.';
    return facts.problem;
  }
  const since = `no news since ${clock(facts.trueAtDate)}`;
  if (!facts.connected) {
    const wait = Math.max(0, Math.ceil((retryAt - performance.now()) / 1000));
    if (refusal === 403) return `The gateway was started anew, or the link of this page has ended (${since}): open the address that it printed (READY url=…), or a new link (handrail keys link).`;
    if (refusal >= 200) return `The gateway lets no further page in: close one (${since}). Trying again ${wait > 0 ? `in ${wait} s` : 'now'}.`;
    return `The gateway does not answer (${since}): is handrail-console running? One that was started anew has printed a new address: open that. Trying again ${wait > 0 ? `in ${wait} s` : 'now'}.`;
  }
  if (facts.problem) return `${facts.problem} (${since})`;
  if (facts.hasStatus && facts.age() > OLD_MS) return `N${since.slice(1)}: what you see is old.`;
  return '';
}
