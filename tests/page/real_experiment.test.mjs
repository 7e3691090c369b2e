// A person's trial of linear movement with the real programs: `handrail experiment` says what to do on
// the page, the page's keys do it.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { open, until } from './browser.mjs';
import { BIN, sharedCell } from './programs.mjs';

const cell = sharedCell('linear-movement');
const asked = (page, words) => until(page, (wanted) => document.getElementById('prompt-text').textContent.includes(wanted), words);
const press = (page, ...keys) => keys.reduce((before, key) => before.then(() => page.keyboard.press(key)), Promise.resolve());
const tool = (page, wanted) => until(page, (kinds) => document.querySelector('#tool-now').textContent === kinds, wanted);

/** Until the tip has come so far along an axis of S, as the master says. */
async function comes(page, programs, axis, to) {
  for (let i = 0; i < 400; ++i) {
    const { tip } = JSON.parse(programs.handrail('status', '--json', '--socket', programs.socket));
    if (Math.abs(tip.position_mm[axis] - to) < 1.5) return;
    await page.waitForTimeout(50);
  }
  assert.fail(`the tip does not come to ${to} mm`);
}

async function engages(page) {
  for (let i = 0; i < 6; ++i) {
    await press(page, 'e');
    const engaged = () => ['engaged', 'clutched'].includes(document.querySelector('#state').textContent);
    if (await page.waitForFunction(engaged, null, { timeout: 4000 }).then(() => true, () => false)) return;
  }
  assert.fail('it does not engage');
}

test('APersonMakesATrialWithToolsByTheirKeys', async () => {
  const { programs } = cell;
  // Somebody whose first mode is with tools.
  const runner = spawn(join(BIN, 'handrail'), ['experiment', 'linear-movement', '--subject', 'sim1', '--out', join(programs.folder, 'results'), '--socket', programs.socket], { env: programs.environment });
  let said = '';
  for (const stream of [runner.stdout, runner.stderr]) stream.on('data', (text) => (said += text));
  const ended = new Promise((resolve) => runner.on('exit', resolve));
  const page = await open(cell.browser, cell.url);
  await asked(page, 'Engage (E)');
  await page.keyboard.down('Shift');
  await engages(page);
  await asked(page, 'At A. Let the hand go.');
  await page.keyboard.up('Shift');
  await asked(page, 'M starts the clock');
  await page.screenshot({ path: 'shots/experiment.png' });
  await press(page, 'm', '1', 'n');
  await tool(page, 'line + n-rotation');
  await page.keyboard.down('Shift');
  await page.keyboard.down('ArrowRight');
  await comes(page, programs, 1, -37.5);
  await page.keyboard.up('ArrowRight');
  await press(page, 'm');
  await asked(page, 'Drop the tools (X), at-B (2)');
  await press(page, 'x', '2');
  await tool(page, 'point');
  await press(page, 'm', '3', 'n');
  await tool(page, 'line + n-rotation');
  await page.keyboard.down('ArrowDown');
  await comes(page, programs, 2, 254);
  await page.keyboard.up('ArrowDown');
  await press(page, 'm');
  for (let i = 0; i < 100 && !said.includes('done: '); ++i) await page.waitForTimeout(50);
  await page.keyboard.up('Shift');
  assert.match(said, /done: [\d.]+ s, path 1[45]\d mm/);
  runner.kill('SIGINT');
  assert.equal(await ended, 130, said);
  await until(page, () => document.getElementById('prompt').hidden);
  const lines = (await readFile(join(programs.folder, 'results', 'linear-movement.sim1.jsonl'), 'utf8')).trim().split('\n').map((line) => JSON.parse(line));
  assert.equal(lines[0].subject.simulated, false);
  const { linear, practice } = lines[2].ended;
  assert.deepEqual([practice, linear.mode, linear.end], [true, 'V', 'done']);
  assert.ok(linear.max_position_error_on_lines_mm < 1, linear.max_position_error_on_lines_mm);
  assert.ok(linear.max_orientation_error_deg < 1, linear.max_orientation_error_deg);
  assert.deepEqual(page.faults, []);
});
