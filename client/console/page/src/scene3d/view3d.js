// The picture of an arm scene. Draws when something looks different, and only then.
import * as THREE from 'three';
import { armAndGhost } from './arm.js';
import { drawBodies } from './bodies.js';
import { Eye } from './camera.js';
import { inverse, mountedAt } from './inverse.js';
import { Labels } from './labels.js';
import { dispose, ToolMarks } from './tools.js';
import { ForceVectors } from './vectors.js';

/** @typedef {import('../link/facts.js').Facts} Facts */
/** @typedef {import('../link/wire.d.ts').PoseMm} PoseMm */

const REST = [0, 0, Math.PI / 2, 0, Math.PI / 2, 0]; // before anybody says where the arm is [rad]
const HEX_KEY = 301; // [mm], where a scene does not say the tip's length
const COARSE = 0.6; // of the pixels each way, while a picture moves that a processor draws
const STILL_MS = 250; // a picture that has not moved for so long is drawn with all of them
const APART_MM = 1.5, APART_COS = Math.cos(0.3 * Math.PI / 180); // a ghost nearer is the arm itself

/** @param {PoseMm | undefined} pose */
const placeOf = (pose) => new THREE.Vector3(...(pose?.position_mm?.length === 3 ? pose.position_mm : [350, 0, 329]));

/**
 * Whether a processor draws, not a graphics card: then smooth edges cost a third of the pictures.
 * @returns {boolean} true as well where there is no WebGL
 */
function drawnBySoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const names = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = gl && names ? String(gl.getParameter(names.UNMASKED_RENDERER_WEBGL)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return !gl || /swiftshader|llvmpipe|software|basic render/i.test(name);
}

