// The data set of golden recordings: as the format has it, and each number as the recording has it.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { MASTER, bothGolden, decode, folder, fresh, json, readAll, readSet, run, sql, writeAll } from './recordings.mjs';

const f32 = Math.fround;
const DEFAULTS = { timestamp: 'float32', frame_index: 'int64', episode_index: 'int64', index: 'int64', task_index: 'int64' };
const STATS = ['min', 'max', 'mean', 'std', 'count', 'q01', 'q10', 'q50', 'q90', 'q99'];
const DUCK = { float32: 'FLOAT', int64: 'BIGINT', bool: 'BOOLEAN' };
let master, both, outMaster, outBoth, messages;

before(async () => {
  outMaster = fresh();
  outBoth = fresh();
  const path = await writeAll(join(folder, 'both.mcap'), await bothGolden());
  for (const [out, file] of [[outMaster, MASTER], [outBoth, path]]) {
    const { code, err } = await run(out, file);
    assert.deepEqual([code, err], [0, '']);
  }
  master = await readSet(outMaster);
  both = await readSet(outBoth);
  messages = (await readAll(path)).messages.map((message) => ({ ...message, topic: message.topic }));
});

test('meta/info.json has what readers ask for', () => {
  for (const { info, frames, episodes, tasks } of [master, both]) {
    assert.equal(info.codebase_version, 'v3.0');
    assert.equal(info.fps, 100);
    assert.equal(info.chunks_size, 1000);
    assert.equal(info.data_files_size_in_mb, 100);
    assert.equal(info.video_files_size_in_mb, 200);
    assert.equal(info.video_path, null);
    assert.equal(info.data_path, 'data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet');
    assert.deepEqual(info.splits, { train: `0:${episodes.length}` });
    assert.deepEqual([info.total_frames, info.total_episodes, info.total_tasks], [frames.length, episodes.length, tasks.length]);
    assert.equal(info.robot_type, 'handrail-simulated');
    for (const [key, dtype] of Object.entries(DEFAULTS)) {
      assert.equal(info.features[key].dtype, dtype);
      assert.deepEqual(info.features[key].shape, [1]);
    }
    assert.ok(Object.keys(info.features).every((key) => !key.includes('/')));
    for (const [key, { shape, names, units }] of Object.entries(info.features)) {
      assert.equal(units.length, shape.at(-1), key);
      if (shape.length === 1 && shape[0] > 1) assert.equal(names.length, shape[0], key);
      if (shape.length === 2) assert.equal(names.length, 2, key);
    }
  }
  assert.deepEqual(master.info.features.action.shape, [7]);
  assert.deepEqual(both.info.features.action.shape, [13]);
  assert.deepEqual(both.info.features['observation.wrench_window'].shape, [10, 6]);
});

test('columns of the data are the features, of their type and shape, packed with snappy', async () => {
  const file = `${outBoth}/data/chunk-000/file-000.parquet`;
  const columns = await sql(`describe select * from '${file}'`);
  const { features } = both.info;
  assert.deepEqual(columns.map(({ column_name: name }) => name), Object.keys(features));
  for (const { column_name: name, column_type: type } of columns) {
    const { dtype, shape } = features[name];
    const lists = shape.length === 1 && shape[0] === 1 ? '' : '[]'.repeat(shape.length);
    assert.equal(type, DUCK[dtype] + lists, name);
  }
  for (const frame of both.frames) {
    for (const [key, { shape }] of Object.entries(features)) {
      if (shape.length === 2) assert.ok(frame[key].length === shape[0] && frame[key].every((row) => row.length === shape[1]), key);
      else if (shape[0] > 1) assert.equal(frame[key].length, shape[0], key);
    }
  }
  assert.deepEqual(await sql(`select distinct compression from parquet_metadata('${file}')`), [{ compression: 'SNAPPY' }]);
});

test('frames are numbered, and their times are those of 100 fps', () => {
  for (const { frames, episodes } of [master, both]) {
    frames.forEach((frame, i) => {
      assert.equal(frame.index, BigInt(i));
      assert.equal(frame.frame_index, BigInt(i));
      assert.equal(frame.timestamp, f32(i / 100));
      assert.equal(frame['next.done'], i === frames.length - 1);
      assert.equal(frame['next.success'], false);
    });
    assert.deepEqual([episodes[0].length, episodes[0].dataset_from_index, episodes[0].dataset_to_index], [BigInt(frames.length), 0n, BigInt(frames.length)]);
  }
});

