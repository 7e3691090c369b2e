// A person's trial of screw fastening with the real programs: the runner says on the page what to do, keys
// call the tools, the mouse leads the key into the screw and turns it.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';
import { open, until } from './browser.mjs';
import { BIN, sharedCell } from './programs.mjs';

const TURN_PX = 4; // a degree by the mouse with Ctrl
const STEP_PX = 12, STEP_MS = 20; // of a hand that has two minutes: 3 deg in some 30 ms
const RIM = [350, 0, 260]; // of the screw, as its scene has it
const cell = sharedCell('screw-fastening');
const asked = (page, words) => until(page, (wanted) => document.getElementById('prompt-text').textContent.includes(wanted), words);
const tool = (page, wanted) => until(page, (kinds) => document.querySelector('#tool-now').textContent === kinds, wanted);

/** What the page shows of the screw. */
const shown = (page) => page.evaluate(() => {
  const key = document.querySelector('#screw-key').textContent;
  const number = (pattern) => Number((pattern.exec(key) ?? [0, 'NaN'])[1]);
  const above = number(/([\d.]+) mm above/);
  return {
    turned: parseFloat(document.querySelector('#screw-turned').textContent),
    depth: Number.isNaN(above) ? number(/([\d.]+) mm in/) : -above,
    off: number(/fits (\d+)°/) * (key.includes('counterclockwise') ? -1 : 1), // clockwise
    trouble: document.querySelector('#screw-trouble').textContent,
    state: document.querySelector('#state').textContent,
    hint: document.querySelector('#hint').textContent,
    why: document.querySelector('#why').textContent,
  };
});

/** A mouse that has the ring at the tip, and knows what its pixels do there. */
class Mouse {
  constructor(page, programs) {
    Object.assign(this, { page, programs });
  }

  tip() {
    return JSON.parse(this.programs.handrail('status', '--json', '--socket', this.programs.socket)).tip.position_mm;
  }

  /** Takes the ring: again, where a busy machine has drawn it late. */
  async grip() {
    const canvas = await this.page.locator('#canvas3d').boundingBox();
    const held = () => document.querySelector('#hold').dataset.held === 'true' && document.querySelector('#state').textContent === 'engaged';
    for (let i = 0; i < 3; ++i) {
      await this.page.waitForTimeout(400);
      const ring = await this.page.evaluate(() => ({ ...document.querySelector('#stats').dataset }));
      [this.x, this.y] = [canvas.x + Number(ring.tipX), canvas.y + Number(ring.tipY)];
      await this.page.mouse.move(this.x, this.y);
      await this.page.mouse.down();
      if (await this.page.waitForFunction(held, null, { timeout: 8000 }).then(() => true, () => false)) return;
      await this.page.mouse.up();
    }
    assert.fail(`the ring is not taken: ${JSON.stringify(await shown(this.page))}`);
  }

  /** Lets go and takes the ring anew: the hand has all of its reach again, and the mouse all of the window. */
  async again() {
    await this.page.mouse.up();
    await this.page.waitForTimeout(700);
    await this.grip();
  }

  async by(dx, dy) {
    const steps = Math.max(1, Math.ceil(Math.hypot(dx, dy) / STEP_PX));
    for (let i = 0; i < steps; ++i) {
      await this.page.mouse.move((this.x += dx / steps), (this.y += dy / steps));
      await this.page.waitForTimeout(STEP_MS);
    }
  }

  /** By degrees clockwise, as one looks at the screw. */
  async turn(degrees) {
    await this.page.keyboard.down('Control');
    await this.by(-degrees * TURN_PX, 0);
    await this.page.keyboard.up('Control');
    await this.page.waitForTimeout(400);
  }

  /** What a pixel, or a notch of the wheel, is at the tip along an axis of S: tried out. */
  async learn(move, axis) {
    const before = this.tip()[axis];
    await move(10);
    await this.page.waitForTimeout(700);
    return (this.tip()[axis] - before) / 10;
  }

  /** Until the tip is where it should be along that axis. */
  async to(move, axis, wanted, within) {
    const each = await this.learn(move, axis);
    assert.ok(Math.abs(each) > 1e-3, `nothing moves along ${'XYZ'[axis]}`);
    for (let i = 0; i < 12; ++i) {
      const missing = wanted - this.tip()[axis];
      if (Math.abs(missing) < within) return;
      await move(missing / each);
      await this.page.waitForTimeout(500);
    }
    assert.fail(`the tip is at ${this.tip()} and not at ${wanted} along ${'XYZ'[axis]}`);
  }
}

async function engages(page) {
  for (let i = 0; i < 6; ++i) {
    await page.keyboard.press('e');
    const engaged = () => ['engaged', 'clutched'].includes(document.querySelector('#state').textContent);
    if (await page.waitForFunction(engaged, null, { timeout: 4000 }).then(() => true, () => false)) return;
  }
  assert.fail('it does not engage');
}

