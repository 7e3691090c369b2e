// Forces at the tip as arrows, with their newtons beside them.
import * as THREE from 'three';
import { Arrow } from './arrow.js';

/** @typedef {import('../link/wire.d.ts').Status} Status */
/** @typedef {import('../link/wire.d.ts').Vec} Vec */

const HAND_MM = 110; // as long is the most that the device can push
const USUAL_N = 3.3; // of a device that does not say
const CONTACT_MM_N = 2; // of what the sensor feels: 50 N, the bumper's threshold, are 100 mm
const LONGEST = 150; // [mm]
const LEAST_HAND = 0.05, LEAST_CONTACT = 0.5; // [N]: smaller ones are noise

/** @param {Vec} R row by row @param {Vec} v @returns {Vec} */
const rotated = (R, v) => [0, 3, 6].map((row) => (R[row] ?? 0) * (v[0] ?? 0) + (R[row + 1] ?? 0) * (v[1] ?? 0) + (R[row + 2] ?? 0) * (v[2] ?? 0));

/** Right = -Y, up = +Z, toward the user = -X: where device axes point when a scene says nothing. */
export const USUAL_ROTATION = [0, 0, -1, -1, 0, 0, 0, 1, 0];

export class ForceVectors {
  /** @param {import('./labels.js').Labels} labels */
  constructor(labels) {
    this.root = new THREE.Group();
    this.labels = labels;
    this.arrows = {
      tool: new Arrow(0x2f8fff, 2.4, true),
      spring: new Arrow(0xa06bff, 2.4, true),
      contact: new Arrow(0xff7a2e, 2.4, true),
    };
    for (const arrow of Object.values(this.arrows)) this.root.add(arrow.group);
    this.shown = '';
  }

  /**
   * @param {Status} status @param {Vec} R of M in S, row by row @param {THREE.Vector3} tip
   * @returns {boolean} whether it looks different now
   */
  update(status, R, tip) {
    const hand = R.length === 9 ? R : USUAL_ROTATION;
    const tool = rotated(hand, status.tool_force?.force_n ?? []);
    const spring = rotated(hand, status.spring_force?.force_n ?? []);
    const contact = status.has_contact_force ? status.contact_force_n ?? [] : [];
    const now = [tool, spring, contact, tip.toArray()].flat().map((value) => Math.round(20 * value)).join();
    if (now === this.shown) return false;
    this.shown = now;
    const scale = HAND_MM / (status.haptic?.max_force_n || USUAL_N);
    this.set('tool', 'tool', tool, scale, LEAST_HAND, tip);
    this.set('spring', 'spring', spring, scale, LEAST_HAND, tip);
    this.set('contact', 'contact', contact, CONTACT_MM_N, LEAST_CONTACT, tip);
    return true;
  }

  /**
   * @param {'tool' | 'spring' | 'contact'} name @param {string} text @param {Vec} force [N], S
   * @param {number} scale [mm/N] @param {number} least [N] @param {THREE.Vector3} tip
   */
  set(name, text, force, scale, least, tip) {
    const way = new THREE.Vector3(force[0] ?? 0, force[1] ?? 0, force[2] ?? 0);
    const size = way.length();
    if (size < least) {
      this.arrows[name].group.visible = false;
      this.labels.hide(name);
      return;
    }
    way.multiplyScalar(Math.min(scale, LONGEST / size));
    const end = this.arrows[name].point(tip, way);
    this.labels.put(name, `${text} ${size.toFixed(size < 10 ? 2 : 0)} N`, end);
  }
}