/** The newest of entries {at} at a moment, else the oldest. */
const newest = (entries, at) => entries.reduce((found, entry) => (entry.at <= at ? entry : found), entries[0]);

/** Compares each frame with what the messages have at its time. */
function compare(set, side) {
  const of = (name) => messages.filter(({ topic }) => topic === name).map((message) => ({ at: message.at, value: decode(message) }));
  const ticks = of('/master/tick'), cycles = of('/slave/cycle');
  let last = null;
  for (const tick of ticks) {
    if (tick.value.slave) last = { at: tick.at, value: tick.value.slave };
    tick.slave = last;
  }
  const heard = side === 'both' ? cycles.map(({ at, value }) => ({ at, value: value.state })) : ticks.filter(({ value }) => value.slave).map(({ at, value }) => ({ at, value: value.slave }));
  const first = ticks.find((tick) => tick.value.slave_known && newest(heard, tick.at)?.value.pose_valid && newest(heard, tick.at).at <= tick.at);
  assert.equal(set.frames.length, Number((ticks.at(-1).at - first.at) / 10_000_000n) + 1);
  assert.equal(set.episodes[0]['handrail/begins_ns'], first.at);
  const floats = (values) => values.map(f32);
  const wrench = (at) => floats(newest(heard, at).value.wrench);
  set.frames.forEach((frame, k) => {
    const at = first.at + BigInt(k) * 10_000_000n;
    const { value: tick } = newest(ticks, at);
    const { value: state } = newest(heard, at);
    const { command } = tick;
    assert.deepEqual(frame['observation.state'], floats([...state.joints, ...state.measured_pose]));
    assert.deepEqual(frame['observation.wrench'], wrench(at));
    assert.deepEqual(frame['observation.wrench_window'], Array.from({ length: 10 }, (_, i) => wrench(at - BigInt(9 - i) * 1_000_000n)));
    const action = floats(command.command_valid ? command.command_pose : state.command_pose);
    assert.deepEqual(frame.action, side === 'both' ? [...floats(newest(cycles, at).value.q_target), ...action] : action);
    const none = new Array(11).fill(0);
    assert.deepEqual(frame['observation.environment_state'], floats([
      command.position_kind, ...(command.position_kind ? command.position_geometry : none),
      command.orientation_kind, ...(command.orientation_kind ? command.orientation_geometry : none)]));
    assert.deepEqual(frame['tool.kinds'], [BigInt(command.position_kind), BigInt(command.orientation_kind)]);
    assert.deepEqual(frame['tool.ids'], [BigInt(command.position_id), BigInt(command.orientation_id)]);
    assert.equal(frame.reason, BigInt(tick.reason));
    assert.equal(frame.session_state, BigInt(command.state));
    assert.deepEqual(frame.stage_offsets, floats(tick.motion));
    const ages = [tick.slave_age_ns, tick.link.loop_age_ns, tick.link.peer_age_ns].map((ns) => f32(Math.min(Number(ns) / 1e9, 1000)));
    assert.deepEqual(frame.link_age, ages);
    assert.equal(frame.energy_margin, f32(0 - tick.energy_made));
    assert.deepEqual(frame.hand_wrench, floats(tick.wrench));
    assert.deepEqual(frame.hand_wrench_felt, floats(tick.handle?.length ? tick.handle : new Array(6).fill(0)));
    assert.equal(frame.hand_wrench_felt_valid, Boolean(tick.handle?.length));
    assert.deepEqual([frame.command_valid, frame.pose_valid, frame.wrench_valid, frame.payload_removed],
      [command.command_valid, state.pose_valid, state.wrench_valid, state.payload_removed]);
  });
}

test('of a master alone each number is that of the newest tick, and of the newest state in ticks', () => compare(master, 'master'));
test('of both sides the arm is that of the slave\'s newest cycle', () => compare(both, 'both'));

test('the recording has what would show columns that are mixed up', () => {
  const different = (key) => new Set(both.frames.map((frame) => String(frame[key]))).size;
  for (const key of ['observation.state', 'observation.wrench', 'action', 'tool.kinds', 'tool.ids', 'reason', 'session_state', 'stage_offsets', 'link_age', 'hand_wrench', 'command_valid']) {
    assert.ok(different(key) > 1, key);
  }
});

