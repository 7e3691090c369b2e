// A person's trials of gearshift and wrench with the real programs: `handrail experiment` says on the
// page what to do, the mouse does it.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { open, until } from './browser.mjs';
import { BIN, sharedCell } from './programs.mjs';

const GEARS = [['1', -40, 47], ['2', -40, -47], ['3', 0, 47], ['4', 0, -47], ['5', 40, 47], ['R', 40, -47]];
const cell = sharedCell('gearshift');
const asked = (page, words) => until(page, (wanted) => document.getElementById('prompt-text').textContent.includes(wanted), words);

/** A runner for a person called anna, what it has said, and the first trial that it wrote down. */
function begin(experiment) {
  const { programs } = cell;
  const results = join(programs.folder, 'results');
  const child = spawn(join(BIN, 'handrail'), ['experiment', experiment, '--subject', 'anna', '--out', results, '--socket', programs.socket], { env: programs.environment });
  const runner = { said: '' };
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (text) => (runner.said += text));
  const ended = new Promise((resolve) => child.on('exit', resolve));
  runner.firstTrial = async (page) => {
    for (let i = 0; i < 200 && !/(done|time-out|session lost): /.test(runner.said); ++i) await page.waitForTimeout(50);
    child.kill('SIGINT');
    assert.equal(await ended, 130, runner.said);
    const lines = (await readFile(join(results, `${experiment}.anna.jsonl`), 'utf8')).trim().split('\n').map((line) => JSON.parse(line));
    assert.equal(lines[0].subject.simulated, false);
    assert.equal(lines[2].ended.practice, true);
    return lines[2].ended.walls;
  };
  return runner;
}

/** From millimetres of the map to the window. */
async function places(page) {
  await until(page, () => !document.querySelector('#frame2d').hidden && document.querySelector('#canvas2d').dataset.scale);
  await page.waitForTimeout(500);
  const box = await page.locator('#canvas2d').boundingBox();
  const size = await page.evaluate(() => Number(document.querySelector('#canvas2d').dataset.scale));
  return { box, at: (x, y) => [box.x + box.width / 2 + x * size, box.y + box.height / 2 - y * size] };
}

test('APersonShiftsThroughAllGearsByTheMouse', async () => {
  const runner = begin('gearshift');
  const page = await open(cell.browser, cell.url);
  const { at } = await places(page);
  const go = async (x, y) => {
    await page.mouse.move(...at(x, y), { steps: 15 });
    await page.waitForTimeout(200);
  };
  await asked(page, 'Hold the lever.');
  await page.mouse.move(...at(0, 0));
  await page.mouse.down();
  await asked(page, 'In N. The clock starts');
  let before = 0;
  for (const [name, x, y] of GEARS) {
    if (x !== before) await go(x, 0);
    before = x;
    await go(x, y);
    await asked(page, name === 'R' ? 'Back to N' : `${name} is in. Now `);
    if (name === '3') await page.screenshot({ path: 'shots/gearshift-experiment.png' });
  }
  await go(40, 0);
  await go(0, 0);
  const trial = await runner.firstTrial(page);
  await page.mouse.up();
  assert.equal(trial.end, 'done');
  assert.deepEqual(trial.visited, ['N', '1', '2', '3', '4', '5', 'R', 'N']);
  assert.equal(trial.wrong_gears ?? 0, 0);
  assert.ok(trial.time_s > 3 && trial.time_s < 60, trial.time_s);
  assert.deepEqual(page.faults, []);
  await page.context().close();
});

test('APersonTurnsTheWrenchBehindTheBall', async () => {
  const runner = begin('wrench');
  const page = await open(cell.browser, cell.url);
  await asked(page, 'Hold the lever.'); // in the scene of the wrench, which the runner has loaded
  await until(page, () => document.querySelector('#canvas2d').dataset.ball);
  const { box } = await places(page);
  const ball = async () => {
    const [x, y] = (await page.evaluate(() => document.querySelector('#canvas2d').dataset.ball)).split(' ').map(Number);
    return [box.x + x, box.y + y];
  };
  await page.mouse.move(...(await ball())); // the lever is there
  await page.mouse.down();
  await asked(page, 'Follow the ball: loop 1 of 2.');
  let shot = false;
  for (let i = 0; i < 800 && !/: \d+\.\d s, turned by/.test(runner.said); ++i) {
    await page.mouse.move(...(await ball()));
    await page.waitForTimeout(20);
    if (!shot && (await page.locator('#prompt-text').textContent()).includes('loop 2')) {
      await page.screenshot({ path: 'shots/wrench-experiment.png' });
      shot = true;
    }
  }
  const trial = await runner.firstTrial(page);
  await page.mouse.up();
  assert.ok(shot);
  assert.equal(trial.end, 'done');
  assert.ok(trial.time_s > 13 && trial.time_s < 25, trial.time_s); // the ball's own way takes 13.2 s
  assert.ok(trial.turned_rad > 4.5 && trial.turned_rad < 7.5, trial.turned_rad); // 6.5 along the middle; a slow browser cuts corners
  assert.equal(trial.screw_c, 5);
  assert.ok(trial.mean_from_ball_mm < 15, trial.mean_from_ball_mm);
  assert.deepEqual(page.faults, []);
});
