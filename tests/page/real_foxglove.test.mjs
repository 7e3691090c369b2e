// Foxglove's own client at the real gateway, beside what the page's WebSocket says at the same time.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import WebSocket from 'ws';
import { PROTOCOLS, Viewer, until, wait } from './foxglove.mjs';
import { Programs } from './programs.mjs';

const RAD = Math.PI / 180;
const GEARS = [[-40, 47], [-40, -47], [0, 47], [0, -47], [40, 47], [40, -47]]; // as in real_walls.test.mjs
const near = (a, b, most, what) => assert.ok(Math.abs((a ?? 0) - (b ?? 0)) <= most, `${what}: ${a} and ${b}`);

/** The page's WebSocket, with the cookie that its address gives. */
class Page {
  scenes = [];
  statuses = [];
  replies = [];

  async open(url) {
    const { host } = new URL(url);
    const welcome = await fetch(url, { redirect: 'manual' });
    this.cookie = welcome.headers.get('set-cookie').split(';')[0];
    this.socket = new WebSocket(`ws://${host}/ws`, 'handrail.console.v1', { headers: { origin: `http://${host}`, cookie: this.cookie } });
    this.socket.on('message', (text) => {
      const frame = JSON.parse(text);
      if (frame.scene) this.scenes.push(frame.scene);
      if (frame.status?.status) this.statuses.push(frame.status.status);
      if (frame.reply) this.replies.push(frame.reply);
    });
    await until(() => this.scenes.length && this.statuses.length, 'the page\'s scene and status');
    return this;
  }

  say(frame) {
    this.socket.send(JSON.stringify(frame));
  }

  id = 0;

  async order(order) {
    const id = ++this.id;
    this.say(order.act ? { lead: { id, act: order.act } } : { request: { id, order } });
    return until(() => this.replies.find((reply) => reply.id === id), JSON.stringify(order));
  }

  last() {
    return this.statuses.at(-1);
  }
}

const arm = {}, walls = {};
before(async () => {
  arm.programs = await new Programs().open();
  arm.page = await new Page().open(await arm.programs.console({ more: ['--viewer-origin', 'https://app.foxglove.dev'] }));
  arm.viewer = await new Viewer().open(arm.programs.viewers);
  for (const { topic } of arm.viewer.channels) arm.viewer.subscribe(topic);
  await until(() => arm.viewer.all('/status').length > 20 && arm.viewer.all('/log').length, 'statuses');
});
after(async () => {
  for (const { viewer, page, programs } of [arm, walls]) {
    viewer?.close();
    page?.socket.close();
    await programs?.close();
  }
});

/** A status that page and viewer both had, and what else the viewer had of the same moment. */
async function same({ viewer, page }, check = () => true) {
  return until(() => {
    for (const { time, value } of viewer.all('/status').slice(-40).reverse()) {
      const told = page.statuses.find((each) => each.time_s === value.time_s);
      const at = (topic) => viewer.all(topic).find((each) => each.time === time)?.value;
      if (told && at('/tf') && check(told)) return { time, told, status: value, at };
    }
  }, 'a status that both had');
}
const child = (tf, name) => tf.transforms.find((each) => each.child_frame_id === name);
const entity = (update, id) => update.entities.find((each) => each.id === id);

test('TheServerSaysWhoItIsAndWhichChannelsItHas', () => {
  assert.equal(arm.viewer.socket.protocol, 'foxglove.sdk.v1');
  assert.match(arm.viewer.info.name, /^handrail-console /);
  assert.deepEqual(arm.viewer.info.capabilities, []);
  assert.match(arm.viewer.info.sessionId, /^\d+$/);
  const topics = Object.fromEntries(arm.viewer.channels.map(({ topic, schemaName }) => [topic, schemaName]));
  assert.deepEqual(topics, {
    '/tf': 'foxglove.FrameTransforms', '/joints': 'foxglove.JointStates', '/tip': 'foxglove.PoseInFrame',
    '/tip/desired': 'foxglove.PoseInFrame', '/cell': 'foxglove.SceneUpdate', '/marks': 'foxglove.SceneUpdate',
    '/map': 'foxglove.Grid', '/log': 'foxglove.Log', '/events': 'handrail.pb.ViewerEvent', '/status': 'handrail.pb.Status',
  });
  for (const { encoding, schemaEncoding } of arm.viewer.channels) assert.deepEqual([encoding, schemaEncoding], ['protobuf', 'protobuf']);
});

