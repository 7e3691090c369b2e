// The second reading of a recording: its frames, a hundred a second, episode by episode.
import { FPS, WINDOW, featuresOf, widthOf } from './features.mjs';
import { ExportError, readRecording } from './recording.mjs';

const FRAME_NS = 1_000_000_000n / BigInt(FPS);
const SAMPLE_NS = 1_000_000n;
const KEPT_NS = 2n * FRAME_NS; // of the wrench, for the window
const OLD_CYCLE_NS = 100_000_000n; // of a slave's recording that has ended or has a hole

// How many numbers a message has, where it has them.
const LENGTHS = {
  tick: [['wrench', 6], ['motion', 24]],
  command: [['command_pose', 7], ['position_geometry', 11], ['orientation_geometry', 11]],
  state: [['joints', 6], ['measured_pose', 7], ['command_pose', 7], ['wrench', 6]],
};

const kindOf = ({ dtype }) => (dtype === 'float32' ? Float32Array : Float64Array);

/** The values of one episode: an array a column, which grows. */
export class Episode {
  length = 0;

  constructor(features, about) {
    this.about = about;
    this.columns = new Map(Object.entries(features).map(([key, feature]) => [key, { feature, width: widthOf(feature), values: new (kindOf(feature))(0) }]));
  }

  add(moment, place) {
    for (const [key, column] of this.columns) {
      const values = column.feature.of(moment);
      if (values.length !== column.width) throw new ExportError(`${place}: ${key} has ${values.length} numbers, expected ${column.width}`);
      const bad = values.findIndex((value) => !Number.isFinite(value));
      if (bad >= 0) throw new ExportError(`${place}: ${key}[${bad}] is ${values[bad]}, expected a finite number`);
      const at = this.length * column.width;
      if (at + column.width > column.values.length) {
        const more = new (kindOf(column.feature))(Math.max(256 * column.width, 2 * column.values.length));
        more.set(column.values);
        column.values = more;
      }
      column.values.set(values, at);
    }
    ++this.length;
  }

  values(key) {
    const { values, width } = this.columns.get(key);
    return values.subarray(0, this.length * width);
  }
}

function checkLengths(place, message, lengths) {
  for (const [field, expected] of lengths) {
    if (message[field].length !== expected) throw new ExportError(`${place}: ${field} has ${message[field].length} numbers, expected ${expected}`);
  }
}

/** What was the newest at each moment of the last 20 ms. */
class WrenchHistory {
  entries = [];

  /** A wrench that is none is 0, and `state` says that it is not valid. */
  put(at, state) {
    const valid = state.wrench_valid && state.wrench.every(Number.isFinite);
    const wrench = valid ? state.wrench : [0, 0, 0, 0, 0, 0];
    state.wrench_valid = valid;
    this.entries.push({ at, wrench });
    while (this.entries.length > 2 && this.entries[1].at < at - KEPT_NS) this.entries.shift();
  }

  window(at) {
    const out = [];
    for (let i = WINDOW - 1; i >= 0; --i) {
      const moment = at - BigInt(i) * SAMPLE_NS;
      let found = this.entries[0];
      for (const entry of this.entries) if (entry.at <= moment) found = entry;
      out.push(...found.wrench);
    }
    return out;
  }
}

/** Makes frames of messages as they come. */
class Frames {
  tick = null; // newest
  state = null; // the slave's newest
  target = null;
  cycleAt = 0n;
  history = new WrenchHistory();
  wanted; // episodes that are still to come or open
  open = null; // {episode, next: the next frame's time}
  made = false; // something of the first that is wanted

  constructor(found, features, done, missed) {
    Object.assign(this, { found, features, done, missed });
    this.wanted = [...found.episodes];
  }

  take({ name, at, value }) {
    if (name === 'RecordedTick') this.takeTick(at, value);
    else if (name === 'RecordedCycle') this.takeCycle(at, value);
  }

  takeCycle(at, cycle) {
    const place = `${this.found.path}: cycle ${cycle.number}`;
    if (!cycle.state) throw new ExportError(`${place}: has no state, expected one`);
    checkLengths(place, cycle.state, LENGTHS.state);
    checkLengths(place, cycle, [['q_target', 6]]);
    this.upTo(at);
    this.state = cycle.state;
    this.target = cycle.q_target;
    this.cycleAt = at;
    this.history.put(at, cycle.state);
  }

  takeTick(at, tick) {
    const place = `${this.found.path}: tick ${tick.number}`;
    checkLengths(place, tick, LENGTHS.tick);
    // Of older recordings there is no such field; without a sensor it is empty.
    if (tick.handle?.length) checkLengths(place, tick, [['handle', 6]]);
    if (!tick.command || !tick.link) throw new ExportError(`${place}: has no ${tick.command ? 'link' : 'command'}, expected one`);
    checkLengths(place, tick.command, LENGTHS.command);
    this.upTo(at);
    const missing = this.tick ? Number(tick.number.toString()) - Number(this.tick.number.toString()) - 1 : 0;
    // Ticks that could not be kept, or another start of the program.
    if (missing !== 0) this.end(`${Math.abs(missing)} ticks are missing before tick ${tick.number}`);
    if (tick.slave && !this.found.both) {
      checkLengths(place, tick.slave, LENGTHS.state);
      this.state = tick.slave;
      this.history.put(at, tick.slave);
    }
    this.tick = tick;
    this.tickAt = at;
    this.place = place;
    const [now] = this.wanted;
    if (now && at >= now.from && at <= now.to && !this.open && this.ready(at)) {
      this.open = { episode: new Episode(this.features, { ...now, begun: at }), next: at };
      this.upTo(at + 1n);
    }
  }

  ready(at) {
    if (!this.state?.pose_valid || !this.tick.slave_known) return false;
    return !this.found.both || (this.target !== null && at - this.cycleAt <= OLD_CYCLE_NS);
  }

  /** Frames before `at`: what was newest then stands in them. */
  upTo(at) {
    while (this.open && this.open.next < at && this.open.next <= this.wanted[0].to) {
      if (this.found.both && this.open.next - this.cycleAt > OLD_CYCLE_NS) {
        this.end('the slave\'s recording has a hole');
        break;
      }
      const { tick, state, target } = this;
      this.open.episode.add({ tick, state, target, window: this.history.window(this.open.next) }, this.place);
      this.open.next += FRAME_NS;
    }
    while (this.wanted.length > 0 && at > this.wanted[0].to) this.close();
  }

  /** The wanted episode is over, and all that it has been is done. */
  close() {
    this.end('');
    const over = this.wanted.shift();
    if (!this.made) this.missed(over);
    this.made = false;
  }

  /** The open episode ends; `why`: before its trial did. */
  end(why) {
    if (!this.open) return;
    const { episode } = this.open;
    this.open = null;
    this.made = true;
    if (why) episode.about.result = 'interrupted';
    episode.about.cut = why;
    this.done(episode);
  }
}

/** Reads what `survey` has found; each episode goes to `done` as it is complete, one without a frame to `missed`. */
export async function readFrames(found, done, missed, progress) {
  const frames = new Frames(found, featuresOf(found.both), done, missed);
  await readRecording(found.path, (message) => frames.take(message), progress);
  frames.upTo(found.last + 1n);
  while (frames.wanted.length > 0) frames.close();
}
