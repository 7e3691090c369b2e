// A recording of the real programs, played by `handrail play`: in the page, at Foxglove's client, and where the
// file is not whole.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { readFile, rename, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import WebSocket from 'ws';
import { launch, open, text, until as seen } from './browser.mjs';
import { Viewer, until, wait } from './foxglove.mjs';
import { BIN, Programs } from './programs.mjs';

const children = [];
let browser, programs, file;

/** What `handrail play` of that file prints, as JSON. */
const play = (path, ...more) => new Promise((resolve, reject) => {
  const child = spawn(join(BIN, 'handrail'), ['play', path, '--json', ...more], { cwd: programs.folder, env: programs.environment, stdio: ['ignore', 'pipe', 'pipe'] });
  children.push(child);
  let said = '', log = '';
  child.stderr.on('data', (each) => (log += each));
  child.stdout.on('data', (each) => {
    said += each;
    if (said.includes('\n')) resolve({ ...JSON.parse(said), child, log: () => log });
  });
  child.on('exit', (code) => reject(new Error(`ended with ${code}: ${log}`)));
});
const openPage = async (ready) => {
  const page = await open(browser, ready.url);
  await seen(page, () => !document.querySelector('#play').hidden && document.querySelector('#state').textContent !== '–');
  return page;
};
const position = (page) => page.evaluate(() => Number(document.querySelector('#play-bar').getAttribute('aria-valuenow')));
const at = (page, wanted, off = 0.002) => seen(page, ([to, most]) => Math.abs(Number(document.querySelector('#play-bar').getAttribute('aria-valuenow')) - to) <= most, [wanted, off]);
const is = (page, id, wanted) => seen(page, ([node, value]) => new RegExp(value).test(document.getElementById(node).textContent), [id, wanted]);

/** A recording of an arm that is led on a line and stopped, with two marks. */
before(async () => {
  browser = await launch();
  programs = await new Programs().open();
  for (const name of ['master', 'slave']) await programs.end(name);
  for (const name of ['slave', 'master']) {
    const config = (await readFile(join(programs.folder, `${name}.cfg`), 'utf8')).replace('device { kind: PAGE }', 'device { kind: SIM_OMNI }');
    await programs.start(name, `${config} recording { folder: 'rec' }`);
  }
  const handrail = (...argv) => programs.handrail(...argv, '--socket', programs.socket);
  await until(() => {
    try {
      return handrail('status').includes('tip');
    } catch {
      return false;
    }
  }, 'a slave with an arm');
  handrail('record', 'start', 'small');
  await wait(500);
  await until(() => {
    try {
      handrail('engage');
      return true;
    } catch { // a busy machine: the link is not good enough yet
      return false;
    }
  }, 'engaged');
  handrail('record', 'mark', 'engaged now');
  handrail('tool', 'line', '--dir', 'y');
  handrail('hand', 'to', '--by', '10,0,0', '--seconds', '1');
  await wait(1500);
  handrail('record', 'mark', 'moved');
  await wait(300);
  handrail('stop');
  await wait(500);
  handrail('record', 'stop');
  const folder = join(programs.folder, 'rec');
  const whole = (path) => readFileSync(path).subarray(-8).toString('latin1') === '\x89MCAP0\r\n';
  file = await until(() => existsSync(folder) && readdirSync(folder).map((name) => join(folder, name)).find((path) => path.includes('-master-small') && whole(path)), 'a whole file');
});
after(async () => {
  for (const child of children) child.kill();
  await browser.close();
  await programs.close();
});

