// Where the picture is taken from: orbit by the pointer, zoom, and named views.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

/** Way from what is looked at to the eye, S. @type {Record<string, [number, number, number]>} */
const VIEWS = {
  whole: [0.9, 1.15, 0.55],
  front: [1, 0, 0.08],
  side: [0, 1, 0.08],
  top: [0.001, 0, 1],
};
const WHOLE = 1300, NEAR = 420; // distances of the eye [mm]

export class Eye {
  /** @param {HTMLCanvasElement} canvas @param {() => void} onChange */
  constructor(canvas, onChange) {
    this.camera = new THREE.PerspectiveCamera(40, 1, 10, 6000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.minDistance = 60;
    this.controls.maxDistance = 3000;
    this.controls.addEventListener('change', onChange);
    this.onChange = onChange;
    this.look('whole', new THREE.Vector3(350, 0, 330));
  }

  /**
   * @param {string} view `whole`, `front`, `side`, `top` or `tip`
   * @param {THREE.Vector3} tip
   */
  look(view, tip) {
    const [x, y, z] = VIEWS[view] ?? [0.8, 0.9, 0.45];
    const target = view === 'whole' ? new THREE.Vector3(190, 0, 365) : view === 'tip' ? tip.clone() : new THREE.Vector3(190, 0, 365);
    const far = view === 'tip' ? NEAR : WHOLE;
    const aspect = Math.min(1, this.camera.aspect); // a narrow picture needs a longer way
    const way = new THREE.Vector3(x, y, z).normalize().multiplyScalar(far / aspect);
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(way);
    this.controls.update();
    this.onChange();
  }

  /** @param {number} factor above 1: closer */
  zoom(factor) {
    const way = this.camera.position.clone().sub(this.controls.target);
    const length = Math.min(3000, Math.max(60, way.length() / factor));
    this.camera.position.copy(this.controls.target).addScaledVector(way.normalize(), length);
    this.controls.update();
    this.onChange();
  }

  /** @param {number} width @param {number} height [px] */
  resize(width, height) {
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
  }
}
