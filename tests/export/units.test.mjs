// What takes hours of recordings to be seen in a whole export, or is about words alone.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { Dataset } from '../../client/export/src/dataset.mjs';
import { featuresOf, widthOf } from '../../client/export/src/features.mjs';
import { Episode } from '../../client/export/src/frames.mjs';
import { TotalStats, statsOf } from '../../client/export/src/stats.mjs';
import { labelOf, trialOf } from '../../client/export/src/survey.mjs';
import { fresh, json, sql } from './recordings.mjs';

/** An episode of so many frames, each of whose numbers is `from` more than its row. */
function episodeOf(length, from) {
  const plain = Object.fromEntries(Object.entries(featuresOf(true)).map(([key, feature]) => [key, { ...feature, of: (row) => new Array(widthOf(feature)).fill(row + from) }]));
  const about = { recording: 'made', begun: 1n, result: 'done', subject: '', trial: 1, practice: false, simulated: true };
  const out = new Episode(plain, about);
  for (let row = 0; row < length; ++row) out.add(row, 'made');
  return out;
}

test('an episode goes into a new file where the last one is full, and every thousandth into a new folder', async () => {
  const out = fresh();
  mkdirSync(out);
  const set = new Dataset(out, true, 1000);
  const lengths = [3, 40, 5];
  set.add(episodeOf(lengths[0], 0), 'a');
  set.place.file = 999; // as if there were so many: the open one stays
  set.add(episodeOf(lengths[1], 100), 'b');
  set.add(episodeOf(lengths[2], 200), 'a');
  set.finish('handrail');
  for (const name of ['chunk-000/file-000', 'chunk-001/file-000', 'chunk-001/file-001']) assert.ok(existsSync(join(out, `data/${name}.parquet`)), name);
  const episodes = await sql(`select * from '${out}/meta/episodes/*/*.parquet' order by episode_index`);
  assert.deepEqual(episodes.slice(1).map((each) => [each['data/chunk_index'], each['data/file_index']]), [[1n, 0n], [1n, 1n]]);
  const rows = await sql(`select index, task_index, "observation.state"[1] as x from '${out}/data/chunk-001/*.parquet' order by index`);
  assert.deepEqual(rows.map(({ index }) => Number(index)), Array.from({ length: 45 }, (_, i) => 3 + i));
  assert.deepEqual([rows[0].x, rows.at(-1).x, rows.at(-1).task_index], [100, 204, 0n]);
  assert.equal(json(out, 'info.json').total_frames, 48);
});

test('an episode longer than a row group is whole', async () => {
  const out = fresh();
  mkdirSync(out);
  const set = new Dataset(out, true);
  set.add(episodeOf(50_003, 0), 'long');
  set.finish('handrail');
  const [{ rows, groups, wrong }] = await sql(`select (select count(*) from '${out}/data/*/*.parquet') as rows,
    (select count(distinct row_group_id) from parquet_metadata('${out}/data/chunk-000/file-000.parquet')) as groups,
    (select count(*) from '${out}/data/*/*.parquet' where "observation.state"[13] != frame_index) as wrong`);
  assert.deepEqual([rows, groups, wrong], [50_003n, 2n, 0n]);
});

test('quantiles of more frames than are kept are near, all else is exact', () => {
  const total = new TotalStats();
  let all = 0;
  for (const length of [120_001, 7, 150_000, 30_000]) {
    const values = Float64Array.from({ length }, (_, i) => ((all + i) * 7919) % 300_008);
    total.add(length, new Map([['x', { width: 1, values }]]), new Map([['x', statsOf(values, 1)]]));
    all += length;
  }
  const { min, max, mean, q10, q50, q99, count } = total.result().get('x');
  assert.deepEqual([count, min[0], max[0]], [300_008, 0, 300_007]);
  assert.ok(Math.abs(mean[0] - 150_003.5) < 1e-3);
  for (const [found, share] of [[q10, 0.1], [q50, 0.5], [q99, 0.99]]) assert.ok(Math.abs(found[0] - share * 300_007) < 300, `${found} of ${share}`);
  assert.ok(total.columns.get('x').kept.length <= 100_000 && total.columns.get('x').kept.length > 50_000);
});

test('marks of trials are understood, and others are none', () => {
  const begins = trialOf('trial begins: screw-fastening V2 anna_b 12 simulated');
  assert.deepEqual([begins.what, begins.key, begins.task, begins.simulated, begins.rest], ['begins', 'screw-fastening V2 anna_b 12', 'screw-fastening V2', true, '']);
  assert.deepEqual([trialOf('trial ends: e m s 3 time over').rest, trialOf('trial ends: e m s 3 simulated done').rest], ['time over', 'done']);
  for (const text of ['', 'half', 'trial', 'trial begins: e m s', 'trial begins: e m s x', 'a trial begins: e m s 1', 'trial goes: e m s 1']) assert.equal(trialOf(text), null, text);
});

test('the label is that of the file\'s name', () => {
  for (const [path, label] of [['/a/20261128T031234.567Z-master-core_2.mcap', 'core_2'], ['20261128T031234.567Z-master.mcap', 'recording'], ['x/both.mcap', 'both']]) {
    assert.equal(labelOf(path), label);
  }
});