test('ThePageShowsTheRecordingAsOneAndNoOrderPasses', async () => {
  const ready = await play(file);
  assert.ok(ready.recording.length_s > 2);
  const page = await openPage(ready);
  assert.match(await page.title(), /^Recording .*-master-small\.mcap/);
  assert.equal(await page.locator('#recording-sign').isVisible(), true);
  assert.equal(await page.locator('#stop').isVisible(), false);
  for (const id of ['leader', 'lease', 'age', 'lead-take', 'scene-load']) assert.equal(await page.locator(`#${id}`).isVisible(), false, id);
  for (const key of ['Escape', 'Space']) {
    await page.keyboard.press(key);
    await is(page, 'said', 'stop refused: this is a recording');
    await page.evaluate(() => (document.getElementById('said').textContent = ''));
  }
  for (const key of ['e', 'd', 'c', 'r', 'l', 'x']) {
    await page.keyboard.press(key);
    await is(page, 'said', 'this is a recording: no order can be given');
    await page.evaluate(() => (document.getElementById('said').textContent = ''));
  }
  await page.keyboard.press('Shift');
  await is(page, 'said', 'this is a recording');
  assert.equal(await text(page, 'hold'), 'hand free');
  assert.equal(await page.locator('[data-order="engage"]').isDisabled(), true);
  // A page of an older version, or of somebody's own, is refused as well.
  const { host } = new URL(ready.url);
  const cookie = (await page.context().cookies()).map(({ name, value }) => `${name}=${value}`).join('; ');
  const socket = new WebSocket(`ws://${host}/ws`, 'handrail.console.v1', { headers: { origin: `http://${host}`, cookie } });
  const replies = [];
  socket.on('message', (each) => {
    const { reply } = JSON.parse(each);
    if (reply) replies.push(reply);
  });
  await new Promise((resolve) => socket.on('open', resolve));
  for (const frame of [{ request: { id: 1, order: { engage: true } } }, { request: { id: 2, order: { stop: true } } }, { lead: { id: 3, act: 'TAKE' } }, { lead: { id: 4, act: 'TAKE_OVER' } }, { play: { id: 5, speed: 11 } }, { play: { id: 6, position_s: 'NaN' } }]) socket.send(JSON.stringify(frame));
  socket.send(JSON.stringify({ hand: { sequence: '1', position_mm: [0, 0, 0], held: true } }));
  await until(() => replies.length === 6, 'six replies');
  assert.ok(replies.every(({ done }) => !done), JSON.stringify(replies));
  for (const { reason } of replies.slice(0, 4)) assert.match(reason, /this is a recording: no order can be given/);
  assert.match(replies[4].reason, /speed: 11\.0+, expected 0\.1 to 10/);
  assert.match(replies[5].reason, /position_s: nan, expected seconds/);
  socket.close();
  assert.deepEqual(page.faults, []);
  assert.deepEqual(page.violations, []);
  await page.context().close();
});

test('TheBarPlaysSeeksAndGoesToMarksByMouseAndKeys', async () => {
  const ready = await play(file);
  const { length_s: length, mark: marks } = ready.recording;
  assert.deepEqual(marks.map(({ kind = 'MARK', text: said }) => [kind, said]).filter(([kind, said]) => kind !== 'MARK' || said !== 'recording'), [['MARK', 'engaged now'], ['MARK', 'moved'], ['STOP', 'a stop was latched']]);
  const page = await openPage(ready);
  assert.equal(await position(page), 0);
  assert.equal(await text(page, 'play-word'), 'Play');
  const ticks = () => page.evaluate(() => document.querySelector('#play-now').textContent);
  const still = await ticks();
  await page.waitForTimeout(300);
  assert.equal(await ticks(), still, 'it begins paused');
  // Keys.
  await page.keyboard.press('k');
  await seen(page, () => Number(document.querySelector('#play-bar').getAttribute('aria-valuenow')) > 0.3);
  await page.keyboard.press('k');
  await is(page, 'play-word', 'Play');
  await page.keyboard.press('Home');
  await at(page, 0);
  await page.keyboard.press('End');
  await at(page, length);
  for (const mark of [...marks].reverse()) {
    if (mark.at_s > length - 0.31) continue;
    await page.keyboard.press('[');
    await at(page, mark.at_s);
  }
  const [first] = marks.filter(({ text: said }) => said === 'engaged now');
  await page.keyboard.press('Home');
  await at(page, 0);
  for (const mark of marks.filter(({ at_s: when }) => when > 1e-3)) {
    await page.keyboard.press(']');
    await at(page, mark.at_s);
  }
  await page.keyboard.press('ArrowLeft');
  await at(page, 0);
  await page.keyboard.press('.');
  await at(page, 0.1);
  await page.keyboard.press('=');
  await seen(page, () => document.querySelector('#play-speed').value === '2');
  await page.keyboard.press('-');
  await page.keyboard.press('-');
  await seen(page, () => document.querySelector('#play-speed').value === '0.5');
  // The mouse: to a place, dragged on, and onto a mark.
  const { x, y, width, height } = await page.locator('#play-bar').boundingBox();
  await page.mouse.click(x + 0.25 * width, y + height / 2);
  await at(page, 0.25 * length, length / width);
  await page.mouse.move(x + 0.3 * width, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + 0.7 * width, y + height / 2, { steps: 10 });
  await page.mouse.up();
  await at(page, 0.7 * length, length / width);
  await page.locator('.play-mark[title*="engaged now"]').click();
  await at(page, first.at_s);
  await page.locator('#play-speed').selectOption('10');
  await page.locator('#play-toggle').click();
  await is(page, 'play-word', 'Again');
  await at(page, length);
  await is(page, 'state', 'fault');
  assert.deepEqual(page.faults, []);
  await page.context().close();
});

