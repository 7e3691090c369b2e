// Recordings of the real programs: an experiment with a simulated person, of both sides, joined; and its numbers as
// the lab's own reader has them.
import assert from 'node:assert/strict';
import { execFile, execFileSync, spawn } from 'node:child_process';
import { existsSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { folder, fresh, readSet, run } from './recordings.mjs';

const BIN = process.env.HANDRAIL_BIN ?? fileURLToPath(new URL('../../build/release/bin', import.meta.url));
const SOCKET = join(folder, 'operator', 'operator.sock');
const READY_MS = 30_000, EXPERIMENT_MS = 300_000;
const environment = { ...process.env, HANDRAIL_KEYS: join(folder, 'keys') };
const children = [];
let master, slave, both;

const freePort = () => new Promise((resolve) => {
  const server = createServer().listen(0, '127.0.0.1', () => {
    const { port } = server.address();
    server.close(() => resolve(port));
  });
});
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

function start(name, config) {
  writeFileSync(join(folder, `${name}.cfg`), config);
  const child = spawn(join(BIN, `handrail-${name}`), ['--config', join(folder, `${name}.cfg`)], { cwd: folder, env: environment, stdio: ['ignore', 'pipe', 'pipe'] });
  children.push(child);
  return new Promise((resolve, reject) => {
    let log = '', said = '';
    const late = setTimeout(() => reject(new Error(`${name} was not ready: ${log}`)), READY_MS);
    child.stderr.on('data', (text) => (log += text));
    child.on('exit', (code) => reject(new Error(`${name} ended with ${code}: ${log}`)));
    child.stdout.on('data', (text) => {
      said += text;
      if (!/^READY.*\n/m.test(said)) return;
      clearTimeout(late);
      resolve();
    });
  });
}

const handrail = (...argv) => execFileSync(join(BIN, 'handrail'), [...argv, '--socket', SOCKET], { env: environment, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
const lab = (...argv) => execFileSync(join(BIN, 'handrail-lab'), argv, { encoding: 'utf8', maxBuffer: 1 << 28 });

before(async () => {
  const [robot, sensor] = [await freePort(), await freePort()];
  const recording = "recording { folder: 'rec' }";
  await start('rig', `robot_port: ${robot} sensor_port: ${sensor}`);
  await start('slave', `link_socket: 'link.sock' scene: 'linear-movement' robot { port: ${robot} } force_sensor { port: ${sensor} } ${recording}`);
  await start('master', `link_socket: 'link.sock' scene: 'linear-movement' operator_socket: '${SOCKET}' device { kind: PAGE } handle_sensor { simulated: true } ${recording}`);
  for (const end = Date.now() + READY_MS; Date.now() < end; await wait(100)) {
    try {
      if (handrail('status').includes('tip')) break;
    } catch {
      continue;
    }
  }
  await new Promise((resolve, reject) => {
    const argv = ['experiment', 'linear-movement', '--subject', 'made', '--trials', '1', '--simulated', '--out', join(folder, 'experiments'), '--socket', SOCKET];
    execFile(join(BIN, 'handrail'), argv, { env: environment, timeout: EXPERIMENT_MS }, (error, out, err) => (error ? reject(new Error(`experiment: ${error.message} ${out} ${err}`)) : resolve()));
  });
  try {
    handrail('record', 'stop');
  } catch {} // the experiment has ended it
  const rec = join(folder, 'rec');
  for (const end = Date.now() + READY_MS; Date.now() < end; await wait(100)) {
    const files = existsSync(rec) ? readdirSync(rec).map((name) => join(rec, name)) : [];
    const whole = (path) => readFileSync(path).subarray(-8).toString('latin1') === '\x89MCAP0\r\n';
    if (files.length !== 2 || !files.every(whole)) continue;
    [master, slave] = ['-master', '-slave'].map((side) => files.find((path) => path.includes(side)));
    break;
  }
  assert.ok(master, `two whole files, of ${existsSync(rec) ? readdirSync(rec) : 'none'}`);
  both = join(folder, 'both.mcap');
  lab('recording-join', master, slave, '--out', both);
});
after(async () => {
  for (const child of children.reverse()) {
    if (child.exitCode !== null) continue;
    const ended = new Promise((resolve) => child.on('exit', resolve));
    child.kill('SIGTERM');
    await ended;
  }
});

test('an experiment becomes episodes with tasks and results', async () => {
  const out = fresh();
  const { code, err } = await run(out, both);
  assert.ok(code === 0 || code === 1, err);
  const { episodes, frames, tasks, info } = await readSet(out);
  assert.deepEqual(info.features.action.shape, [13]);
  for (const { task } of tasks) assert.match(task, /^linear-movement (NV|V) \(simulated\)$/);
  assert.equal(tasks.length, 2);
  const done = episodes.filter((episode) => episode['handrail/result'] === 'done');
  assert.ok(done.length >= 2);
  assert.equal(frames.filter((frame) => frame['next.success']).length, done.length);
  assert.ok(episodes.every((episode) => episode['handrail/subject'] === 'made' && episode['handrail/simulated']));
  // The arm does what it is told: a measured joint is where it was sent to, within what it lags.
  for (const frame of frames) for (let i = 0; i < 6; ++i) assert.ok(Math.abs(frame.action[i] - frame['observation.state'][i]) < 0.2);
});

test('numbers are those of the lab\'s table of the same trial', async () => {
  const out = fresh();
  await run(out, master);
  const { episodes, frames } = await readSet(out);
  const episode = episodes.find((each) => each['handrail/result'] === 'done');
  const table = join(folder, 'trial.csv');
  lab('recording-csv', master, '--trial', String(episode['handrail/trial']), '--out', table);
  const [head, ...rows] = readFileSync(table, 'utf8').trim().split('\n').map((line) => line.split(','));
  const column = (name) => {
    const at = head.findIndex((each) => each === name);
    assert.ok(at >= 0, `${name} of ${head}`);
    return rows.map((row) => Number(row[at]));
  };
  const time = column(head[0]);
  const tips = ['x', 'y', 'z'].map((axis) => column(`tip_${axis}_mm`));
  const felt = ['x', 'y', 'z'].map((axis) => column(`felt_${axis}_n`));
  const own = frames.filter((frame) => frame.episode_index === episode.episode_index);
  assert.ok(own.length > 100 && own.length > 0.98 * 100 * (time.at(-1) - time[0]));
  own.forEach((frame, k) => {
    let at = 0;
    while (at + 1 < time.length && time[at + 1] - time[0] <= k / 100 + 1e-9) ++at;
    // The table's times are rounded: the tick beside is as good.
    const near = [at - 1, at, at + 1].some((row) => tips.every((tip, i) => Math.abs(tip[row] / 1000 - frame['observation.state'][6 + i]) < 2e-6));
    assert.ok(near, `frame ${k}: ${frame['observation.state'].slice(6, 9)}, table ${tips.map((tip) => tip[at])}`);
    assert.ok(frame.hand_wrench_felt_valid, `frame ${k}`);
  });
  for (const force of felt) assert.ok(force.some((value) => value !== 0)); // an empty field counts as 0
});
