// The RV-2A's shape, our own, around the lengths of its chain [mm]. One mesh a link; colours by vertex.
import * as THREE from 'three';
import { RoundedBoxGeometry } from 'three/addons/geometries/RoundedBoxGeometry.js';
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js';
import { LENGTHS } from './inverse.js';

/** @typedef {[number, number, number]} Triple */

const SHELL = 0xe6e7e1, JOINT = 0x4b535b, DARK = 0x2b3137, METAL = 0x9aa4ad, SENSOR = 0x2f6f9f, KEY = 0xc9ced3;
const ROUND = 36; // sides of what is round: smooth at this size, cheap to draw

/** @param {THREE.BufferGeometry} geometry @param {number} colour @param {Triple} at @returns {THREE.BufferGeometry} */
function part(geometry, colour, at) {
  const plain = geometry.index ? geometry.toNonIndexed() : geometry;
  plain.deleteAttribute('uv');
  plain.translate(...at);
  const tint = new THREE.Color(colour);
  const count = plain.getAttribute('position').count;
  const colours = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) tint.toArray(colours, 3 * i);
  plain.setAttribute('color', new THREE.BufferAttribute(colours, 3));
  return plain;
}

/** @param {Triple} size @param {number} colour @param {Triple} at @param {number} [radius] */
const box = (size, colour, at, radius = 14) => part(new RoundedBoxGeometry(...size, 3, radius), colour, at);

/**
 * A cylinder or cone along an axis, its middle at `at`.
 * @param {'x' | 'y' | 'z'} axis @param {number} from radius at the lower end @param {number} to at the upper
 * @param {number} length @param {number} colour @param {Triple} at @param {number} [sides]
 */
function round(axis, from, to, length, colour, at, sides = ROUND) {
  const geometry = new THREE.CylinderGeometry(to, from, length, sides);
  if (axis === 'z') geometry.rotateX(Math.PI / 2);
  if (axis === 'x') geometry.rotateZ(-Math.PI / 2);
  return part(geometry, colour, at);
}

/** @param {THREE.BufferGeometry[]} parts @returns {THREE.BufferGeometry} */
function merged(parts) {
  const whole = mergeGeometries(parts);
  for (const one of parts) one.dispose();
  return whole;
}

function base() {
  return merged([
    box([250, 220, 26], DARK, [-10, 0, 13], 8),
    round('z', 104, 92, 110, SHELL, [0, 0, 80]),
    round('z', 92, 92, 46, SHELL, [0, 0, 158]),
    box([92, 120, 130], SHELL, [-88, 0, 85], 12),
    box([14, 84, 62], JOINT, [-132, 0, 78], 4),
    round('z', 94, 94, 10, JOINT, [0, 0, 186]),
  ]);
}

function shoulder() {
  const { d1, a1 } = LENGTHS;
  return merged([
    round('z', 88, 84, 62, SHELL, [0, 0, 222]),
    box([150, 126, 128], SHELL, [34, 0, 292], 22),
    box([112, 50, 120], SHELL, [a1 - 14, 86, d1 - 12], 18),
    round('y', 60, 60, 46, SHELL, [a1, 86, d1]),
    round('y', 46, 46, 8, JOINT, [a1, 112, d1]),
    round('y', 60, 60, 124, JOINT, [a1, 0, d1]),
    box([66, 90, 70], JOINT, [-46, 0, 300], 10),
  ]);
}

function upperArm() {
  const { a2 } = LENGTHS;
  return merged([
    round('y', 58, 58, 100, SHELL, [0, 0, 0]),
    box([92, 96, a2 - 20], SHELL, [-4, 0, a2 / 2], 20),
    box([60, 8, a2 - 110], JOINT, [-4, -49, a2 / 2], 3),
    round('y', 50, 50, 104, SHELL, [0, 0, a2]),
    round('y', 36, 36, 116, JOINT, [0, 0, a2]),
  ]);
}

function elbow() {
  const { a3 } = LENGTHS;
  return merged([
    round('y', 47, 47, 92, JOINT, [0, 0, 0]),
    box([a3 + 92, 88, 104], SHELL, [-a3 / 2 - 16, 0, -4], 20),
    box([70, 76, 40], JOINT, [-a3 - 4, 0, -62], 10),
    round('z', 46, 44, 40, SHELL, [-a3, 0, 62]),
    round('z', 45, 45, 8, JOINT, [-a3, 0, 84]),
  ]);
}

/** About the wrist's centre, along the forearm. */
function forearm() {
  const end = -LENGTHS.d4 + 88;
  return merged([
    round('z', 43, 36, -end - 44, SHELL, [0, 0, end / 2 - 22]),
    box([58, 84, 40], SHELL, [0, 0, -46], 12),
    box([50, 16, 72], SHELL, [0, 36, -12], 8),
    box([50, 16, 72], SHELL, [0, -36, -12], 8),
    round('y', 24, 24, 92, JOINT, [0, 0, 0]),
  ]);
}

function wrist() {
  return merged([
    round('y', 31, 31, 54, SHELL, [0, 0, 0]),
    round('z', 29, 29, 50, SHELL, [0, 0, 32]),
    round('z', 30, 30, 5, JOINT, [0, 0, 59]),
  ]);
}

/**
 * Flange, and beyond it sensor and hex key as far as the tip, or as the tool that is mounted there.
 * @param {number} tip @param {import('../link/wire.d.ts').Vec} aside
 */
function flange(tip, aside) {
  const face = LENGTHS.flange;
  const parts = [
    round('z', 31, 31, 22, METAL, [0, 0, face - 11]),
    box([8, 8, 8], DARK, [24, 0, face - 12], 2),
  ];
  const beyond = tip - face;
  if (beyond > 80) {
    parts.push(round('z', 37, 37, 34, SENSOR, [0, 0, face + 17]), round('z', 37.5, 37.5, 4, DARK, [0, 0, face + 17]));
    parts.push(round('z', 20, 11, 34, METAL, [0, 0, face + 51]));
    parts.push(round('z', 4, 3.4, beyond - 68, KEY, [0, 0, face + 68 + (beyond - 68) / 2], 6));
    parts.push(part(new THREE.SphereGeometry(4.2, 12, 8), KEY, [0, 0, tip]));
  } else if (beyond > 1) {
    parts.push(round('z', 12, 4, beyond, METAL, [0, 0, face + beyond / 2]));
  }
  const [x = 0, y = 0, z = 0] = aside, length = Math.hypot(x, y, z);
  if (length > 1) {
    const way = new THREE.Vector3(x / length, y / length, z / length);
    const rod = new THREE.CylinderGeometry(3.4, 4, length, 6).translate(0, length / 2, 0);
    rod.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), way));
    parts.push(part(rod, KEY, [0, 0, tip]), part(new THREE.SphereGeometry(4.2, 12, 8), KEY, [x, y, tip + z]));
  }
  return merged(parts);
}

/**
 * Link by link, from the base on.
 * @param {number} tip [mm] @param {import('../link/wire.d.ts').Vec} [aside] from there [mm]
 * @returns {THREE.BufferGeometry[]}
 */
export function armGeometries(tip, aside = []) {
  return [base(), shoulder(), upperArm(), elbow(), forearm(), wrist(), flange(tip, aside)];
}