export class View3d {
  /** @param {HTMLCanvasElement} canvas @param {HTMLElement} layer for words; throws without WebGL */
  constructor(canvas, layer) {
    this.canvas = canvas;
    this.coarse = drawnBySoftware() ? COARSE : 1;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: this.coarse === 1, alpha: true, powerPreference: 'low-power' });
    this.renderer.setPixelRatio(1);
    this.dirty = true;
    this.movedAt = 0;
    this.drawn = 0;
    this.scene = new THREE.Scene();
    this.eye = new Eye(canvas, () => (this.dirty = true));
    this.labels = new Labels(layer);
    this.tools = new ToolMarks();
    this.forces = new ForceVectors(this.labels);
    this.tip = placeOf(undefined);
    this.tipLength = HEX_KEY;
    /** The tip from where tipLength ends. @type {PoseMm} */
    this.mount = {};
    /** Kinds of bodies that could not be drawn. @type {string[]} */
    this.unknown = [];
    this.bodies = new THREE.Group();
    /** Turned as the rig says it is. @type {THREE.Object3D | null} */
    this.screw = null;
    this.handle = new THREE.Mesh(
      new THREE.TorusGeometry(15, 1.7, 10, 40),
      new THREE.MeshBasicMaterial({ color: 0xffb224, depthTest: false, transparent: true }),
    );
    this.handle.renderOrder = 5;
    this.arms = armAndGhost(this.tipLength);
    this.setUp();
  }

  setUp() {
    const sun = new THREE.DirectionalLight(0xffffff, 2.1);
    sun.position.set(600, 500, 1200);
    const fill = new THREE.DirectionalLight(0xbfd6ff, 0.7);
    fill.position.set(-500, -700, 300);
    this.floor = new THREE.GridHelper(1200, 12, 0x7c8890, 0x7c8890);
    this.floor.rotateX(Math.PI / 2);
    this.floor.position.set(200, 0, 0);
    for (const m of [this.floor.material].flat()) Object.assign(m, { transparent: true, opacity: 0.3 });
    this.scene.add(sun, fill, new THREE.HemisphereLight(0xffffff, 0x50565c, 1.0), this.floor);
    this.scene.add(this.tools.root, this.forces.root, this.bodies, this.handle);
    this.addArms();
  }

  addArms() {
    this.scene.add(this.arms.arm.root, this.arms.ghost.root);
    this.arms.arm.pose(REST);
    this.arms.ghost.root.visible = false;
  }

  /** Another scene: other work pieces, another tip. @param {Facts} facts */
  setScene({ scene }) {
    dispose(this.bodies);
    this.scene.remove(this.bodies);
    const { group, unknown } = drawBodies(scene.body ?? [], scene.goal ?? []);
    this.bodies = group;
    this.screw = group.getObjectByName('screw') ?? null;
    this.unknown = unknown;
    this.scene.add(group);
    this.labels.drop('goal');
    (scene.goal ?? []).forEach((goal, i) => this.labels.put(`goal ${i}`, 'ABCDEFGH'[i] ?? `${i + 1}`, placeOf(goal)));
    const tip = scene.arm?.tip_mm ?? HEX_KEY, mount = scene.arm?.mount ?? {};
    if (tip !== this.tipLength || JSON.stringify(mount) !== JSON.stringify(this.mount)) {
      this.scene.remove(this.arms.arm.root, this.arms.ghost.root);
      dispose(this.arms.arm.root);
      this.tipLength = tip;
      this.mount = mount;
      this.arms = armAndGhost(tip, mount.position_mm);
      this.addArms();
    }
    this.dirty = true;
  }

  /** @param {Facts} facts */
  update({ status, scene, rig, recording }) {
    // Clockwise, as one looks at its head.
    const turned = (-(rig?.moment?.screw?.turned_deg ?? 0) * Math.PI) / 180;
    if (this.screw && Math.abs(this.screw.rotation.z - turned) > 1e-3) {
      this.screw.rotation.z = turned;
      this.dirty = true;
    }
    const { arm } = this.arms;
    const measured = status.joints_deg?.length === 6 ? status.joints_deg.map((deg) => (deg * Math.PI) / 180) : null;
    const joints = measured ?? (status.tip ? this.solve(status.tip) : null);
    if (joints && arm.pose(joints)) this.dirty = true;
    if (status.tip) this.tip = placeOf(status.tip);
    this.moveGhost(status.state === 'off' ? undefined : status.desired_tip ?? status.command, status.tip);
    if (this.handle.position.distanceTo(this.tip) > 0.05) this.dirty = true;
    this.handle.position.copy(this.tip);
    this.handle.visible = !recording; // there is nothing to take hold of
    if (this.tools.update(status.position_tool, status.orientation_tool)) this.dirty = true;
    this.tools.atTip?.position.copy(this.tip);
    if (this.forces.update(status, scene.rotation ?? [], this.tip)) this.dirty = true;
  }

  /** @param {PoseMm} pose */
  solve(pose) {
    if (pose.position_mm?.length !== 3) return null;
    const { p, q } = mountedAt(pose.position_mm, pose.quaternion ?? [], this.mount);
    return inverse(p, q, this.tipLength, this.arms.arm.angles);
  }

  /** @param {PoseMm | undefined} wanted @param {PoseMm | undefined} tip */
  moveGhost(wanted, tip) {
    const { ghost } = this.arms;
    const joints = wanted && tip ? this.solve(wanted) : null;
    const dot = (wanted?.quaternion ?? []).reduce((sum, value, i) => sum + value * (tip?.quaternion?.[i] ?? 0), 0);
    const apart = !!joints && (placeOf(wanted).distanceTo(placeOf(tip)) > APART_MM || 2 * dot * dot - 1 < APART_COS);
    if (apart !== ghost.root.visible) this.dirty = true;
    ghost.root.visible = apart;
    if (apart && joints && ghost.pose(joints)) this.dirty = true;
  }

  /** @param {number} width @param {number} height [px] */
  resize(width, height) {
    this.renderer.setSize(width, height, false);
    this.eye.resize(width, height);
    this.size = { width, height };
    this.dirty = true;
  }

  /** Where the tip is on the canvas. @returns {{x: number, y: number}} [px] */
  tipOnScreen() {
    const p = this.tip.clone().project(this.eye.camera);
    const { width = 1, height = 1 } = this.size ?? {};
    return { x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height };
  }

  /** How many millimetres a pixel is at the tip, and where screen right, up and toward the eye point in S. */
  screenAxes() {
    const { camera } = this.eye;
    const { height = 1 } = this.size ?? {};
    const far = camera.position.distanceTo(this.tip);
    const mm = (2 * far * Math.tan((camera.fov * Math.PI) / 360)) / height;
    const right = new THREE.Vector3(), up = new THREE.Vector3(), toward = new THREE.Vector3();
    camera.matrixWorld.extractBasis(right, up, toward);
    return { mm, right: right.toArray(), up: up.toArray(), toward: toward.toArray() };
  }

  /** Draws if anything looks different, or could look better. @returns {boolean} whether it drew */
  draw() {
    if (!this.size) return false;
    const now = performance.now(), sharp = this.renderer.getPixelRatio() === 1;
    if (!this.dirty && (sharp || now - this.movedAt < STILL_MS)) return false;
    if (this.dirty) this.movedAt = now;
    const ratio = this.dirty ? this.coarse : 1;
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    this.dirty = false;
    this.handle.quaternion.copy(this.eye.camera.quaternion);
    this.handle.scale.setScalar(this.eye.camera.position.distanceTo(this.tip) / 900);
    this.renderer.render(this.scene, this.eye.camera);
    this.labels.layOut(this.eye.camera, this.size.width, this.size.height);
    this.drawn += 1;
    return true;
  }

  /** What the newest picture cost. */
  cost() {
    const { calls, triangles } = this.renderer.info.render;
    return { calls, triangles, drawn: this.drawn };
  }
}