test('AStatusIsThatOfThePageNumberForNumber', async () => {
  const { told, status } = await same(arm);
  assert.equal(status.ticks.toString(), told.ticks);
  assert.deepEqual(status.joints_deg, told.joints_deg);
  assert.deepEqual(status.tip.position_mm, told.tip.position_mm);
  assert.deepEqual(status.contact_force_n, told.contact_force_n);
  assert.equal(status.device, told.device);
  assert.equal(status.gate.window_s, told.gate.window_s);
});

test('TipJointsAndFramesAreThoseOfThePage', async () => {
  const { told, at, time } = await same(arm);
  told.joints_deg.forEach((deg, i) => near(at('/joints').joints[i].position, deg * RAD, 1e-12, `J${i + 1}`));
  assert.deepEqual(at('/joints').joints.map(({ name }) => name), ['J1', 'J2', 'J3', 'J4', 'J5', 'J6']);
  const tip = at('/tip');
  assert.equal(tip.frame_id, 'base');
  assert.equal(BigInt(tip.timestamp.seconds.toString()) * 1000000000n + BigInt(tip.timestamp.nanos), time);
  assert.ok(Math.abs(Number(time / 1000000n) - Date.now()) < 60000, 'the calendar');
  for (const [axis, i] of [['x', 0], ['y', 1], ['z', 2]]) {
    near(tip.pose.position[axis], told.tip.position_mm[i] / 1000, 1e-12, axis);
    near(child(at('/tf'), 'tip').translation[axis], told.tip.position_mm[i] / 1000, 1e-12, axis);
  }
  ['w', 'x', 'y', 'z'].forEach((axis, i) => near(tip.pose.orientation[axis], told.tip.quaternion[i], 1e-12, axis));
  const names = at('/tf').transforms.map(({ child_frame_id: name }) => name);
  for (const name of ['base', 'link_1', 'link_6', 'flange', 'tip', 'device', 'hand']) assert.ok(names.includes(name), name);
});

test('TheCellIsThatOfTheScene', async () => {
  const cell = arm.viewer.last('/cell'), scene = arm.page.scenes.at(-1);
  assert.equal(entity(cell, 'goals').spheres.length, scene.goal.length);
  scene.goal.forEach((goal, i) => near(entity(cell, 'goals').spheres[i].pose.position.x, goal.position_mm[0] / 1000, 1e-12, 'goal'));
  near(entity(cell, 'arm upper').cylinders[0].size.z, scene.arm.upper_arm_mm / 1000, 1e-12, 'upper arm');
  assert.equal(arm.viewer.all('/cell').length, 1, 'once, until there is another');
});