/** Until the key is in. */
async function letDown(page, mouse) {
  for (let i = 0; i < 30; ++i) {
    const { depth } = await shown(page);
    if (depth > 3.5) return;
    await mouse.by(0, depth < -5 ? 12 : depth < -1 ? 8 : 4);
    await page.waitForTimeout(150);
  }
  assert.fail(`the key does not go in: ${JSON.stringify(await shown(page))}`);
}

/** Until its flats fit: with the key out of the screw. */
async function fit(page, mouse) {
  for (let i = 0; i < 5; ++i) {
    const { off } = await shown(page);
    if (Math.abs(off) < 1) return;
    await mouse.turn(off);
  }
  assert.fail(`the flats do not fit: ${JSON.stringify(await shown(page))}`);
}

async function lift(page, mouse, height) {
  for (let i = 0; i < 40; ++i) {
    const { depth } = await shown(page);
    if (Number.isNaN(depth) || depth < -height) return;
    await mouse.by(0, -12);
    await page.waitForTimeout(100);
  }
  assert.fail(`the key does not come out: ${JSON.stringify(await shown(page))}`);
}

test('APersonTightensTheScrewWithToolsAndProtection', async (t) => {
  const { programs } = cell;
  const results = join(programs.folder, 'results'), file = join(results, 'screw-fastening.anna.jsonl');
  await mkdir(results, { recursive: true });
  // Somebody whose first mode it is.
  await writeFile(file, '{"subject":{"experiment":"screw-fastening","subject":"anna","simulated":false,"modes":["C-V"],"practice":1,"trials":1}}\n');
  const runner = spawn(join(BIN, 'handrail'), ['experiment', 'screw-fastening', '--subject', 'anna', '--resume', '--out', results, '--socket', programs.socket, '--rig-socket', programs.rigSocket], { env: programs.environment });
  let said = '';
  for (const stream of [runner.stdout, runner.stderr]) stream.on('data', (text) => (said += text));
  const ended = new Promise((resolve) => runner.on('exit', resolve));
  t.after(() => runner.kill('SIGKILL'));
  const page = await open(cell.browser, cell.url);
  await asked(page, 'Engage (E)');
  await page.keyboard.down('Shift');
  await engages(page);
  await asked(page, 'At the start. Let the hand go.');
  await page.keyboard.up('Shift');
  await asked(page, 'M starts the clock');
  await page.click('[data-view="front"]');
  await page.evaluate(() => (document.querySelector('#stats').hidden = false));
  await until(page, () => !document.querySelector('#screw').hidden);
  assert.equal((await shown(page)).turned, 0);
  await page.keyboard.press('m');
  await asked(page, 'Turned by 0 of 540 deg.');

  const mouse = new Mouse(page, programs);
  await mouse.grip();
  await mouse.to((px) => mouse.by(px, 0), 1, RIM[1], 0.4);
  await mouse.to((notches) => page.mouse.wheel(0, notches), 0, RIM[0], 0.4);
  const { off } = await shown(page);
  await mouse.turn(off > 0 ? off - 60 : off); // back, so that half a turn clockwise is left
  await fit(page, mouse);
  await mouse.again();
  await page.keyboard.press('1');
  await page.keyboard.press('n');
  await tool(page, 'line + n-rotation');
  await letDown(page, mouse);
  for (let half = 0; half < 6; ++half) {
    await page.keyboard.press('f');
    await tool(page, 'line + f-rotation');
    await mouse.turn(180);
    if (half === 1) await page.screenshot({ path: 'shots/screw-experiment.png' });
    if ((await shown(page)).turned >= 540) break;
    await lift(page, mouse, 3);
    await mouse.turn(-180);
    await fit(page, mouse);
    await mouse.again();
    await page.keyboard.press('n');
    await tool(page, 'line + n-rotation');
    await letDown(page, mouse);
  }
  assert.ok((await shown(page)).turned >= 540, JSON.stringify(await shown(page)));
  await asked(page, 'Tight: lift the key 10 mm.');
  for (let i = 0; i < 30 && !/(done|lost|hard|time-out): /.test(said); ++i) {
    await mouse.by(0, -8);
    await page.waitForTimeout(100);
  }
  await page.mouse.up();
  for (let i = 0; i < 100 && !said.includes('Trial 2'); ++i) await page.waitForTimeout(50);
  assert.match(said, /done: [\d.]+ s, path \d+ mm/);
  runner.kill('SIGINT');
  assert.equal(await ended, 130, said);
  const lines = (await readFile(file, 'utf8')).trim().split('\n').map((line) => JSON.parse(line));
  const { screw, practice } = lines[2].ended;
  assert.deepEqual([practice, screw.mode, screw.end], [true, 'C-V', 'done']);
  assert.ok(screw.max_contact_force_n > 2 && screw.max_contact_force_n < 500, screw.max_contact_force_n);
  assert.equal(screw.misses, undefined);
  assert.deepEqual(page.faults, []);
});
