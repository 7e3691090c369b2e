// Writes a LeRobotDataset v3.0: data, episodes, tasks, statistics, and what they are.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { FPS, featuresOf, widthOf } from './features.mjs';
import { STATS, TotalStats, statsOf } from './stats.mjs';
import { Table } from './table.mjs';

const VERSION = 'v3.0';
const CHUNK_FILES = 1000;
const FILE_MB = 100;
const GROUP_ROWS = 50_000; // of one row group: an episode, or eight minutes of one
const PATH = 'chunk-{chunk_index:03d}/file-{file_index:03d}.parquet';
const three = (number) => String(number).padStart(3, '0');

const PLACE_COLUMNS = [
  ['episode_index', 'int64', 0], ['tasks', 'string', 1], ['length', 'int64', 0],
  ['data/chunk_index', 'int64', 0], ['data/file_index', 'int64', 0],
  ['dataset_from_index', 'int64', 0], ['dataset_to_index', 'int64', 0],
  ['meta/episodes/chunk_index', 'int64', 0], ['meta/episodes/file_index', 'int64', 0],
  ['handrail/recording', 'string', 0], ['handrail/begins_ns', 'int64', 0], ['handrail/result', 'string', 0],
  ['handrail/subject', 'string', 0], ['handrail/trial', 'int64', 0], ['handrail/practice', 'bool', 0], ['handrail/simulated', 'bool', 0],
].map(([name, dtype, depth]) => ({ name, dtype, depth }));

/** `width` numbers a row, as rows of the feature's shape. */
function rows(feature, values, begin, end) {
  const width = widthOf(feature);
  const convert = { float32: Number, int64: BigInt, bool: Boolean }[feature.dtype];
  const shaped = (row) => {
    const all = Array.from(values.subarray(row * width, (row + 1) * width), convert);
    return shapedAs(feature, all);
  };
  return Array.from({ length: end - begin }, (_, i) => shaped(begin + i));
}

/** A scalar, a list, or a list of lists. `keep`: a scalar as a list of one, as statistics are. */
function shapedAs({ shape }, all, keep = false) {
  if (shape.length === 2) return Array.from({ length: shape[0] }, (_, i) => all.slice(i * shape[1], (i + 1) * shape[1]));
  return shape[0] === 1 && !keep ? all[0] : all;
}

const depthOf = ({ shape }, keep = false) => (shape.length === 1 && shape[0] === 1 && !keep ? 0 : shape.length);

export class Dataset {
  tasks = [];
  episodes = 0;
  frames = 0;
  place = { chunk: 0, file: 0 };
  data = null;
  totals = new TotalStats();
  episodeRows = [];

  /** A data file that has `fileBytes` takes no further episode. */
  constructor(folder, both, fileBytes = FILE_MB << 20) {
    this.folder = folder;
    this.fileBytes = fileBytes;
    this.features = featuresOf(both);
    mkdirSync(join(folder, 'meta/episodes/chunk-000'), { recursive: true });
  }

  taskIndex(task) {
    if (!this.tasks.includes(task)) this.tasks.push(task);
    return this.tasks.indexOf(task);
  }

  /** What only the data set knows of the episode. */
  number(episode, task) {
    const last = episode.length - 1;
    for (let row = 0; row <= last; ++row) {
      episode.values('timestamp')[row] = row / FPS;
      episode.values('frame_index')[row] = row;
      episode.values('index')[row] = this.frames + row;
    }
    episode.values('episode_index').fill(this.episodes);
    episode.values('task_index').fill(task);
    episode.values('next.done')[last] = 1;
    episode.values('next.success')[last] = episode.about.result === 'done' ? 1 : 0;
  }

  openData() {
    if (this.data && this.data.size() >= this.fileBytes) {
      this.data.finish();
      this.data = null;
      if (++this.place.file === CHUNK_FILES) this.place = { chunk: this.place.chunk + 1, file: 0 };
    }
    if (this.data) return;
    const folder = join(this.folder, `data/chunk-${three(this.place.chunk)}`);
    mkdirSync(folder, { recursive: true });
    this.data = new Table(join(folder, `file-${three(this.place.file)}.parquet`),
      Object.entries(this.features).map(([name, feature]) => ({ name, dtype: feature.dtype, depth: depthOf(feature) })));
  }

