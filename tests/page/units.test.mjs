// The page's arithmetic, without a browser.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { toHand } from '../../client/console/page/src/hand/drag_tip.js';
import { toolOrder } from '../../client/console/page/src/link/tool_orders.js';
import { lieOf, toDevice, window2d } from '../../client/console/page/src/map2d/frames.js';
import { palette, recolour } from '../../client/console/page/src/map2d/recolour.js';
import { markBeside, timeText } from '../../client/console/page/src/panels/play_bar.js';
import { inverse, mountedAt, tipOf } from '../../client/console/page/src/scene3d/inverse.js';
import { rotationVector } from '../../client/console/page/src/scene3d/rotation.js';

const status = JSON.parse(readFileSync(new URL('data/status_line.json', import.meta.url), 'utf8'));
const DEG = Math.PI / 180;
const near = (a, b, most) => a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) < most, `${a} and ${b}`));

test('TheJointsOfATipAreThoseThatTheMasterMeasured', () => {
  const found = inverse(status.tip.position_mm, status.tip.quaternion, 301, [0, 0, 90, 0, 90, 0].map((deg) => deg * DEG));
  near(found.map((rad) => rad / DEG), status.joints_deg, 0.01);
});

test('TheTipOfItsJointsIsWhereItWas', () => {
  const joints = [0.4, -0.3, 1.7, 0.8, -0.9, 0.5];
  near(tipOf(status.joints_deg.map((deg) => deg * DEG), 301), status.tip.position_mm, 0.01);
  const place = tipOf(joints, 85);
  assert.ok(place.every(Number.isFinite));
});

test('AMountedTipIsTakenBackToTheFlangesAxis', () => {
  const { position_mm: p, quaternion: q } = status.tip;
  near(mountedAt(p, q, {}).p, p, 1e-9);
  near(mountedAt(p, q, {}).q, q, 1e-9);
  // Mounted by a quarter turn about x: for a tip that is not turned the flange is turned back by one.
  const half = Math.SQRT1_2, mount = { position_mm: [10, 20, 30], quaternion: [half, half, 0, 0] };
  const at = mountedAt([0, 0, 0], [1, 0, 0, 0], mount);
  near(at.q, [half, -half, 0, 0], 1e-9);
  near(at.p, [-10, -30, 20], 1e-9);
});

test('WhatIsOutOfReachHasNoJoints', () => {
  assert.equal(inverse([2000, 0, 300], [0, 0, 1, 0], 301, [0, 0, 0, 0, 0, 0]), null);
  assert.equal(inverse([NaN, 0, 300], [0, 0, 1, 0], 301, [0, 0, 0, 0, 0, 0]), null);
});

test('RightAtTheScreenIsMinusYOfTheArmAndRightOfTheHand', () => {
  const R = [0, 0, -1, -1, 0, 0, 0, 1, 0];
  near(toHand(R, [0, -1, 0]), [1, 0, 0], 1e-12);
  near(toHand(R, [0, 0, 1]), [0, 1, 0], 1e-12);
  near(toHand(R, [-1, 0, 0]), [0, 0, 1], 1e-12);
});

test('ARotationVectorGoesTheShorterWay', () => {
  const half = 10 * DEG;
  near(rotationVector([Math.cos(half), Math.sin(half), 0, 0]), [20, 0, 0], 1e-9);
  near(rotationVector([-Math.cos(half), -Math.sin(half), 0, 0]), [20, 0, 0], 1e-9);
  near(rotationVector([1, 0, 0, 0]), [0, 0, 0], 1e-12);
});

test('AStageTurnsAndMovesTheWallsInThePicture', () => {
  const lie = lieOf({ stage: [{}, { at_mm: [10, 5], turn_deg: 90 }] }, 1);
  near(toDevice(lie, [3, 0]), [10, 8], 1e-9);
  const view = window2d(lie, [100, 50], 500, 500);
  near(view.px([10, 5]), [250, 250], 1e-9);
  near(view.mm(...view.px([3, -7])), [3, -7], 1e-9);
  assert.ok(100 * view.scale < 500);
});

test('AnEdgeBetweenTwoColoursStaysBetweenThem', () => {
  const map = { region: [{ name: 'wall', kind: 'wall', colour: '#000000' }, { name: 'room', kind: 'free', colour: '#ffffff' }, { name: 'door', kind: 'wall', colour: '#ff0000' }] };
  const paint = (kind) => (kind === 'free' ? [200, 200, 200] : [100, 0, 0]);
  const pixels = new Uint8ClampedArray([0, 0, 0, 255, 255, 255, 255, 255, 128, 128, 128, 255, 255, 0, 0, 255]);
  recolour(pixels, palette(map, ['door'], paint));
  assert.deepEqual([...pixels.slice(0, 8)], [100, 0, 0, 255, 200, 200, 200, 255]);
  assert.ok(pixels[8] > 140 && pixels[8] < 160 && pixels[9] > 85 && pixels[9] < 115, `${pixels.slice(8, 12)}`);
  assert.deepEqual([...pixels.slice(12)], [200, 200, 200, 255]); // a wall that is not there in this stage
});

test('ToolsAreCalledAsTheyAreChosen', () => {
  const facts = { status, scene: { goal: [{ position_mm: [350, 37.5, 329] }] } };
  assert.deepEqual(toolOrder(facts, 'LINE', '-y', false).order.tool, { kind: 'LINE', direction: [0, -1, 0], one_way: false });
  assert.deepEqual(toolOrder(facts, 'LINE', 'goal 0', true).order.tool.end_mm, [350, 37.5, 329]);
  assert.deepEqual(toolOrder(facts, 'PLANE', 'goal 0', true).order.tool.normal, [0, 0, 1]);
  near(toolOrder(facts, 'LINE', 'tip', false).order.tool.direction, [0, 0, -1], 0.02);
  assert.match(toolOrder({ status: {}, scene: {} }, 'LINE', 'goal 3', true).refused, /no way to go/);
});

test('ATimeOfARecordingIsReadToTheMillisecond', () => {
  for (const [seconds, wanted] of [[0, '0:00.000'], [62.5, '1:02.500'], [59.9996, '1:00.000'], [3599.9999, '1:00:00.000'], [3662.001, '1:01:02.001'], [-1, '0:00.000']]) {
    assert.equal(timeText(seconds), wanted);
  }
});

test('TheMarkBesideATimeIsTheNearestThatIsNotPassedJustNow', () => {
  const marks = [{ at_s: 1 }, { at_s: 2 }, { at_s: 2 }, { at_s: 5 }, {}].sort((a, b) => (a.at_s ?? 0) - (b.at_s ?? 0));
  const cases = [[1, 0, 1], [1, 1, 2], [1, 1.9995, 5], [1, 5, undefined], [-1, 5, 2], [-1, 5.2, 2], [-1, 5.4, 5], [-1, 2.1, 1], [-1, 1, 0], [-1, 0.2, undefined]];
  for (const [way, at, wanted] of cases) assert.equal(markBeside(marks, at, way), wanted, `${way} from ${at}`);
});
