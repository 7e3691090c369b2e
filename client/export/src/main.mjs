// client/export/lerobot OUT RECORDING...: the words, what is said, and that nothing half-written stays.
import { existsSync, lstatSync, mkdirSync, realpathSync, renameSync, rmSync } from 'node:fs';
import { dirname, resolve } from 'node:path';
import { Dataset } from './dataset.mjs';
import { FPS } from './features.mjs';
import { readFrames } from './frames.mjs';
import { ExportError } from './recording.mjs';
import { survey } from './survey.mjs';

const HELP = `lerobot OUT RECORDING... [--json] [--simulated]
makes a LeRobotDataset v3.0 in the folder OUT, which must not exist yet, of recordings of masters, or of
both sides as one (handrail-lab recording-join MASTER SLAVE --out BOTH.mcap)
  --json        print the summary as JSON
  --simulated   label all as simulated, as where the arm is the simulated rig and the device is not
exit codes: 0 done; 1 done, but of what a file has something is not there; 2 nothing was made; 130 interrupted`;
const DONE = 0, PARTLY = 1, NOTHING = 2, INTERRUPTED = 130, TERMINATED = 143;
const PROGRESS_MS = 2000;

function words(argv) {
  const known = ['--json', '--simulated'];
  const bad = argv.find((word) => word.startsWith('-') && !known.includes(word));
  if (bad) throw new ExportError(`unknown option '${bad}', expected ${known.join(', ')} or --help`);
  const [out, ...recordings] = argv.filter((word) => !word.startsWith('-'));
  if (out === undefined || recordings.length === 0) {
    throw new ExportError(`${out === undefined ? 'no folder and no recording is' : 'no recording is'} named, expected OUT RECORDING...; see --help`);
  }
  return { out: resolve(out), recordings, json: argv.includes('--json'), simulated: argv.includes('--simulated') };
}

/** A line to the error output now and then, for who waits. */
function progressLine() {
  let last = Date.now();
  return (what) => (path, share) => {
    if (Date.now() - last < PROGRESS_MS) return;
    last = Date.now();
    process.stderr.write(`lerobot: ${what} ${path}: ${Math.floor(100 * share)} %\n`);
  };
}

const there = (path) => Boolean(lstatSync(path, { throwIfNoEntry: false }));

function checkPlace(out, part) {
  if (there(out)) throw new ExportError(`${out}: is there already, expected a name that is free`);
  if (!existsSync(dirname(out))) throw new ExportError(`${dirname(out)}: is not there, expected the folder in which ${out} is made`);
  if (there(part)) throw new ExportError(`${part}: is there, of an export that was killed or still runs; remove it when none does`);
}

async function surveyAll(recordings, progress) {
  const found = [];
  const seen = new Map();
  for (const path of recordings) {
    const real = existsSync(path) ? realpathSync(path) : path;
    if (seen.has(real)) throw new ExportError(`${path}: is named twice, first as ${seen.get(real)}`);
    seen.set(real, path);
    found.push(await survey(path, progress));
  }
  const other = found.find(({ both }) => both !== found[0].both);
  if (other) {
    const kind = ({ both }) => (both ? 'both sides\'' : 'a master\'s alone');
    throw new ExportError(`${other.path}: is ${kind(other)}, and ${found[0].path} is ${kind(found[0])}; expected one kind, as only both sides have commanded joints`);
  }
  return found;
}

/** What of one recording goes into the data set; gives what is said of it. */
async function convert(found, dataset, simulated, progress) {
  const said = { recording: found.path, both_sides: found.both, simulated: false, trials: found.marked, episodes: 0, frames: 0, done: 0, damage: found.damage, left_out: [] };
  const isSimulated = (episode) => Boolean(simulated || found.start.device.simulated || episode.simulated);
  said.simulated = isSimulated({});
  const name = (episode) => (found.marked ? `trial ${episode.key}` : 'the recording');
  await readFrames(found, (episode) => {
    const { about } = episode;
    about.simulated = isSimulated(about);
    about.recording = found.path.split('/').pop();
    if (about.cut) said.left_out.push(`${name(about)}: its part of ${episode.length} frames ends early: ${about.cut}`);
    dataset.add(episode, about.simulated ? `${about.task} (simulated)` : about.task);
    ++said.episodes;
    said.frames += episode.length;
    if (about.result === 'done') ++said.done;
  }, (missed) => said.left_out.push(`${name(missed)}: has no measured arm, and no frame is made`), progress);
  return said;
}

/** As what robot_type the data are labelled. */
function robotType(episodes) {
  const count = episodes.filter(({ simulated }) => simulated).length;
  if (count === 0) return 'handrail';
  return count === episodes.length ? 'handrail-simulated' : 'handrail-partly-simulated';
}

function say(summary) {
  for (const { recording, episodes, frames, trials, done, damage, left_out: leftOut } of summary.recordings) {
    console.log(`${recording}: ${episodes} episodes, ${frames} frames${trials ? `, ${done} done` : '; no trial is marked, the whole file is one, whether it succeeded is not known'}`);
    if (damage) console.log(`  the file ${damage}: all before is there`);
    for (const line of leftOut) console.log(`  ${line}`);
  }
  console.log(`${summary.out}: ${summary.episodes} episodes, ${summary.frames} frames, ${summary.tasks.length} tasks, ${summary.robot_type}`);
}

async function make({ out, part, recordings, json, simulated }) {
  const progress = progressLine();
  const found = await surveyAll(recordings, progress('looking through'));
  mkdirSync(part);
  unfinished = part;
  const dataset = new Dataset(part, found[0].both);
  const said = [];
  for (const each of found) said.push(await convert(each, dataset, simulated, progress('converting')));
  if (dataset.frames === 0) throw new ExportError(`${recordings.join(', ')}: no moment has a measured arm, expected one: scenes of walls have none`);
  const type = robotType(dataset.episodeRows);
  dataset.finish(type);
  renameSync(part, out);
  unfinished = '';
  const summary = { out, robot_type: type, episodes: dataset.episodes, frames: dataset.frames, fps: FPS, tasks: dataset.tasks, recordings: said };
  if (json) console.log(JSON.stringify(summary, null, 2));
  else say(summary);
  return said.some(({ damage, left_out: leftOut }) => damage || leftOut.length > 0) ? PARTLY : DONE;
}

async function main(argv) {
  if (argv.includes('--help') || argv.includes('-h')) {
    console.log(HELP);
    return DONE;
  }
  const asked = words(argv);
  asked.part = `${asked.out}.part`;
  checkPlace(asked.out, asked.part);
  return make(asked);
}

/** The folder that is being written; '': none. */
let unfinished = '';
function clean() {
  if (unfinished) rmSync(unfinished, { recursive: true, force: true });
}
function interrupted(code) {
  clean();
  process.stderr.write('lerobot: interrupted, nothing was made\n');
  process.exit(code);
}
process.on('SIGINT', () => interrupted(INTERRUPTED));
process.on('SIGTERM', () => interrupted(TERMINATED));
process.stdout.on('error', () => {}); // nobody reads: the data set is made all the same
try {
  process.exitCode = await main(process.argv.slice(2));
} catch (error) {
  const writing = unfinished;
  clean();
  // What the system says, as of a full disk, has its own words; anything else is a fault of this program.
  const told = error instanceof ExportError ? error.message : error.syscall ? `${writing || 'the data set'}: cannot be written: ${error.message}` : error.stack;
  process.stderr.write(`lerobot: ${told}\n`);
  process.exitCode = NOTHING;
}