test('WhatIsShownOfAMomentIsWhatWasRecordedThenPlayedOrSought', async () => {
  const ready = await play(file);
  const table = join(programs.folder, 'table.csv');
  execFileSync(join(BIN, 'handrail-lab'), ['recording-csv', file, '--out', table], { stdio: 'ignore' });
  const [head, ...rows] = readFileSync(table, 'utf8').trim().split('\n').map((line) => line.split(','));
  const column = (name) => head.indexOf(name);
  const viewer = await new Viewer().open(ready.viewers);
  viewer.subscribe('/status');
  const from = BigInt(viewer.info.dataStartTime.sec) * 1000000000n + BigInt(viewer.info.dataStartTime.nsec);
  const request = playbackRequest;
  let compared = 0;
  const compare = ({ value }) => {
    if (!value.tip) return; // a recording begins before a slave was heard
    ++compared;
    const row = rows.find((each) => Math.abs(Number(each[0]) - (value.time_s - Number(rows.zero))) < 2e-6);
    assert.ok(row, `no row of ${value.time_s}`);
    for (const [name, is] of [['tip_y_mm', value.tip.position_mm[1]], ['hand_x_mm', value.hand.position_mm[0]], ['force_y_n', value.device_force.force_n[1]]]) {
      assert.ok(Math.abs(Number(row[column(name)]) - is) < 1e-6, `${name} at ${value.time_s}: ${row[column(name)]} and ${is}`);
    }
  };
  viewer.socket.send(request({ play: false, seek: from, id: 'zero' }));
  await until(() => viewer.states.some(({ id }) => id === 'zero'), 'the answer');
  rows.zero = (await until(() => viewer.all('/status').at(-1), 'a status')).value.time_s;
  const played = [];
  viewer.socket.send(request({ play: true, speed: 1, id: 'go' }));
  await until(() => viewer.states.at(-1)?.is === 3, 'the end');
  const all = viewer.all('/status').slice();
  assert.ok(all.length > 60, `${all.length} statuses`);
  for (const each of all) compare(each);
  assert.ok(compared > 60, `${compared} with an arm`);
  for (let i = 0; i < 20; ++i) {
    const { time, value } = all[(i * 7919) % all.length];
    viewer.socket.send(request({ play: false, seek: time, id: `to ${i}` }));
    await until(() => viewer.states.some(({ id }) => id === `to ${i}`), 'the answer');
    const again = await until(() => viewer.all('/status').at(-1).time === time && viewer.all('/status').at(-1), 'that moment');
    assert.deepEqual(JSON.parse(JSON.stringify(again.value)), JSON.parse(JSON.stringify(value)));
    played.push(again);
  }
  viewer.close();
});

/** As Foxglove's SDK reads one: opcode, command, speed, whether it seeks, to when, the length of its id, the id. */
function playbackRequest({ play: plays, speed = 1, seek, id = 'x' }) {
  const bytes = new DataView(new ArrayBuffer(19 + id.length));
  bytes.setUint8(0, 3);
  bytes.setUint8(1, plays ? 0 : 1);
  bytes.setFloat32(2, speed, true);
  bytes.setUint8(6, seek === undefined ? 0 : 1);
  bytes.setBigUint64(7, seek ?? 0n, true);
  bytes.setUint32(15, id.length, true);
  [...id].forEach((letter, i) => bytes.setUint8(19 + i, letter.charCodeAt(0)));
  return bytes.buffer;
}

