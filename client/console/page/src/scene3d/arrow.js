// An arrow of any length, drawn once and stretched.
import * as THREE from 'three';

const HEAD = 18, WIDTH = 7; // [mm]

export class Arrow {
  /**
   * @param {number} colour @param {number} [thickness] of the shaft's radius [mm]
   * @param {boolean} [onTop] whether nothing hides it
   */
  constructor(colour, thickness = 1.6, onTop = false) {
    const paint = new THREE.MeshBasicMaterial({ color: colour, depthTest: !onTop, transparent: onTop });
    this.paint = paint;
    this.group = new THREE.Group();
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(thickness, thickness, 1, 12).translate(0, 0.5, 0), paint);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(WIDTH, HEAD, 18).translate(0, HEAD / 2, 0), paint);
    this.group.add(this.shaft, this.head);
    this.shaft.renderOrder = this.head.renderOrder = onTop ? 4 : 0;
    this.group.visible = false;
    this.along = new THREE.Vector3();
  }

  /**
   * @param {THREE.Vector3} from [mm] @param {THREE.Vector3} way with its length [mm]
   * @returns {THREE.Vector3} where it ends
   */
  point(from, way) {
    const length = way.length();
    this.group.visible = length > 1;
    if (!this.group.visible) return from;
    const head = Math.min(HEAD, 0.6 * length);
    this.along.copy(way).divideScalar(length);
    this.group.position.copy(from);
    this.group.quaternion.setFromUnitVectors(UP, this.along);
    this.shaft.scale.set(1, Math.max(0.1, length - head), 1);
    this.head.position.y = length - head;
    this.head.scale.setScalar(head / HEAD);
    return from.clone().add(way);
  }
}

const UP = new THREE.Vector3(0, 1, 0);