test('ALineIsDrawnWhereItConstrainsAndEventsTellOfLeaseStopAndFault', async () => {
  const { page, viewer } = arm;
  let sequence = 0, held = true;
  const hand = setInterval(() => page.say({ hand: { sequence: String(++sequence), position_mm: [0, 0, 0], held } }), 12);
  try {
    assert.ok((await page.order({ act: 'TAKE' })).done);
    for (let i = 0; i < 6 && page.last().state !== 'engaged'; ++i) { // again, where a busy machine lets the cursor come too late
      await page.order({ reset: true });
      await page.order({ engage: true });
      await wait(300);
    }
    assert.equal(page.last().state, 'engaged');
    assert.ok((await page.order({ tool: { kind: 'LINE', direction: [0, -1, 0], one_way: true } })).done);
    const { told, at } = await same(arm, (status) => status.position_tool?.kind === 'line');
    const [arrow] = entity(at('/marks'), 'position tool').arrows;
    ['x', 'y', 'z'].forEach((axis, i) => near(arrow.pose.position[axis], told.position_tool.geometry.anchor_mm[i] / 1000, 1e-12, axis));
    const { x, y, z, w } = arrow.pose.orientation; // x turned by it is -y
    near(2 * ((x ?? 0) * (y ?? 0) + w * (z ?? 0)), -1, 1e-9, 'along -y');
    assert.equal(child(at('/tf'), 'ghost').parent_frame_id, 'base');
    near(at('/tip/desired').pose.position.x, told.desired_tip.position_mm[0] / 1000, 1e-12, 'desired');
    assert.ok((await page.order({ stop: true })).done);
    await until(() => viewer.all('/events').some(({ value }) => value.kind === 2), 'the stop');
    const said = viewer.all('/events').map(({ value }) => [value.kind ?? 0, value.value]);
    assert.ok(said.some(([kind, value]) => kind === 1 && value === 'console'), JSON.stringify(said));
    assert.ok(said.some(([kind, value]) => kind === 0 && value === 'engaged'), JSON.stringify(said));
    const log = await until(() => viewer.all('/log').find(({ value }) => value.level === 4), 'an error');
    assert.match(log.value.message, /^fault: stop was requested/);
  } finally {
    clearInterval(hand);
  }
});

test('WhatAViewerSendsIsNoOrder', async () => {
  const { viewer, page } = arm;
  viewer.said.length = 0;
  viewer.socket.send('{"request":{"id":1,"order":{"reset":true}}}');
  viewer.socket.send('{"op":"setParameters","parameters":[]}');
  viewer.client.advertise({ topic: '/order', encoding: 'json', schemaName: '' });
  viewer.client.sendMessage(1, new Uint8Array([1, 2, 3]));
  viewer.socket.send('{"op":"subscribe","subscriptions":[{"id":77,"channelId":99}]}');
  viewer.socket.send('{"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]}');
  viewer.socket.send('[');
  await until(() => viewer.said.length >= 7, 'seven statuses');
  assert.ok(viewer.said.every(({ level }) => level === 2));
  assert.match(viewer.said[4].message, /there is no channel 99/);
  assert.match(viewer.said[5].message, /used already/);
  assert.equal(page.last().state, 'fault', 'still stopped');
  const before = viewer.all('/status').length;
  await until(() => viewer.all('/status').length > before + 5, 'more');
});

test('WhatIsUnsubscribedComesNoMore', async () => {
  const other = await new Viewer().open(arm.programs.viewers, { protocols: [PROTOCOLS[1]] });
  assert.equal(other.socket.protocol, 'foxglove.websocket.v1');
  const id = other.subscribe('/joints');
  await until(() => other.all('/joints').length > 3, 'joints');
  other.client.unsubscribe(id);
  await wait(200);
  const count = other.all('/joints').length;
  await wait(300);
  assert.equal(other.all('/joints').length, count);
  assert.deepEqual(other.problems, []);
  other.close();
});

test('OnlyTheViewersAddressLetsOneInAndItOpensNothingElse', async () => {
  const { programs, page } = arm;
  const { host, origin } = new URL(programs.viewers.replace('ws:', 'http:'));
  const refused = async (url, options) => {
    const error = await new Viewer().open(url, options).then(() => null, (problem) => problem);
    return error?.message;
  };
  const key = new URL(programs.viewers).searchParams.get('key');
  assert.equal(await refused(`ws://${host}/foxglove`), '403');
  assert.equal(await refused(`ws://${host}/foxglove?key=${'0'.repeat(32)}`), '403');
  assert.equal(await refused(`ws://${host}/foxglove`, { headers: { cookie: page.cookie, origin } }), '403', 'the page\'s cookie');
  assert.equal(await refused(programs.viewers, { headers: { origin: 'https://evil.example' } }), '403');
  assert.equal(await refused(programs.viewers, { headers: { origin: 'null' } }), '403');
  assert.equal(await refused(programs.viewers, { headers: { host: 'evil.example' } }), '403');
  assert.equal(await refused(programs.viewers, { protocols: ['chat'] }), '400');
  assert.equal(await refused(`ws://${host}/ws?key=${key}`, { protocols: ['handrail.console.v1'], headers: { origin } }), '403');
  assert.equal((await fetch(`http://${host}/?key=${key}`, { redirect: 'manual' })).status, 403, 'it gives no cookie');
  const listed = await new Viewer().open(programs.viewers, { headers: { origin: 'https://app.foxglove.dev' } });
  listed.close();
});

