// Which part of a recording becomes an episode: trials by their marks, and what is not known or not there.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { MASTER, bothGolden, decode, encode, folder, fresh, mark, readAll, readSet, run, writeAll } from './recordings.mjs';

let messages, like, first;
const after = (ms) => first + BigInt(Math.round(ms * 1e6));
const summary = async (out, ...files) => {
  const { code, out: text, err } = await run(out, ...files, '--json');
  return { code, err, ...JSON.parse(text || '{}') };
};
const file = (name, ...more) => writeAll(join(folder, `${name}.mcap`), [...messages, ...more]);
const marks = (...all) => all.map(([ms, text]) => mark(like, after(ms), text));
/** The golden recording with its device's or another word of /start changed. */
const changed = (topic, kind, change, list = messages) => list.map((message) => {
  if (message.topic !== topic) return message;
  const value = decode(message);
  return change(value) === false ? null : { ...message, data: encode(kind, value) };
}).filter(Boolean);

before(async () => {
  ({ messages } = await readAll(MASTER));
  like = messages.find(({ topic }) => topic === '/event');
  first = messages.find(({ topic }) => topic === '/tick').at;
});

test('each trial is an episode with its task and its result', async () => {
  const path = await file('trials', ...marks(
    [500, 'trial begins: linear-movement NV anna 1'],
    [700, 'somebody marks something'],
    [900, 'trial ends: linear-movement NV anna 1 done'],
    [1000, 'trial begins: linear-movement V anna 2 simulated'],
    [1500, 'trial ends: linear-movement V anna 2 simulated off target'],
    [1600, 'trial begins: linear-movement V anna 3 simulated practice'],
    [2000, 'trial ends: linear-movement V anna 3 simulated done'],
    [2100, 'trial begins: linear-movement NV anna 4'],
  ));
  const out = fresh();
  const said = await summary(out, path);
  assert.equal(said.code, 0);
  assert.deepEqual(said.recordings.map(({ trials, episodes, done }) => [trials, episodes, done]), [[true, 4, 2]]);
  const { episodes, frames, tasks, info } = await readSet(out);
  assert.deepEqual(tasks.map(({ task }) => task), ['linear-movement NV (simulated)', 'linear-movement V (simulated)']);
  assert.deepEqual(episodes.map((episode) => [episode['handrail/result'], episode['handrail/trial'], episode['handrail/practice'], episode['handrail/subject']]),
    [['done', 1n, false, 'anna'], ['off target', 2n, false, 'anna'], ['done', 3n, true, 'anna'], ['unfinished', 4n, false, 'anna']]);
  assert.equal(info.splits.train, '0:4');
  const begins = [500, 1000, 1600, 2100], ends = [900, 1500, 2000, null];
  let from = 0n;
  episodes.forEach((episode, i) => {
    const late = Number(episode['handrail/begins_ns'] - after(begins[i])) / 1e6;
    assert.ok(late >= 0 && late < 10, `${late} ms after its mark`);
    if (ends[i]) assert.equal(Number(episode.length), Math.floor((ends[i] - begins[i] - late) / 10) + 1);
    assert.equal(episode.dataset_from_index, from);
    from = episode.dataset_to_index;
    const own = frames.filter((frame) => frame.episode_index === BigInt(i));
    assert.equal(own.length, Number(episode.length));
    own.forEach((frame, k) => {
      assert.equal(frame.frame_index, BigInt(k));
      assert.equal(frame.timestamp, Math.fround(k / 100));
      assert.equal(tasks[Number(frame.task_index)].task, episode.tasks[0]);
      assert.equal(frame['next.done'], k === own.length - 1);
      assert.equal(frame['next.success'], k === own.length - 1 && [true, false, true, false][i]);
    });
  });
  assert.equal(Number(from), frames.length);
});

test('statistics of several episodes are those of all their frames', async () => {
  const path = await file('several', ...marks([400, 'trial begins: e m s 1'], [500, 'trial ends: e m s 1 done'], [600, 'trial begins: e m s 2'], [2500, 'trial ends: e m s 2 done']));
  const out = fresh();
  await summary(out, path);
  const { frames, stats } = await readSet(out);
  const sorted = frames.map((frame) => frame['observation.state'][0]).sort((a, b) => a - b);
  const mean = sorted.reduce((a, b) => a + b) / sorted.length;
  const std = Math.sqrt(sorted.reduce((so, x) => so + (x - mean) ** 2, 0) / sorted.length);
  const at = 0.9 * (sorted.length - 1), low = Math.floor(at);
  const expected = { min: sorted[0], max: sorted.at(-1), mean, std, q90: sorted[low] + (at - low) * (sorted[low + 1] - sorted[low]), count: sorted.length };
  for (const [name, value] of Object.entries(expected)) assert.ok(Math.abs(stats['observation.state'][name][0] - value) < 1e-12, name);
});

