// What the simulated rig says of its screw, beside the arm: how far it is turned, how deep the key is, and
// whether it slips or jams. Words of others go in as text alone.
import { box, setData, setText, show } from './dom.js';

/** @typedef {import('../link/wire.d.ts').RigNews} RigNews */

const TOUCH_N = 0.5; // less is not said
const FITS_DEG = 2.5; // more than the play of a key that is in: then its corners are across

/** @param {import('../link/wire.d.ts').RigScrew} screw @returns {string} */
function deepness({ depth_mm: depth, off_flats_deg: off = 0 }) {
  const turn = `, fits ${Math.abs(off).toFixed(0)}° ${off < 0 ? 'counterclockwise' : 'clockwise'}`;
  if (depth === undefined) return `key beside it${turn}`;
  return depth < 0 ? `key ${(-depth).toFixed(1)} mm above${turn}` : `key ${depth.toFixed(1)} mm in${Math.abs(off) > FITS_DEG ? turn : ''}`;
}

/** @param {RigNews} rig what is amiss, in a word; empty: nothing */
function trouble({ moment, problem }) {
  if (problem) return problem;
  if (moment?.screw?.slipped) return 'slipped';
  return moment?.screw?.jammed ? 'jammed' : '';
}

/** @param {RigNews | null} rig null: nobody told of one */
export function updateScrew(rig) {
  const screw = rig?.moment?.screw;
  show(box('screw'), !!screw || !!rig?.problem);
  if (!rig) return;
  show(box('screw-turned'), !!screw);
  setText(box('screw-turned'), `${(screw?.turned_deg ?? 0).toFixed(0)}°`);
  const force = Math.hypot(...(rig.moment?.force_n ?? []));
  setText(box('screw-key'), screw ? deepness(screw) + (force > TOUCH_N ? `, ${force.toFixed(0)} N` : '') : '');
  const amiss = trouble(rig);
  setText(box('screw-trouble'), amiss);
  setData(box('screw'), 'amiss', String(!!amiss));
}
