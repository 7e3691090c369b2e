// Ten simulated people at the running programs against the lab's people in virtual time.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { join } from 'node:path';
import { BIN, Programs } from './programs.mjs';

const COUNT = 10, DRAWS = 20000, OUTSIDE = 0.001; // on either side
const LAB = ['--operators', '400', '--seed', '7', '--json'];
const [folder, ...wanted] = process.argv.slice(2);

const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  return (sorted[Math.floor((sorted.length - 1) / 2)] + sorted[Math.floor(sorted.length / 2)]) / 2;
};
const json = (program, ...argv) => JSON.parse(execFileSync(join(BIN, program), argv, { encoding: 'utf8', maxBuffer: 1 << 28 }));

/** A figure's values at the programs and in the lab. Failed trials are the worst. */
const ofStudy = (mode, figure) => {
  const values = ({ trials }) => trials.filter((t) => t.mode === mode).map((t) => (t.end === 'done' ? t[figure] ?? Infinity : Infinity));
  return { name: `${mode.padEnd(5)} ${figure}`, live: values, lab: values };
};
const ofWalls = (name, figure) => {
  const values = ({ trial }) => trial.map((t) => (t.end === 'done' ? t[figure] : Infinity));
  return { name, live: values, lab: values };
};
const force = ofWalls('largest force, N', 'max_force_n');
const depth = ofWalls('hand from lever, mm', 'max_hand_from_lever_mm');
const turned = ofWalls('turned, rad', 'turned_rad');
const ball = ofWalls('mean from ball, mm', 'mean_from_ball_mm');
const time = ofWalls('time, s', 'time_s');
const EXPERIMENTS = {
  'linear-movement': {
    lab: ['linear-movement', '--trials', '1'],
    figures: ['NV', 'V'].flatMap((mode) => ['execution_time_s', 'path_mm', 'max_position_error_mm', 'max_orientation_error_deg'].map((f) => ofStudy(mode, f))),
  },
  'screw-fastening': {
    lab: ['screw-fastening', '--trials', '1'],
    figures: ['NC-NV', 'NC-V', 'C-NV', 'C-V'].flatMap((mode) => ['completion_time_s', 'path_mm', 'mean_contact_force_n', 'max_contact_force_n'].map((f) => ofStudy(mode, f))),
  },
  // Among walls the same task and person, the page's device and the master's tick in virtual time: the lab's
  // people hold a joystick, which follows the hand without a page's delay.
  gearshift: { figures: [time, force, depth] },
  wrench: { figures: [turned, force, depth, ball] },
  'wrench-loosening': { figures: [force, depth, ball] },
};

async function make(experiment) {
  for (let i = 1; i <= COUNT; ++i) {
    const subject = `p${String(i).padStart(2, '0')}`;
    // Their own programs for each: how a loop's millisecond lies to the next one's is drawn anew, as in virtual time.
    const programs = await new Programs().open();
    try {
      const child = spawn(join(BIN, 'handrail'), ['experiment', experiment, '--subject', subject, '--simulated', '--trials', '1', '--resume', '--out', folder, '--socket', programs.socket, '--rig-socket', programs.rigSocket], { stdio: ['ignore', 'ignore', 'inherit'] });
      const [code] = await once(child, 'exit');
      if (code !== 0) throw new Error(`${subject}: ended with ${code}`);
      console.error(`${experiment}: ${subject} is done (${i} of ${COUNT})`);
    } finally {
      await programs.close();
    }
  }
}

/** The 99.8 % interval for medians of ten of these values. */
function interval(all) {
  let seed = 1;
  const random = () => (seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32;
  const draw = () => {
    const left = [...all];
    return Array.from({ length: COUNT }, () => left.splice(Math.floor(random() * left.length), 1)[0]);
  };
  const medians = Array.from({ length: DRAWS }, () => median(draw())).sort((a, b) => a - b);
  return [medians[Math.floor(OUTSIDE * DRAWS)], medians[DRAWS - 1 - Math.floor(OUTSIDE * DRAWS)]];
}

let outside = 0;
for (const experiment of wanted.length ? wanted : Object.keys(EXPERIMENTS)) {
  const { lab: study, figures } = EXPERIMENTS[experiment] ?? {};
  if (!figures) throw new Error(`no experiment '${experiment}', expected ${Object.keys(EXPERIMENTS).join(', ')}`);
  await make(experiment);
  const live = json('handrail', 'experiment', experiment, '--report', '--simulated', '--json', '--out', folder);
  const lab = study ? json('handrail-lab', ...study, ...LAB) : json('handrail', 'experiment', experiment, '--rehearse', '400', '--json');
  for (const figure of figures) {
    const [low, high] = interval(figure.lab(lab));
    const here = median(figure.live(live));
    const inside = here >= low && here <= high;
    outside += !inside;
    console.log(`${experiment.padEnd(17)} ${figure.name.padEnd(28)} ${here.toPrecision(3).padStart(8)}   virtual time: ${low.toPrecision(3)} to ${high.toPrecision(3)}${inside ? '' : '   OUTSIDE'}`);
  }
}
process.exit(outside ? 1 : 0);
