import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { join } from 'node:path';
import { BIN, Programs } from './programs.mjs';

const DRAWS = 20000, OUTSIDE = 0.001; // on either side
const EXPERIMENTS = {
  'linear-movement': { modes: ['NV', 'V'], figures: ['execution_time_s', 'path_mm', 'max_position_error_mm', 'max_orientation_error_deg'] },
  'screw-fastening': { modes: ['NC-NV', 'NC-V', 'C-NV', 'C-V'], figures: ['completion_time_s', 'path_mm', 'mean_contact_force_n', 'max_contact_force_n'] },
};
const [folder, experiment, people] = process.argv.slice(2);
const COUNT = Number(people);
if (!EXPERIMENTS[experiment] || !(COUNT >= 1 && COUNT <= 100)) throw new Error(`${experiment} ${people}: expected ${Object.keys(EXPERIMENTS).join(' or ')}, and 1 to 100 people`);
const { modes: MODES, figures: FIGURES } = EXPERIMENTS[experiment];
const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  return (sorted[Math.floor((sorted.length - 1) / 2)] + sorted[Math.floor(sorted.length / 2)]) / 2;
};
const json = (program, ...argv) => JSON.parse(execFileSync(join(BIN, program), argv, { encoding: 'utf8', maxBuffer: 1 << 28 }));
/** Failed trials are the worst. */
const values = (study, mode, figure) => study.trials.filter((t) => t.mode === mode).map((t) => (t.end === 'done' ? t[figure] ?? Infinity : Infinity));

const programs = await new Programs().open();
try {
  for (let i = 1; i <= COUNT; ++i) {
    const subject = `p${String(i).padStart(2, '0')}`;
    const child = spawn(join(BIN, 'handrail'), ['experiment', experiment, '--subject', subject, '--simulated', '--trials', '1', '--resume', '--out', folder, '--socket', programs.socket, '--rig-socket', programs.rigSocket], { stdio: ['ignore', 'ignore', 'inherit'] });
    const [code] = await once(child, 'exit');
    if (code !== 0) throw new Error(`${subject}: ended with ${code}`);
    console.error(`${subject} is done (${i} of ${COUNT})`);
  }
} finally {
  await programs.close();
}
const live = json('handrail', 'experiment', experiment, '--report', '--simulated', '--json', '--out', folder);
const lab = json('handrail-lab', experiment, '--operators', '400', '--trials', '1', '--seed', '7', '--json');
let seed = 1;
const random = () => (seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32;
const draw = (all) => {
  const left = [...all];
  return Array.from({ length: COUNT }, () => left.splice(Math.floor(random() * left.length), 1)[0]);
};
let outside = 0;
for (const mode of MODES) {
  for (const figure of FIGURES) {
    const all = values(lab, mode, figure);
    const medians = Array.from({ length: DRAWS }, () => median(draw(all))).sort((a, b) => a - b);
    const low = medians[Math.floor(OUTSIDE * DRAWS)], high = medians[DRAWS - 1 - Math.floor(OUTSIDE * DRAWS)];
    const here = median(values(live, mode, figure));
    const inside = here >= low && here <= high;
    outside += !inside;
    console.log(`${mode.padEnd(5)} ${figure.padEnd(28)} ${here.toPrecision(3).padStart(8)}   virtual time: ${low.toPrecision(3)} to ${high.toPrecision(3)}${inside ? '' : '   OUTSIDE'}`);
  }
}
process.exit(outside ? 1 : 0);
