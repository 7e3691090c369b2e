// An arm in the scene: a chain of links that turn by the joints.
import * as THREE from 'three';
import { armGeometries } from './arm_shape.js';
import { LENGTHS } from './inverse.js';

/** @typedef {import('../link/wire.d.ts').Vec} Vec */

/** Place of each link in the one before, and what its joint turns about. @type {[Vec, 'y' | 'z'][]} */
const CHAIN = [
  [[0, 0, 0], 'z'],
  [[LENGTHS.a1, 0, LENGTHS.d1], 'y'],
  [[0, 0, LENGTHS.a2], 'y'],
  [[-LENGTHS.a3, 0, LENGTHS.d4], 'z'],
  [[0, 0, 0], 'y'],
  [[0, 0, 0], 'z'],
];

export class Arm {
  /** @param {THREE.Material} material @param {THREE.BufferGeometry[]} geometries */
  constructor(material, geometries) {
    this.root = new THREE.Group();
    /** @type {THREE.Group[]} */
    this.joints = [];
    /** @type {Vec} */
    this.angles = [0, 0, 0, 0, 0, 0];
    this.root.add(new THREE.Mesh(geometries[0], material));
    let parent = this.root;
    CHAIN.forEach(([[x = 0, y = 0, z = 0]], i) => {
      const link = new THREE.Group();
      link.position.set(x, y, z);
      link.add(new THREE.Mesh(geometries[i + 1], material));
      parent.add(link);
      this.joints.push(link);
      parent = link;
    });
  }

  /**
   * @param {Vec} angles [rad]
   * @returns {boolean} whether the arm looks different now
   */
  pose(angles) {
    const least = 0.0002; // [rad], 0.1 mm at the tip: less than a pixel
    if (this.angles.every((value, i) => Math.abs(value - (angles[i] ?? 0)) < least)) return false;
    this.angles = [...angles];
    this.joints.forEach((link, i) => {
      link.rotation[CHAIN[i]?.[1] ?? 'z'] = angles[i] ?? 0;
    });
    return true;
  }
}

/**
 * The arm as it is, and the ghost of it where the hand wants it.
 * @param {number} tip [mm] @param {Vec} [aside] from there to a tip that is mounted aside [mm]
 */
export function armAndGhost(tip, aside) {
  const geometries = armGeometries(tip, aside);
  const solid = new THREE.MeshLambertMaterial({ vertexColors: true });
  const glass = new THREE.MeshBasicMaterial({ color: 0x3aa0ff, transparent: true, opacity: 0.2, depthWrite: false });
  const arm = new Arm(solid, geometries), ghost = new Arm(glass, geometries);
  ghost.root.renderOrder = 2;
  return { arm, ghost, glass };
}
