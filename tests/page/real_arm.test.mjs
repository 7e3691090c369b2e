// The page with the real programs, leading the simulated arm; each of them is killed and started again.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { engage, launch, open, text, until } from './browser.mjs';
import { Programs } from './programs.mjs';

const is = (page, id, wanted) => until(page, ([node, value]) => new RegExp(value).test(document.getElementById(node).textContent), [id, wanted]);
const tip = (page) => page.evaluate(() => {
  const { tipX, tipY } = document.querySelector('#stats').dataset;
  return [Number(tipX), Number(tipY)];
});
const way = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

let browser, programs, url, page;
before(async () => {
  browser = await launch();
  programs = await new Programs().open();
  url = await programs.console();
  page = await open(browser, `${url}`);
  await page.goto(new URL('/?stats', url).href);
  await until(page, () => document.querySelector('#state').textContent === 'off');
});
after(async () => {
  await browser.close();
  await programs.close();
});

test('ItFollowsTheHandOnALineWithItsOrientationKept', async () => {
  await page.selectOption('#along', '-y');
  await engage(page);
  await page.keyboard.press('l');
  await is(page, 'tool-now', 'line');
  await page.keyboard.press('n');
  await is(page, 'tool-now', 'n-rotation');
  const before = await tip(page);
  await page.keyboard.down('ArrowRight');
  await until(page, (from) => {
    const { tipX, tipY } = document.querySelector('#stats').dataset;
    return Math.hypot(tipX - from[0], tipY - from[1]) > 8;
  }, before);
  await page.keyboard.up('ArrowRight');
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
  await engage(page);
  await page.keyboard.press('Escape');
  await is(page, 'state', '^fault$');
  await is(page, 'why', 'stop');
  await page.locator('#way-out').click();
  await is(page, 'said', 'engage: done');
  await is(page, 'state', '^engaged$');
  await page.keyboard.up('Shift');
  await is(page, 'state', '^clutched$');
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
    await engage(page);
    await programs.end(name, 'SIGKILL');
    if (name === 'master') await is(page, 'notice', 'o news since');
    else await is(page, 'state', '^fault$');
    await page.keyboard.up('Shift');
    await programs.start(name);
    await until(page, () => !document.querySelector('.old'));
    await engage(page);
    await page.keyboard.up('Shift');
    await is(page, 'state', '^(clutched|off)$');
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