test('AMasterThatEndsIsSaidOnceAndFoundAgain', async () => {
  const { programs, viewer } = arm;
  await programs.end('master', 'SIGKILL');
  const gone = await until(() => viewer.all('/events').find(({ value }) => value.kind === 5 && value.value === 'gone'), 'gone');
  assert.ok(gone);
  await until(() => /start handrail-master/.test(viewer.last('/log').message), 'what to do');
  await programs.start('master');
  await until(() => viewer.all('/events').some(({ value }) => value.kind === 5 && value.value === 'here'), 'here');
});

test('APaintedMapIsAGridOnceWithTheColoursOfItsPlaces', async () => {
  walls.programs = await new Programs().open({ scene: 'gearshift' });
  walls.page = await new Page().open(await walls.programs.console());
  walls.viewer = await new Viewer().open(walls.programs.viewers);
  for (const topic of ['/map', '/marks', '/tf', '/status']) walls.viewer.subscribe(topic);
  await until(() => walls.viewer.last('/map')?.frame_id === 'walls', 'the map');
  const grid = walls.viewer.last('/map');
  const { map } = walls.page.scenes.at(-1);
  const colours = (kind) => map.region.filter((each) => each.kind === kind).map(({ colour }) => colour);
  const at = (x, y) => {
    const column = Math.floor((x / 1000 - grid.pose.position.x) / grid.cell_size.x);
    const row = Math.floor((y / 1000 - grid.pose.position.y) / grid.cell_size.y);
    const from = row * grid.row_stride + column * grid.cell_stride;
    return `#${Buffer.from(grid.data.slice(from, from + 3)).toString('hex')}`;
  };
  for (const [x, y] of GEARS) assert.ok(!colours('wall').includes(at(x, y)), `${x} ${y} ${at(x, y)}`);
  assert.ok(colours('wall').includes(at(20, 40)), at(20, 40));
  near(grid.column_count * grid.cell_size.x, map.size_mm[0] / 1000, 0.001, 'width');
  const { told, at: then } = await same(walls);
  near(child(then('/tf'), 'hand').translation.x, told.hand.position_mm[0] / 1000, 1e-12, 'hand');
  assert.equal(child(then('/tf'), 'walls').parent_frame_id, 'device');
  near(entity(then('/marks'), 'proxy').spheres[0].pose.position.y, told.walls.proxy_mm[1] / 1000, 1e-12, 'proxy');
  await wait(300);
  assert.equal(walls.viewer.all('/map').length, 1);
});

test('AnotherSceneTakesAwayWhatTheFirstHadDrawn', async () => {
  const { page, viewer } = walls;
  viewer.subscribe('/cell');
  const before = viewer.all('/marks').length;
  assert.ok((await page.order({ act: 'TAKE' })).done);
  const loaded = await page.order({ scene_load: 'linear-movement' });
  assert.ok(loaded.done, loaded.reason);
  await until(() => viewer.last('/map')?.frame_id === 'world', 'no map');
  assert.deepEqual([...viewer.last('/map').data], [0, 0, 0, 0]);
  assert.ok(viewer.all('/marks').slice(before).some(({ value }) => value.deletions[0]?.type === 1), 'all of it');
  assert.ok(entity(await until(() => viewer.all('/cell').at(-1)?.value.entities.length && viewer.last('/cell'), 'the arm'), 'arm upper'));
});
