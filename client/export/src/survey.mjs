// The first reading of a recording: what it is of, where its trials begin and end, how far it is whole.
import { basename } from 'node:path';
import { ExportError, readRecording } from './recording.mjs';

const MARK = 0;
const TRIAL = /^trial (begins|ends): (\S+) (\S+) (\S+) (\d+)((?: \S+)*)$/;
const NAME = /^\d{8}T\d{6}\.\d{3}Z-(?:master|slave)(?:-(.+))?$/;

/** {what, key, task, rest, simulated} of a mark, or null. */
export function trialOf(text) {
  const found = TRIAL.exec(text);
  if (!found) return null;
  const [, what, experiment, mode, subject, number, more] = found;
  const rest = more.split(' ').filter((word) => word !== '');
  return {
    what,
    key: [experiment, mode, subject, number].join(' '),
    task: `${experiment} ${mode}`,
    subject,
    number: Number(number),
    simulated: rest.includes('simulated'),
    rest: rest.filter((word) => word !== 'simulated').join(' '),
  };
}

/** The label that a recording was begun with; of a renamed file its name. */
export function labelOf(path) {
  const name = basename(path).replace(/\.mcap$/, '');
  const found = NAME.exec(name);
  return found ? found[1] ?? 'recording' : name;
}

/** Episodes as marks say: {from, to [ns], task, result, trial, subject, practice, simulated}. */
function trials(marks, last) {
  const out = [];
  let open = null;
  const close = (to, result) => {
    if (open) out.push({ ...open, to, result });
    open = null;
  };
  for (const { at, trial } of marks) {
    if (trial.what === 'begins') {
      close(at, 'unfinished');
      open = {
        from: at, key: trial.key, task: trial.task, subject: trial.subject, trial: trial.number,
        practice: trial.rest === 'practice', simulated: trial.simulated,
      };
    } else if (open?.key === trial.key) {
      open.simulated ||= trial.simulated;
      close(at, trial.rest || 'unfinished');
    }
  }
  close(last, 'unfinished');
  return out;
}

/**
 * Reads all of `path`. Gives {path, both, start, episodes, first, last, damage}; throws ExportError where it is
 * no recording of a master.
 */
export async function survey(path, progress) {
  let master = null, slave = null, both = false, first = null, last = null;
  const marks = [];
  const damage = await readRecording(path, ({ side, name, at, value }) => {
    if (side) both = true;
    if (name === 'RecordedStart') {
      if (value.device) master ??= value;
      else if (value.arm) slave ??= value;
    } else if (name === 'RecordedTick') {
      first ??= at;
      last = at;
    } else if (name === 'RecordedEvent' && side !== 'slave' && value.kind === MARK) {
      const trial = trialOf(value.text);
      if (trial) marks.push({ at, trial });
    }
  }, progress);
  const problem = damage ? `, and the file ${damage}` : '';
  if (!master && slave) {
    throw new ExportError(`${path}: is a slave's recording, expected a master's, or both as one: handrail-lab recording-join MASTER ${path} --out BOTH.mcap`);
  }
  if (!master) throw new ExportError(`${path}: has no message on /start${problem}; expected a recording of Handrail`);
  if (first === null) throw new ExportError(`${path}: has no tick${problem}; expected at least one`);
  marks.sort((a, b) => (a.at < b.at ? -1 : a.at > b.at ? 1 : 0));
  const found = trials(marks, last);
  const whole = { from: first, to: last, task: labelOf(path), result: 'unknown', trial: 0, subject: '', practice: false, simulated: false };
  return { path, both, start: master, first, last, damage, marked: found.length > 0, episodes: found.length > 0 ? found : [whole] };
}