test('meta/tasks.parquet is a pandas table whose index is the task', async () => {
  assert.deepEqual(master.tasks, [{ task_index: 0n, task: 'master (simulated)' }]);
  const [{ value }] = await sql(`select decode(value) as value from parquet_kv_metadata('${outMaster}/meta/tasks.parquet') where decode(key) = 'pandas'`);
  const pandas = JSON.parse(value);
  assert.deepEqual(pandas.index_columns, ['task']);
  assert.deepEqual(pandas.columns.map(({ field_name: name }) => name), ['task_index', 'task']);
});

/** A column of a data set in SQL, one number of it. */
const part = (key, shape, i) => {
  if (shape.length === 2) return `"${key}"[${Math.floor(i / shape[1]) + 1}][${(i % shape[1]) + 1}]`;
  return shape[0] === 1 ? `"${key}"::double` : `"${key}"[${i + 1}]`;
};

test('statistics are those that DuckDB makes of the data', async () => {
  for (const [key, { shape, dtype }] of Object.entries(both.info.features)) {
    const width = shape.reduce((a, b) => a * b);
    const stats = both.stats[key];
    assert.deepEqual(Object.keys(stats).sort(), [...STATS].sort(), key);
    assert.deepEqual(stats.count, [both.frames.length]);
    const flat = Object.fromEntries(Object.entries(stats).map(([name, values]) => [name, values.flat(3)]));
    if (shape.length === 2) assert.deepEqual([stats.mean.length, stats.mean[0].length], shape);
    for (const i of new Set([0, width >> 1, width - 1])) {
      const column = dtype === 'bool' ? `(${part(key, shape, i)})::int::double` : `(${part(key, shape, i)})::double`;
      const [made] = await sql(`select min(x) as min, max(x) as max, avg(x) as mean, stddev_pop(x) as std, quantile_cont(x, 0.01) as q01,
        quantile_cont(x, 0.1) as q10, quantile_cont(x, 0.5) as q50, quantile_cont(x, 0.9) as q90, quantile_cont(x, 0.99) as q99
        from (select ${column} as x from '${outBoth}/data/*/*.parquet')`);
      for (const [name, value] of Object.entries(made)) {
        assert.ok(Math.abs(flat[name][i] - value) <= 1e-9 * Math.max(1, Math.abs(value)), `${key}[${i}] ${name}: ${flat[name][i]}, DuckDB ${value}`);
      }
    }
  }
});

test('meta/episodes says where each episode is, and its statistics', () => {
  for (const { episodes, info, stats } of [master, both]) {
    const [episode] = episodes;
    assert.equal(episode.episode_index, 0n);
    assert.equal(episode.tasks.length, 1);
    for (const name of ['data/chunk_index', 'data/file_index', 'meta/episodes/chunk_index', 'meta/episodes/file_index']) assert.equal(episode[name], 0n, name);
    for (const key of Object.keys(info.features)) {
      for (const stat of STATS) {
        const number = (value) => (Array.isArray(value) ? value.map(number) : Number(value));
        const near = (a, b) => a.flat(3).every((value, i) => Math.abs(value - b.flat(3)[i]) <= 1e-9 * Math.max(1, Math.abs(value)));
        assert.ok(near(number(episode[`stats/${key}/${stat}`]), stats[key][stat]), `${key} ${stat}`);
      }
    }
    assert.equal(episode['handrail/result'], 'unknown');
    assert.equal(episode['handrail/simulated'], true);
  }
});

test('--json says the same as the files, and nothing else is printed', async () => {
  const out = fresh();
  const { code, out: text, err } = await run(out, MASTER, '--json');
  assert.equal(code, 0);
  assert.equal(err, '');
  const summary = JSON.parse(text);
  assert.equal(summary.frames, json(out, 'info.json').total_frames);
  assert.equal(summary.recordings[0].trials, false);
  assert.equal(summary.out, out);
  assert.ok(!existsSync(`${out}.part`));
});

test('two exports of a recording are the same, byte by byte', async () => {
  const out = fresh();
  await run(out, MASTER);
  for (const name of ['data/chunk-000/file-000.parquet', 'meta/episodes/chunk-000/file-000.parquet', 'meta/info.json', 'meta/stats.json', 'meta/tasks.parquet']) {
    assert.ok(readFileSync(join(out, name)).equals(readFileSync(join(outMaster, name))), name);
  }
});