  /** `task`: what is to be done, in words. */
  add(episode, task) {
    this.number(episode, this.taskIndex(task));
    this.openData();
    for (let row = 0; row < episode.length; row += GROUP_ROWS) {
      const end = Math.min(row + GROUP_ROWS, episode.length);
      this.data.write(Object.entries(this.features).map(([key, feature]) => rows(feature, episode.values(key), row, end)));
    }
    const columns = new Map(Object.entries(this.features).map(([key, feature]) => [key, { width: widthOf(feature), values: episode.values(key) }]));
    const stats = new Map([...columns].map(([key, { width, values }]) => [key, statsOf(values, width)]));
    this.totals.add(episode.length, columns, stats);
    this.episodeRows.push({ ...episode.about, index: this.episodes, from: this.frames, length: episode.length, task, place: { ...this.place }, stats });
    ++this.episodes;
    this.frames += episode.length;
  }

  writeEpisodes() {
    const features = Object.entries(this.features);
    const columns = [...PLACE_COLUMNS];
    const data = this.episodeRows.map((row) => [
      BigInt(row.index), [row.task], BigInt(row.length), BigInt(row.place.chunk), BigInt(row.place.file),
      BigInt(row.from), BigInt(row.from + row.length), 0n, 0n,
      row.recording, row.begun, row.result, row.subject, BigInt(row.trial), row.practice, row.simulated,
    ]);
    for (const [key, feature] of features) {
      for (const stat of STATS) {
        columns.push({ name: `stats/${key}/${stat}`, dtype: 'float64', depth: depthOf(feature, true) });
        this.episodeRows.forEach(({ stats }, i) => data[i].push(shapedAs(feature, stats.get(key)[stat], true)));
      }
      columns.push({ name: `stats/${key}/count`, dtype: 'int64', depth: 1 });
      this.episodeRows.forEach(({ stats }, i) => data[i].push([BigInt(stats.get(key).count)]));
    }
    const table = new Table(join(this.folder, 'meta/episodes/chunk-000/file-000.parquet'), columns);
    table.write(columns.map((_, i) => data.map((row) => row[i])));
    table.finish();
  }

  // The text is the index of a pandas table: so its reader takes it.
  writeTasks() {
    const pandas = {
      index_columns: ['task'],
      column_indexes: [{ name: null, field_name: null, pandas_type: 'unicode', numpy_type: 'object', metadata: { encoding: 'UTF-8' } }],
      columns: [
        { name: 'task_index', field_name: 'task_index', pandas_type: 'int64', numpy_type: 'int64', metadata: null },
        { name: 'task', field_name: 'task', pandas_type: 'unicode', numpy_type: 'object', metadata: null },
      ],
      creator: { library: 'handrail', version: '1.0.0' },
      pandas_version: '2.2.0',
    };
    const table = new Table(join(this.folder, 'meta/tasks.parquet'),
      [{ name: 'task_index', dtype: 'int64', depth: 0 }, { name: 'task', dtype: 'string', depth: 0 }], { pandas: JSON.stringify(pandas) });
    table.write([this.tasks.map((_, i) => BigInt(i)), this.tasks]);
    table.finish();
  }

  /** Writes all that is known at the end. */
  finish(robotType) {
    this.data.finish();
    this.writeEpisodes();
    this.writeTasks();
    const json = (name, value) => writeFileSync(join(this.folder, 'meta', name), `${JSON.stringify(value, null, 4)}\n`);
    json('stats.json', Object.fromEntries([...this.totals.result()].map(([key, stats]) => [key, Object.fromEntries([
      ...STATS.map((stat) => [stat, shapedAs(this.features[key], stats[stat], true)]), ['count', [stats.count]]])])));
    json('info.json', {
      codebase_version: VERSION,
      robot_type: robotType,
      total_episodes: this.episodes,
      total_frames: this.frames,
      total_tasks: this.tasks.length,
      chunks_size: CHUNK_FILES,
      data_files_size_in_mb: FILE_MB,
      video_files_size_in_mb: 200,
      fps: FPS,
      splits: { train: `0:${this.episodes}` },
      data_path: `data/${PATH}`,
      video_path: null,
      features: Object.fromEntries(Object.entries(this.features).map(([key, { dtype, shape, names, units, about }]) => [key, { dtype, shape, names, units, about }])),
    });
  }
}
