// The active tools where they constrain: line with its way and end, plane, point, axis, kept orientation.
import * as THREE from 'three';
import { Arrow } from './arrow.js';

/** @typedef {import('../link/wire.d.ts').ToolStatus} ToolStatus */
/** @typedef {import('../link/wire.d.ts').ToolGeometry} ToolGeometry */
/** @typedef {import('../link/wire.d.ts').Vec} Vec */

const TOOL = 0x00a884, TURN = 0xc2699a; // position and orientation tools
const REACH = 250; // how far a line without an end is drawn [mm]
const EDGE = 200; // of the plane that is drawn [mm]
const CONE = 85; // length of the cone of tilts [mm]

/** @param {Vec | undefined} v @param {Vec} [otherwise] */
const vector = (v, otherwise = [0, 0, 0]) => new THREE.Vector3(...(v?.length === 3 ? v : otherwise));

/** @param {number} colour @param {number} opacity */
const glass = (colour, opacity) =>
  new THREE.MeshBasicMaterial({ color: colour, transparent: true, opacity, side: THREE.DoubleSide, depthWrite: false });

/** @param {THREE.Vector3} from @param {THREE.Vector3} to @param {number} radius @param {THREE.Material} material */
function rod(from, to, radius, material) {
  const way = to.clone().sub(from);
  const mesh = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, way.length(), 10), material);
  mesh.position.copy(from).addScaledVector(way, 0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way.normalize());
  return mesh;
}

/** @param {ToolGeometry} g */
function line(g) {
  const group = new THREE.Group();
  const paint = new THREE.MeshBasicMaterial({ color: TOOL });
  const at = vector(g.anchor_mm), way = vector(g.direction, [1, 0, 0]).normalize();
  const end = g.end_mm?.length === 3 ? vector(g.end_mm) : at.clone().addScaledVector(way, REACH);
  const start = g.one_way ? at : at.clone().addScaledVector(way, -REACH);
  group.add(rod(start, end, 1.1, paint));
  const arrow = new Arrow(TOOL, 1.2);
  arrow.point(end.clone().addScaledVector(way, -26), way.clone().multiplyScalar(26));
  group.add(arrow.group);
  if (!g.one_way) {
    const back = new Arrow(TOOL, 1.2);
    back.point(start.clone().addScaledVector(way, 26), way.clone().multiplyScalar(-26));
    group.add(back.group);
  }
  if (g.end_mm?.length === 3) {
    const stop = new THREE.Mesh(new THREE.CylinderGeometry(11, 11, 1.6, 32), paint);
    stop.position.copy(end);
    stop.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way);
    group.add(stop);
  }
  return group;
}

/** @param {ToolGeometry} g */
function plane(g) {
  const group = new THREE.Group();
  const at = vector(g.anchor_mm), normal = vector(g.normal, [0, 0, 1]).normalize();
  const sheet = new THREE.Group();
  sheet.add(new THREE.Mesh(new THREE.PlaneGeometry(EDGE, EDGE), glass(TOOL, 0.22)));
  const grid = new THREE.GridHelper(EDGE, 10, TOOL, TOOL);
  grid.rotateX(Math.PI / 2);
  sheet.add(grid);
  sheet.position.copy(at);
  sheet.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
  const up = new Arrow(TOOL, 1.2);
  up.point(at, normal.clone().multiplyScalar(45));
  group.add(sheet, up.group);
  if (g.direction?.length === 3 && g.one_way) {
    const forward = new Arrow(TOOL, 1.2);
    forward.point(at, vector(g.direction).normalize().multiplyScalar(EDGE / 2));
    group.add(forward.group);
  }
  return group;
}

/** @param {ToolGeometry} g */
function point(g) {
  const group = new THREE.Group();
  group.add(new THREE.Mesh(new THREE.SphereGeometry(5, 20, 14), glass(TOOL, 0.75)));
  for (const turn of [[0, 0, 0], [Math.PI / 2, 0, 0], [0, Math.PI / 2, 0]]) {
    const ring = new THREE.Mesh(new THREE.TorusGeometry(14, 0.9, 8, 40), glass(TOOL, 0.9));
    ring.rotation.set(turn[0] ?? 0, turn[1] ?? 0, turn[2] ?? 0);
    group.add(ring);
  }
  group.position.copy(vector(g.anchor_mm));
  return group;
}

