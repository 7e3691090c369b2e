import { loadavg } from 'node:os';
import { launch } from './browser.mjs';
import { crowd, dataAge, handToForceAndBack, pageReady, pictures, quantile, recordingCost, strangers, viewersCost } from './figures.mjs';
import { Programs } from './programs.mjs';

const json = process.argv.includes('--json');
const rows = [];
const row = (what, values, unit, asked, share = 0.95) => {
  const value = Number(quantile(values, share).toFixed(1));
  rows.push({ what, value, median: Number(quantile(values, 0.5).toFixed(1)), share, unit, asked, count: values.length, load: Number(loadavg()[0].toFixed(1)) });
  if (json) return;
  const { median, load } = rows.at(-1);
  console.log(`${what.padEnd(58)} ${String(value).padStart(8)} ${String(median).padStart(8)} ${unit.padEnd(4)} ${asked.padEnd(14)} ${String(values.length).padStart(4)} ${String(load).padStart(5)}`);
};

const browser = await launch();
const arm = await new Programs().open();
const seen = [], empty = [], armReady = [];
try {
  const url = await arm.console();
  armReady.push(...await pageReady(browser, url));
  for (let round = 0; round < 3; ++round) {
    seen.push(...await pictures(browser, url, { seconds: 6 }));
    empty.push(...await pictures(browser, url, { seconds: 6, empty: true }));
  }
} finally {
  await arm.close();
}
const programs = await new Programs().open({ scene: 'gearshift' });
try {
  if (!json) console.log(`${''.padEnd(58)} ${'p95'.padStart(8)} ${'median'.padStart(8)} ${''.padEnd(4)} ${'asked'.padEnd(14)} ${'of'.padStart(4)} ${'load'.padStart(5)}`);
  row('pictures of the arm a second (the lowest 5 %)', seen, '/s', '>= 15', 0.05);
  row('... with nothing drawn into them', empty, '/s', '(31 seen once)', 0.05);
  const url = await programs.console();
  const hand = await handToForceAndBack(browser, url);
  row('a pointer moves, until the page has its cursor', hand.cursor, 'ms', '< 50');
  row('a pointer moves, until the page has its force', hand.force, 'ms', '< 50');
  row('an address is opened, until the page is ready: an arm', armReady, 'ms', '< 2000');
  row('... walls', await pageReady(browser, url), 'ms', '< 2000');
  const age = await dataAge(browser, url);
  row(`the age that is shown is wrong by (known to ${age.error.toFixed(1)} ms)`, age.wrong.map(Math.abs), 'ms', '< 20');
  const plain = await strangers(programs, url);
  row('a file is asked for, while 1000 say a byte a second', plain.waits, 'ms', '< 200');
  row('... and the gateway grows by', [plain.growth], 'MiB', '< 64');
  await browser.close();
  const cost = await viewersCost(programs, url);
  row('haptic loop, 99.9 % late, in windows without a viewer', cost.without, 'us', '');
  row('... with 20 viewers', cost.with, 'us', '+ 50 (median)');
  row('statuses a second of the slowest viewer', cost.slowest, '/s', '60');
  const written = await recordingCost(programs);
  row('haptic loop, 99.9 % late, in windows without a recorder', written.without, 'us', '');
  row('... while everything is recorded', written.with, 'us', '+ 50 (median)');
  const rush = await crowd(programs, url);
  row('a thousand pages at once, until the last is answered', rush.first.map(({ slowest }) => slowest), 'ms', '< 2000', 1);
  row('haptic loop, 99.9 % late, in windows without them', rush.without, 'us', '');
  row('... while they call again each second', rush.with, 'us', '+ 50 (median)');
  await programs.end('console');
  programs.handrail('keys', 'new', 'operator');
  await programs.console({ remote: true });
  const tls = await strangers(programs, programs.handrail('keys', 'link', 'observer').trim());
  row('over TLS: a file, while 1000 send half a greeting', tls.waits, 'ms', '< 200');
  row('... and the gateway grows by', [tls.growth], 'MiB', '< 64');
  if (json) console.log(JSON.stringify(rows));
} finally {
  await browser.close();
  await programs.close();
}
