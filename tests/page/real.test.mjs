// The page with the real programs: rig, slave, master and gateway of build/release/bin.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { launch, open, text, until } from './browser.mjs';
import { Programs } from './programs.mjs';

const GEARS = [['1', -40, 47], ['2', -40, -47], ['3', 0, 47], ['4', 0, -47], ['5', 40, 47], ['R', 40, -47]];

let browser;
before(async () => (browser = await launch()));
after(() => browser.close());

const is = (page, id, wanted) => until(page, ([node, value]) => new RegExp(value).test(document.getElementById(node).textContent), [id, wanted]);
/** Engages as a person does: the order, then the hand. */
const engage = async (page) => {
  await page.keyboard.press('e');
  await until(page, () => document.querySelector('#state').textContent === 'engaged' || document.querySelector('.waits'));
  await page.keyboard.down('Shift');
  await is(page, 'state', '^engaged$');
};
const tip = (page) => page.evaluate(() => {
  const { tipX, tipY } = document.querySelector('#stats').dataset;
  return [Number(tipX), Number(tipY)];
});
const way = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

describe('walls', () => {
  let programs, url;
  before(async () => {
    programs = await new Programs().open({ scene: 'gearshift' });
    url = await programs.console();
  });
  after(() => programs.close());

  test('TheLeverGoesThroughEveryGearByTheMouse', async () => {
    const page = await open(browser, url);
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
});

describe('the arm', () => {
  let programs, url, page;
  before(async () => {
    programs = await new Programs().open();
    url = await programs.console();
    page = await open(browser, `${url}`);
    await page.goto(new URL('/?stats', url).href);
    await until(page, () => document.querySelector('#state').textContent === 'off');
  });
  after(() => programs.close());

  test('ItFollowsTheHandOnALineWithItsOrientationKept', async () => {
    await engage(page);
    await page.keyboard.press('l');
    await is(page, 'tool-now', 'line');
    await page.keyboard.press('n');
    await is(page, 'tool-now', 'n-rotation');
    const before = await tip(page);
    await page.keyboard.down('ArrowRight');
    await page.waitForTimeout(800);
    await page.keyboard.up('ArrowRight');
    await until(page, (from) => {
      const { tipX, tipY } = document.querySelector('#stats').dataset;
      return Math.hypot(tipX - from[0], tipY - from[1]) > 8;
    }, before);
    const { calls, triangles } = await page.evaluate(() => ({ ...document.querySelector('#stats').dataset }));
    assert.ok(Number(calls) <= 200 && Number(triangles) <= 200000);
  });

  test('LettingGoHoldsTheArm', async () => {
    await page.keyboard.up('Shift');
    await is(page, 'state', '^clutched$');
    await page.waitForTimeout(700);
    const held = await tip(page);
    await page.waitForTimeout(700);
    assert.ok(way(held, await tip(page)) < 1);
  });

  test('AStopStopsAndItsWayOutEngagesAgain', async () => {
    await page.keyboard.down('Shift');
    await is(page, 'state', '^engaged$');
    await page.keyboard.press('Escape');
    await is(page, 'state', '^fault$');
    await is(page, 'why', 'stop');
    await page.locator('#way-out').click();
    await is(page, 'state', '^engaged$');
    await page.keyboard.up('Shift');
  });

  test('AnObserverIsRefused', async () => {
    const observer = new Programs();
    observer.folder = programs.folder;
    const looks = await open(browser, await observer.console({ observe: true, name: 'guest', port: 0 }));
    await is(looks, 'notice', 'You are an observer');
    assert.equal(await looks.locator('[data-order="engage"]').isDisabled(), true);
    await looks.context().close();
    await observer.end('guest');
  });

  for (const name of ['slave', 'rig', 'master']) {
    test(`ARestartOfTheProgramIsSurvivedWithoutAReload ${name}`, async () => {
      await programs.end(name, 'SIGKILL');
      if (name === 'master') await is(page, 'notice', 'o news since');
      await page.waitForTimeout(500);
      await programs.start(name);
      await until(page, () => !document.querySelector('.old'));
      for (let i = 0; i < 5 && (await text(page, 'state')) !== 'off'; ++i) {
        await page.keyboard.press('r');
        await page.waitForTimeout(1500);
      }
      await engage(page);
      await page.keyboard.up('Shift');
    });
  }

  test('AGatewayThatWasStartedAnewSaysThatItsAddressIsNew', async () => {
    await programs.end('console', 'SIGKILL');
    await is(page, 'notice', 'gateway does not answer');
    const again = await programs.console();
    await is(page, 'notice', 'open the address that it printed');
    await page.goto(new URL(again).href);
    await until(page, () => document.querySelector('#state').textContent !== '–' && document.querySelector('#notice').hidden);
  });
});