test('a real device is not called simulated; a simulated person or --simulated is', async () => {
  const real = changed('/start', 'RecordedStart', (start) => void (start.device.simulated = false));
  const plain = await writeAll(join(folder, '20260101T000000.000Z-master-two-words.mcap'), real);
  const trial = [mark(like, after(500), 'trial begins: e m s 1'), mark(like, after(800), 'trial ends: e m s 1 done')];
  const person = [mark(like, after(900), 'trial begins: e m s 2 simulated'), mark(like, after(1200), 'trial ends: e m s 2 simulated done')];
  const mixed = await writeAll(join(folder, 'mixed.mcap'), [...real, ...trial, ...person]);
  for (const [argv, type, tasks] of [
    [[plain], 'handrail', ['two-words']],
    [[plain, '--simulated'], 'handrail-simulated', ['two-words (simulated)']],
    [[mixed], 'handrail-partly-simulated', ['e m', 'e m (simulated)']],
  ]) {
    const said = await summary(fresh(), ...argv);
    assert.deepEqual([said.robot_type, said.tasks], [type, tasks]);
  }
});

test('several recordings become one data set, in their order', async () => {
  const other = await file('other');
  const out = fresh();
  const said = await summary(out, MASTER, other);
  assert.deepEqual(said.tasks, ['master (simulated)', 'other (simulated)']);
  const { episodes, frames } = await readSet(out);
  assert.deepEqual(episodes.map((episode) => episode['handrail/recording']), ['master.mcap', 'other.mcap']);
  assert.equal(frames.length, 2 * Number(episodes[0].length));
  frames.forEach((frame, i) => assert.equal(frame.index, BigInt(i)));
});

test('an episode ends where ticks are missing, and goes on as another', async () => {
  const gap = changed('/tick', 'RecordedTick', ({ number }) => Number(number) < 1000 || Number(number) > 1100);
  const path = await writeAll(join(folder, 'gap.mcap'), [...gap, ...marks([500, 'trial begins: e m s 1'], [2000, 'trial ends: e m s 1 done'])]);
  const out = fresh();
  const said = await summary(out, path);
  assert.equal(said.code, 1);
  assert.match(said.recordings[0].left_out[0], /trial e m s 1: .*101 ticks are missing before tick 1101/);
  const { episodes, frames } = await readSet(out);
  assert.deepEqual(episodes.map((episode) => episode['handrail/result']), ['interrupted', 'done']);
  assert.deepEqual(frames.filter((frame) => frame['next.success']).map(({ index }) => index), [BigInt(frames.length - 1)]);
});

test('a slave\'s recording that ends early ends the episode', async () => {
  const all = await bothGolden();
  const early = all.filter(({ topic, at }) => topic !== '/slave/cycle' || at < after(1500));
  const out = fresh();
  const said = await summary(out, await writeAll(join(folder, 'early.mcap'), early));
  assert.equal(said.code, 1);
  assert.match(said.recordings[0].left_out[0], /the slave's recording has a hole/);
  const { frames, episodes } = await readSet(out);
  const end = Number(episodes[0]['handrail/begins_ns'] - first) / 1e6 + (frames.length - 1) * 10;
  assert.ok(end > 1580 && end < 1605, `${end} ms`);
});

test('a wrench that is not valid is 0, and marked', async () => {
  const path = await writeAll(join(folder, 'wrench.mcap'), changed('/tick', 'RecordedTick', (tick) => {
    if (!tick.slave) return;
    if (Number(tick.number) > 1000) tick.slave.wrench_valid = false;
    if (Number(tick.number) > 2000) Object.assign(tick.slave, { wrench_valid: true, wrench: [NaN, 0, 0, 0, 0, 0] });
  }));
  const out = fresh();
  assert.equal((await summary(out, path)).code, 0);
  const { frames } = await readSet(out);
  const zero = (frame) => frame['observation.wrench'].every((value) => value === 0);
  assert.ok(!zero(frames[50]) && frames[50].wrench_valid);
  for (const at of [150, 250]) assert.ok(zero(frames[at]) && !frames[at].wrench_valid, `frame ${at}`);
});

test('a trial without a measured arm makes no episode, and is named; nothing at all makes no data set', async () => {
  const blind = (until) => changed('/tick', 'RecordedTick', (tick) => void (tick.slave && Number(tick.number) < until && (tick.slave.pose_valid = false)));
  const trial = marks([300, 'trial begins: e m s 1'], [900, 'trial ends: e m s 1 done'], [1200, 'trial begins: e m s 2'], [1500, 'trial ends: e m s 2 done']);
  const said = await summary(fresh(), await writeAll(join(folder, 'blind.mcap'), [...blind(1000), ...trial]));
  assert.deepEqual([said.code, said.episodes], [1, 1]);
  assert.match(said.recordings[0].left_out[0], /trial e m s 1: has no measured arm/);
  const none = await run(fresh(), await writeAll(join(folder, 'none.mcap'), blind(1e9)));
  assert.equal(none.code, 2);
  assert.match(none.err, /none\.mcap: no moment has a measured arm, expected one/);
});
