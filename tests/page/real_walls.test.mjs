// The page with a real master and gateway, in a scene of walls.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { open, text, until } from './browser.mjs';
import { sharedCell } from './programs.mjs';

const GEARS = [['1', -40, 47], ['2', -40, -47], ['3', 0, 47], ['4', 0, -47], ['5', 40, 47], ['R', 40, -47]];
const is = (page, id, wanted) => until(page, ([node, value]) => new RegExp(value).test(document.getElementById(node).textContent), [id, wanted]);

const cell = sharedCell('gearshift');

test('TheLeverGoesThroughEveryGearByTheMouse', async () => {
  const page = await open(cell.browser, cell.url);
  await until(page, () => !document.querySelector('#frame2d').hidden);
  await page.waitForTimeout(1000);
  const box = await page.locator('#canvas2d').boundingBox();
  const size = await page.evaluate(() => Number(document.querySelector('#canvas2d').dataset.scale));
  const at = ([x, y]) => [box.x + box.width / 2 + x * size, box.y + box.height / 2 - y * size];
  const go = async (x, y) => {
    await page.mouse.move(...at([x, y]), { steps: 15 });
    await page.waitForTimeout(300);
  };
  await page.mouse.move(...at([0, 0]));
  await page.mouse.down();
  await is(page, 'hold', 'held');
  for (const [name, x, y] of GEARS) {
    await go(x, 0);
    await go(x, y);
    await is(page, 'place', `^${name}$`);
    assert.equal(await text(page, 'place-what'), 'locked');
    await go(x, 0);
  }
  await go(20, 40);
  await is(page, 'place', '^wall$');
  assert.ok(Number(await text(page, 'force-now')) > 1);
  await page.mouse.up();
  await is(page, 'hold', 'free');
  assert.deepEqual(page.faults, []);
  await page.context().close();
});
