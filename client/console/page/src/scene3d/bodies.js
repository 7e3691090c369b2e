// Work pieces and what stands around the arm.
import * as THREE from 'three';
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js';

/** @typedef {import('../link/wire.d.ts').SceneBody} SceneBody */
/** @typedef {import('../link/wire.d.ts').PoseMm} PoseMm */

/** @param {THREE.Object3D} object @param {PoseMm | undefined} pose */
export function place(object, pose) {
  const [x = 0, y = 0, z = 0] = pose?.position_mm ?? [];
  const [w = 1, a = 0, b = 0, c = 0] = pose?.quaternion ?? [];
  object.position.set(x, y, z);
  object.quaternion.set(a, b, c, w);
}

/** A plate with a hexagonal hole. @param {number} flats across them [mm] @param {number} depth [mm] */
function socket(flats, depth) {
  const hexagon = new THREE.Path();
  const radius = flats / Math.sqrt(3);
  for (let i = 0; i <= 6; ++i) {
    const turn = (i * Math.PI) / 3; // corners where the rig's socket has them
    if (i === 0) hexagon.moveTo(radius * Math.cos(turn), radius * Math.sin(turn));
    else hexagon.lineTo(radius * Math.cos(turn), radius * Math.sin(turn));
  }
  const head = new THREE.Shape();
  head.absarc(0, 0, Math.max(9, 1.5 * flats), 0, 2 * Math.PI, false);
  head.holes.push(hexagon);
  const rim = new THREE.ExtrudeGeometry(head, { depth, bevelEnabled: false, curveSegments: 32 });
  rim.translate(0, 0, -depth);
  const bottom = new THREE.CylinderGeometry(Math.max(9, 1.5 * flats), Math.max(9, 1.5 * flats), 2, 32).toNonIndexed();
  bottom.rotateX(Math.PI / 2);
  bottom.translate(0, 0, -depth - 1);
  return mergeGeometries([rim, bottom]);
}

/** A notch in the head's edge: a hexagon looks the same after a sixth of a turn. @param {number} flats [mm] */
function notch(flats) {
  const from = flats / Math.sqrt(3) + 0.6, to = Math.max(9, 1.5 * flats);
  const geometry = new THREE.BoxGeometry(to - from, 1.2, 0.3);
  geometry.translate((from + to) / 2, 0, 0.15);
  return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: 0x3a2508 }));
}

/** The plate that the screw is in. @param {number} depth [mm] */
function plate(depth) {
  const geometry = new THREE.BoxGeometry(120, 120, 24);
  geometry.translate(0, 0, -depth - 14);
  return geometry;
}

/** @param {SceneBody} body @returns {THREE.Object3D | null} null: of a kind that this page cannot draw */
function drawn(body) {
  const [a = 100, b = 100, c = 100] = body.size_mm ?? [];
  const steel = new THREE.MeshLambertMaterial({ color: 0xb98a4a, side: THREE.DoubleSide });
  const work = new THREE.MeshLambertMaterial({ color: 0x7d8a94 });
  switch (body.kind) {
    case 'PLANE': {
      const glass = new THREE.MeshLambertMaterial({ color: 0x7d8a94, transparent: true, opacity: 0.55, side: THREE.DoubleSide });
      return new THREE.Mesh(new THREE.PlaneGeometry(400, 400), glass);
    }
    case 'BOX': return new THREE.Mesh(new THREE.BoxGeometry(a, b, c), work);
    case 'CYLINDER': return new THREE.Mesh(new THREE.CylinderGeometry(a, a, b, 40).rotateX(Math.PI / 2), work);
    case 'TUBE': {
      const inside = new THREE.MeshLambertMaterial({ color: 0x7d8a94, side: THREE.BackSide });
      return new THREE.Mesh(new THREE.CylinderGeometry(a, a, b, 40, 1, true).rotateX(Math.PI / 2), inside);
    }
    case 'SOCKET': {
      const group = new THREE.Group(), screw = new THREE.Group();
      screw.name = 'screw';
      screw.add(new THREE.Mesh(socket(a, body.size_mm?.[1] ?? 5), steel), notch(a));
      group.add(screw);
      group.add(new THREE.Mesh(plate(body.size_mm?.[1] ?? 5), work));
      return group;
    }
    default: return null;
  }
}

/** A cross where the task has a place. @param {PoseMm} goal */
function goalMark(goal) {
  const size = 9;
  const points = [[size, 0, 0], [-size, 0, 0], [0, size, 0], [0, -size, 0], [0, 0, size], [0, 0, -size]];
  const geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(points.flat(), 3));
  const mark = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x18a070 }));
  place(mark, goal);
  return mark;
}

/**
 * @param {SceneBody[]} bodies @param {PoseMm[]} goals
 * @returns {{group: THREE.Group, unknown: string[]}} and the kinds that could not be drawn
 */
export function drawBodies(bodies, goals) {
  const group = new THREE.Group();
  /** @type {string[]} */
  const unknown = [];
  for (const body of bodies) {
    const object = drawn(body);
    if (object) {
      place(object, body.pose);
      group.add(object);
    } else {
      unknown.push(String(body.kind));
    }
  }
  for (const goal of goals) group.add(goalMark(goal));
  return { group, unknown };
}