test('OfWallsTheLeverItsPlaceAndTheForceAreShown', async () => {
  const walls = await new Programs().open({ scene: 'gearshift' });
  try {
    await walls.end('master');
    const config = (await walls.config('master')).replace('device { kind: PAGE }', 'device { kind: SIM_JOYSTICK }');
    await walls.start('master', `${config} recording { folder: 'rec' }`);
    const handrail = (...argv) => walls.handrail(...argv, '--socket', walls.socket);
    const to = async (by) => {
      handrail('hand', 'to', '--by', by, '--seconds', '0.5');
      await until(() => !JSON.parse(handrail('status', '--json')).hand_moving, 'the hand rests');
      await wait(300);
    };
    handrail('record', 'start', 'gears');
    await to('40,0,0');
    await to('0,50,0');
    handrail('record', 'mark', 'fifth');
    await wait(200);
    await to('20,0,0');
    handrail('record', 'mark', 'wall');
    await wait(200);
    handrail('record', 'stop');
    const folder = join(walls.folder, 'rec');
    const whole = (path) => readFileSync(path).subarray(-8).toString('latin1') === '\x89MCAP0\r\n';
    const gears = await until(() => existsSync(folder) && readdirSync(folder).map((name) => join(folder, name)).find((path) => path.includes('-master-gears') && whole(path)), 'a whole file');
    const ready = await play(gears);
    const page = await openPage(ready);
    assert.equal(await page.locator('#frame2d').isVisible(), true);
    await page.locator('.play-mark[title*="fifth"]').click();
    await is(page, 'place', '^5$');
    assert.equal(await text(page, 'place-what'), 'locked');
    assert.equal(await text(page, 'key-ring'), 'hand');
    await page.locator('.play-mark[title*="wall"]').click();
    const table = join(walls.folder, 'gears.csv');
    execFileSync(join(BIN, 'handrail-lab'), ['recording-csv', gears, '--out', table], { stdio: 'ignore' });
    const [head, ...rows] = readFileSync(table, 'utf8').trim().split('\n').map((line) => line.split(','));
    const mark = ready.recording.mark.find(({ text: said }) => said === 'wall').at_s;
    const row = rows.filter(([t]) => Number(t) <= mark + 1e-6).at(-1);
    const of = (name) => Number(row[head.indexOf(name)]);
    const force = Math.hypot(of('force_x_n'), of('force_y_n'));
    const into = Math.hypot(of('wall_hand_x_mm') - of('proxy_x_mm'), of('wall_hand_y_mm') - of('proxy_y_mm'));
    assert.ok(force > 1 && into > 0.2, `${force} N, ${into} mm into the wall`);
    await seen(page, ([id, value]) => Math.abs(Number(document.getElementById(id).textContent) - value) < 0.006, ['force-now', force]);
    await seen(page, ([id, value]) => Math.abs(Number(document.getElementById(id).textContent) - value) < 0.06, ['error-now', into]);
    assert.deepEqual(page.faults, []);
    await page.context().close();
  } finally {
    await walls.close();
  }
});