/** The three axes that are kept, about the tip. */
function keptOrientation() {
  const group = new THREE.Group();
  for (const way of [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) {
    const arrow = new Arrow(TURN, 0.9);
    arrow.point(new THREE.Vector3(), vector(way).multiplyScalar(34));
    group.add(arrow.group);
  }
  const ring = new THREE.Mesh(new THREE.TorusGeometry(26, 1, 8, 48), glass(TURN, 0.85));
  group.add(ring);
  return group;
}

/**
 * The axis that stays, and about it a cone as wide as the hand is tilted from it: no tilt is allowed,
 * and the arm makes none.
 */
function keptAxis() {
  const group = new THREE.Group();
  const up = new THREE.Vector3(0, 0, 1);
  const paint = new THREE.MeshBasicMaterial({ color: TURN });
  group.add(rod(up.clone().multiplyScalar(-90), up.clone().multiplyScalar(90), 0.9, paint));
  const cone = new THREE.Mesh(new THREE.ConeGeometry(1, CONE, 36, 1, true).rotateX(-Math.PI / 2), glass(TURN, 0.25));
  cone.position.z = -CONE / 2;
  const end = 1.6 * Math.PI;
  const turn = new THREE.Mesh(new THREE.TorusGeometry(20, 1.1, 8, 48, end), paint);
  const head = new THREE.Mesh(new THREE.ConeGeometry(4, 11, 16), paint);
  head.position.set(20 * Math.cos(end), 20 * Math.sin(end), 0);
  head.rotation.z = end;
  group.add(cone, turn, head);
  return { group, cone };
}

/** Lets go of what a group holds on the graphics card. @param {THREE.Object3D} object */
export function dispose(object) {
  object.traverse((/** @type {any} */ each) => {
    each.geometry?.dispose();
    each.material?.dispose?.();
  });
}

export class ToolMarks {
  constructor() {
    this.root = new THREE.Group();
    /** What is drawn now, as text, to see whether it is another. */
    this.shown = '';
    /** Follows the tip. @type {THREE.Object3D | null} */
    this.atTip = null;
    /** @type {THREE.Mesh | null} */
    this.cone = null;
  }

  /**
   * @param {ToolStatus | undefined} position @param {ToolStatus | undefined} orientation
   * @returns {boolean} whether it looks different now
   */
  update(position, orientation) {
    const wanted = JSON.stringify([position?.kind, position?.geometry, orientation?.kind, orientation?.geometry]);
    if (wanted === this.shown) return this.tilt(orientation?.deviation_deg ?? 0);
    this.shown = wanted;
    dispose(this.root);
    this.root.clear();
    this.atTip = this.cone = null;
    const g = position?.geometry;
    if (g && position?.kind === 'line') this.root.add(line(g));
    if (g && position?.kind === 'plane') this.root.add(plane(g));
    if (g && position?.kind === 'point') this.root.add(point(g));
    if (orientation?.kind === 'n-rotation') this.orient(keptOrientation(), orientation.geometry?.quaternion);
    if (orientation?.kind === 'f-rotation') {
      const { group: mark, cone } = keptAxis();
      this.cone = cone;
      mark.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), vector(orientation.geometry?.axis, [0, 0, -1]).normalize());
      this.root.add(mark);
      this.atTip = mark;
    }
    this.tilt(orientation?.deviation_deg ?? 0);
    return true;
  }

  /** @param {number} deg of the hand from the axis @returns {boolean} whether it looks different now */
  tilt(deg) {
    if (!this.cone) return false;
    const radius = Math.max(0.3, CONE * Math.tan((Math.min(deg, 60) * Math.PI) / 180));
    if (Math.abs(radius - this.cone.scale.x) < 0.3) return false;
    this.cone.scale.set(radius, radius, 1);
    return true;
  }

  /** @param {THREE.Group} mark @param {Vec | undefined} q w x y z */
  orient(mark, q) {
    const [w = 1, x = 0, y = 0, z = 0] = q ?? [];
    mark.quaternion.set(x, y, z, w);
    this.root.add(mark);
    this.atTip = mark;
  }
}