test('AViewerPlaysPausesAndSeeksWithFoxglovesMessagesForAllWhoLook', async () => {
  const ready = await play(file);
  const [one, other] = [await new Viewer().open(ready.viewers), await new Viewer().open(ready.viewers)];
  const { dataStartTime: begin, dataEndTime: end, capabilities } = one.info;
  assert.deepEqual(capabilities, ['time', 'playbackControl']);
  assert.match(one.info.name, /a recording$/);
  const nanos = ({ sec, nsec }) => BigInt(sec) * 1000000000n + BigInt(nsec);
  assert.ok(Math.abs(Number(nanos(end) - nanos(begin)) / 1e9 - ready.recording.length_s) < 1e-6);
  await until(() => one.states.length === 1 && other.states.length === 1, 'how it stands');
  assert.deepEqual([one.states[0].is, one.states[0].speed, one.states[0].now], [1, 1, nanos(begin)]);
  for (const topic of ['/tf', '/cell', '/tip', '/log']) one.subscribe(topic);
  await until(() => one.last('/tf') && one.last('/cell'), 'frames');
  assert.equal(one.all('/tf').at(-1).time, nanos(begin), 'a message has the time of the recording');
  const middle = (nanos(begin) + nanos(end)) / 2n;
  one.socket.send(playbackRequest({ play: false, speed: 2, seek: middle, id: 'there' }));
  const mine = await until(() => one.states.find(({ id }) => id === 'there'), 'the answer');
  assert.deepEqual(mine, { is: 1, now: middle, speed: 2, sought: true, id: 'there' });
  const theirs = await until(() => other.states.find(({ sought }) => sought), 'what the other is told');
  assert.deepEqual(theirs, { ...mine, id: '' });
  await until(() => one.times.at(-1) === middle, 'the time');
  await until(() => one.all('/cell').length === 2, 'what is the same is said again after a seek');
  other.socket.send(playbackRequest({ play: true, speed: 1, id: 'go' }));
  await until(() => one.states.some(({ is }) => is === 0), 'playing');
  const times = one.times.length;
  await until(() => one.times.length > times + 20, 'times');
  const told = one.times.slice(times);
  assert.ok(told.every((time, i) => i === 0 || time >= told[i - 1]), 'forward');
  await until(() => one.states.at(-1).is === 3 && one.states.at(-1).now === nanos(end), 'the end');
  // A speed of the viewer's own becomes the nearest of ours, and a time beyond the end the end.
  one.socket.send(playbackRequest({ play: false, speed: 0.01, seek: nanos(end) + 5000000000n, id: 'slow' }));
  const slow = await until(() => one.states.find(({ id }) => id === 'slow'), 'the answer');
  assert.ok(Math.abs(slow.speed - 0.1) < 1e-6);
  assert.equal(slow.now, nanos(end));
  // What is none.
  one.said.length = 0;
  const bad = playbackRequest({ play: true, id: 'abc' });
  one.socket.send(bad.slice(0, 10));
  new DataView(bad).setUint8(1, 9);
  one.socket.send(bad);
  one.socket.send(playbackRequest({ play: true, speed: NaN, id: 'nan' }));
  one.socket.send(new Uint8Array([1, 0, 0, 0, 0, 1]));
  await until(() => one.said.length === 4, 'four errors');
  assert.deepEqual(one.said.map(({ level }) => level), [2, 2, 2, 2]);
  assert.match(one.said[0].message, /not whole/);
  assert.match(one.said[1].message, /command 9, expected 0, play, or 1, pause/);
  assert.match(one.said[3].message, /opcode 1, expected 3/);
  for (const viewer of [one, other]) viewer.close();
});

test('AFileThatIsCutGoesOrIsNoneSaysWhatWhereAndWhy', async () => {
  const cut = join(programs.folder, 'cut.mcap');
  const bytes = await readFile(file);
  await writeFile(cut, bytes.subarray(0, Math.floor(bytes.length * 0.6)));
  const ready = await play(cut);
  const whole = await play(file);
  assert.match(ready.recording.damage, /^byte \d+: the file is cut within a record/);
  assert.ok(ready.recording.length_s > 0.3 * whole.recording.length_s && ready.recording.length_s < whole.recording.length_s);
  assert.match(ready.log(), /cut\.mcap: byte \d+: .*it is shown up to there/);
  const page = await openPage(ready);
  await is(page, 'notice-text', 'This recording is not whole: byte \\d+.*It is shown up to there');
  await rename(cut, `${cut}.moved`);
  await page.keyboard.press('End');
  await at(page, ready.recording.length_s);
  assert.equal(await text(page, 'state'), 'engaged', 'it is read on');
  await writeFile(`${cut}.moved`, bytes.subarray(0, 2000));
  await page.keyboard.press('Home');
  await page.keyboard.press('.');
  await is(page, 'notice-text', 'cut\\.mcap: byte \\d+: the file ends here, and had \\d+ bytes when it was opened');
  await page.context().close();
  const { port } = new URL(whole.url);
  const refused = (path, ...more) => new Promise((resolve) => play(path, ...more).then(() => resolve('it opened'), (error) => resolve(error.message)));
  assert.match(await refused(file, '--listen', `127.0.0.1:${port}`), /ended with 2: handrail-console: .*in use/);
  assert.match(await refused(join(programs.folder, 'master.cfg')), /ended with 2: handrail-console: .*master\.cfg: byte 0: begins with .*expected 89 4d 43 41 50/);
  assert.match(await refused(join(programs.folder, 'none.mcap')), /none\.mcap: cannot be read: No such file/);
  assert.match(await refused(file, '--listen', '127.0.0.1:http'), /--listen .*127.0.0.1:http/);
});
