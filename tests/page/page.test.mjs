// The page against a made-up gateway: what it loads, sends and says. Needs `npm run build` in
// client/console/page; HANDRAIL_CHROMIUM names another browser than /usr/bin/chromium.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { launch, open, text, until } from './browser.mjs';
import { FakeGateway } from './fake/gateway.mjs';

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

let browser, gateway, page;
before(async () => (browser = await launch()));
after(() => browser.close());
beforeEach(async () => (gateway = await new FakeGateway().listen()));
afterEach(async () => {
  await page?.context().close();
  await gateway.close();
});

const start = async (options) => {
  page = await open(browser, gateway.url + (options?.query ?? ''), options);
  await until(page, () => document.querySelector('#state')?.textContent !== '–');
  return page;
};
const ordered = async (wanted) => {
  for (let i = 0; i < 100 && !gateway.orders.some(wanted); ++i) await pause(20);
  assert.ok(gateway.orders.some(wanted), `not among ${JSON.stringify(gateway.orders)}`);
};
/** Holds the dead-man by its key, until the master has seen it. */
const hold = async () => {
  await page.keyboard.down('Shift');
  for (let i = 0; i < 100 && !gateway.master.cursor.held; ++i) await pause(20);
  await pause(100);
};
const held = async (value) => {
  for (let i = 0; i < 100 && gateway.hands.at(-1)?.held !== value; ++i) await pause(20);
  assert.equal(gateway.hands.at(-1)?.held, value);
};

// Loading.

test('LoadsWithoutAnErrorOrAViolationOfItsPolicy', async () => {
  await start();
  await pause(500);
  assert.deepEqual(page.faults, []);
  assert.deepEqual(page.violations, []);
  assert.equal(await page.locator('#frame3d').isVisible(), true);
  const foreign = await page.evaluate(() => performance.getEntriesByType('resource').filter((e) => !e.name.startsWith(location.origin)).map((e) => e.name));
  assert.deepEqual(foreign, []);
});

test('AViolationOfItsPolicyWouldBeSeen', async () => {
  await start();
  await page.evaluate(() => {
    document.body.append(Object.assign(document.createElement('script'), { textContent: 'window.inline = 1' }));
    document.body.append(Object.assign(document.createElement('img'), { src: 'http://127.0.0.1:9/x.png' }));
  });
  for (let i = 0; i < 100 && page.violations.length < 2; ++i) await pause(20);
  assert.deepEqual(page.violations, ['script-src-elem inline', 'img-src http://127.0.0.1:9/x.png']);
  assert.equal(await page.evaluate(() => window.inline), undefined);
});

test('EveryButtonAndFieldHasAName', async () => {
  await start({ tour: true });
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, select, input, canvas')].filter((node) => {
    const label = node.getAttribute('aria-label') || node.textContent?.trim() || node.closest('label')?.textContent?.trim() || node.closest('[role="img"]')?.getAttribute('aria-label');
    return !label && !(node instanceof HTMLElement && node.hidden);
  }).map((node) => node.outerHTML));
  assert.deepEqual(nameless, []);
});

test('StaysWithinDrawCallsAndTriangles', async () => {
  await start({ query: '?stats' });
  await page.keyboard.press('l');
  await page.keyboard.press('f');
  await until(page, () => document.querySelector('[data-tool="F_ROTATION"]')?.getAttribute('aria-pressed') === 'true');
  await until(page, () => Number(document.querySelector('#stats').dataset.calls) > 0);
  const { calls, triangles } = await page.evaluate(() => ({ ...document.querySelector('#stats').dataset }));
  assert.ok(Number(calls) > 5 && Number(calls) <= 200, calls);
  assert.ok(Number(triangles) > 1000 && Number(triangles) <= 200000, triangles);
});

// How many a second: `tests/page/measure`.
test('DrawsWhatTheHandDoesWithoutAGraphicsCard', async () => {
  await start({ query: '?stats' });
  for (const key of ['e', 'l', 'f']) await page.keyboard.press(key);
  await ordered((o) => o.tool?.kind === 'F_ROTATION');
  await page.keyboard.down('Shift');
  await page.keyboard.down('ArrowRight');
  const drawn = () => page.evaluate(() => Number(document.querySelector('#stats').dataset.drawn));
  const first = await drawn();
  await until(page, (before) => Number(document.querySelector('#stats').dataset.drawn) > before + 15, first);
});

test('IsCoarseOnlyWhileItMovesWithoutAGraphicsCard', async () => {
  await start({ query: '?stats' });
  for (const key of ['e', 'l']) await page.keyboard.press(key);
  await ordered((o) => o.tool?.kind === 'LINE');
  await until(page, () => document.querySelector('#canvas3d').width === document.querySelector('#canvas3d').clientWidth);
  await page.keyboard.down('Shift');
  await page.keyboard.down('ArrowRight');
  await until(page, () => document.querySelector('#canvas3d').width < 0.7 * document.querySelector('#canvas3d').clientWidth);
  await page.keyboard.up('ArrowRight');
  await page.keyboard.up('Shift');
  await page.keyboard.press('d');
  await until(page, () => document.querySelector('#canvas3d').width === document.querySelector('#canvas3d').clientWidth);
});

test('DrawsNothingWhileNothingChanges', async () => {
  await start({ query: '?stats' });
  await pause(700);
  const drawn = () => page.locator('#stats').textContent().then((said) => Number(/(\d+) drawn/.exec(said)[1]));
  const first = await drawn();
  await pause(700);
  assert.ok((await drawn()) - first <= 1);
});

// Orders.

test('EachKeyGivesItsOrder', async () => {
  await start();
  await hold();
  const wanted = [
    ['e', (o) => o.engage], ['c', (o) => o.clutch === true], ['l', (o) => o.tool?.kind === 'LINE'], ['p', (o) => o.tool?.kind === 'PLANE'],
    ['o', (o) => o.tool?.kind === 'POINT'], ['n', (o) => o.tool?.kind === 'N_ROTATION'], ['f', (o) => o.tool?.kind === 'F_ROTATION'],
    ['x', (o) => o.tool_off], ['d', (o) => o.disengage], ['r', (o) => o.reset],
  ];
  for (const [key, check] of wanted) {
    await page.keyboard.press(key);
    await ordered(check);
  }
  assert.equal(gateway.orders.length, wanted.length);
});

test('TheGripperClosesAndOpensAndIsNotShownWhereThereIsNone', async () => {
  await start();
  assert.equal(await page.locator('#grip').isVisible(), false);
  await page.keyboard.press('g');
  await until(page, () => /no gripper/.test(document.querySelector('#said').textContent));
  assert.equal(gateway.orders.length, 0);
  gateway.master.status.gripper = 'between';
  await until(page, () => document.querySelector('#grip-text')?.textContent === 'Grip' && !document.querySelector('#grip').hidden);
  await page.keyboard.press('g');
  await ordered((o) => o.grip === true);
  await until(page, () => document.querySelector('#grip-text')?.textContent === 'Let go');
  await page.locator('#grip').click();
  await ordered((o) => o.grip === false);
});

test('ARecordingBeginsAndEndsByItsKeyAndIsNotShownWhereNothingIsKept', async () => {
  await start();
  assert.equal(await page.locator('#record').isVisible(), false);
  await page.keyboard.press('w');
  await until(page, () => /add recording/.test(document.querySelector('#said').textContent));
  assert.equal(gateway.orders.length, 0);
  gateway.master.status.recording = { folder: '/r' };
  await until(page, () => document.querySelector('#record-text')?.textContent === 'Record' && !document.querySelector('#record').hidden);
  await page.keyboard.press('w');
  await ordered((o) => o.record?.on === true);
  await until(page, () => document.querySelector('#record-text')?.textContent === 'End recording');
  await page.locator('#record').click();
  await ordered((o) => o.record?.on === false);
});

test('TheClutchGoesOnAndOff', async () => {
  await start();
  await hold();
  await page.keyboard.press('e');
  await ordered((o) => o.engage);
  await page.keyboard.press('c');
  await until(page, () => document.querySelector('[data-order="clutch"]')?.getAttribute('aria-pressed') === 'true');
  await page.keyboard.press('c');
  await ordered((o) => o.clutch === false);
});

test('LettersAreOrdersAgainOnceADirectionIsChosen', async () => {
  await start();
  await page.locator('#along').focus();
  await page.keyboard.press('ArrowUp');
  await page.locator('#one-way').focus();
  await page.keyboard.press('p');
  await ordered((o) => o.tool?.kind === 'PLANE');
});

test('ALineToAGoalEndsThere', async () => {
  await start();
  await page.selectOption('#along', 'goal 1');
  await page.keyboard.press('l');
  await ordered((o) => o.tool?.kind === 'LINE');
  const { tool } = gateway.orders.at(-1);
  assert.deepEqual(tool.end_mm, [350, -37.5, 329]);
  assert.equal(tool.one_way, true);
});

for (const key of ['Escape', ' ']) {
  test(`StopsBy${key === ' ' ? 'Space' : key}FromEveryFocus`, async () => {
    await start();
    for (const focus of ['[data-order="engage"]', '#scene', '#stop', '#one-way']) {
      gateway.frames.length = 0;
      await page.locator(focus).focus();
      await page.keyboard.press(key);
      await ordered((o) => o.stop);
      await pause(60);
      assert.deepEqual(gateway.orders, [{ stop: true }], focus);
    }
  });
}

test('ToolsThatTheSceneNamesHaveAButtonAndADigitEach', async () => {
  await start();
  const node = page.locator('#named-tools button');
  await until(page, () => document.querySelectorAll('#named-tools button').length === 2);
  assert.deepEqual(await node.allTextContents(), ['upright1', 'to <b>2'], 'names are text, whatever is in them');
  await page.keyboard.press('1');
  await ordered((o) => o.named_tool === 'upright');
  await until(page, () => document.querySelector('[data-named="upright"]').getAttribute('aria-pressed') === 'true');
  await node.nth(1).click();
  await ordered((o) => o.named_tool === 'to <b>');
  await until(page, () => document.querySelector('#tool-now').textContent === 'line + n-rotation');
  await page.selectOption('#scene', 'gearshift');
  await page.locator('#scene-load').click();
  await until(page, () => document.querySelector('#named-tools').hidden);
});

test('StopsWhileAnotherOrderWaitsForItsAnswer', async () => {
  await start();
  gateway.mute = true;
  await page.keyboard.press('d');
  await ordered((o) => o.disengage);
  await page.keyboard.press('Escape');
  await ordered((o) => o.stop);
  assert.equal(await page.locator('[data-order="disengage"]').getAttribute('aria-busy'), 'true', 'it waits still');
});

test('TheWayOutIsAButton', async () => {
  await start();
  await hold();
  await page.keyboard.press('Escape');
  await until(page, () => document.querySelector('#state')?.textContent === 'fault');
  await page.locator('#way-out').click();
  await until(page, () => document.querySelector('#state')?.textContent === 'engaged');
  assert.deepEqual(gateway.orders.slice(-2), [{ reset: true }, { engage: true }]);
});

test('AnEngageWaitsForTheHandAndAStopForgetsIt', async () => {
  await start();
  await page.keyboard.press('e');
  await until(page, () => /hold the ring/.test(document.querySelector('#said')?.textContent ?? ''));
  assert.deepEqual(gateway.orders, []);
  await page.keyboard.press('Escape');
  await ordered((o) => o.stop);
  await hold();
  await pause(300);
  assert.deepEqual(gateway.orders, [{ stop: true }]);
});

test('SaysWhyAnOrderWasRefused', async () => {
  await start();
  await page.keyboard.press('Escape');
  await until(page, () => document.querySelector('#state')?.textContent === 'fault');
  await page.keyboard.press('e');
  await until(page, () => document.querySelector('#said')?.textContent?.includes('engage refused: a stop was requested'));
  assert.equal(await page.locator('#said').getAttribute('data-mood'), 'bad');
});

// The dead-man.

const take = async () => {
  await start();
  await page.keyboard.press('e');
  await page.keyboard.down('Shift');
  await held(true);
  await ordered((o) => o.engage);
  await until(page, () => document.querySelector('#said')?.textContent?.startsWith('engage: done'));
};

test('IsHeldAndLetGoByAKey', async () => {
  await take();
  await page.keyboard.up('Shift');
  await held(false);
});

test('TellsTheCursorSixtyToAHundredAndTwentyFiveTimesASecond', async () => {
  await take();
  gateway.frames.length = 0;
  const started = performance.now();
  await pause(2000);
  const rate = gateway.hands.length / ((performance.now() - started) / 1000);
  assert.ok(rate > 30 && rate <= 125, `${rate} a second`); // under load timers come late, never early
  const numbers = gateway.hands.map((hand) => hand.sequence);
  assert.deepEqual(numbers, [...numbers].sort((a, b) => a - b));
});

for (const [name, why] of [['blur', 'window lost'], ['pagehide', 'page was left']]) {
  test(`IsLetGoBy${name}`, async () => {
    await take();
    await page.evaluate((kind) => window.dispatchEvent(new Event(kind)), name);
    await held(false);
    assert.match(await text(page, 'said'), new RegExp(why));
  });
}

test('IsLetGoWhenTheTabIsHidden', async () => {
  await take();
  await page.evaluate(() => {
    Object.defineProperty(document, 'visibilityState', { value: 'hidden' });
    document.dispatchEvent(new Event('visibilitychange'));
  });
  await held(false);
  assert.match(await text(page, 'said'), /tab was hidden/);
});

test('IsLetGoWhenTheSocketIsLostAndNotTakenByItself', async () => {
  await take();
  for (const socket of gateway.pages.keys()) socket.terminate();
  await until(page, () => document.querySelector('#hold')?.textContent === 'hand free');
  gateway.frames.length = 0;
  await until(page, () => document.querySelector('#state')?.textContent === 'engaged' && !document.querySelector('.old'));
  await pause(300);
  assert.ok(gateway.hands.every((hand) => !hand.held));
});

/** A gamepad that a test presses: `testPad` in the page. */
const plug = async () => {
  await start({
    init: () => {
      const effects = [];
      window.testPad = {
        index: 0, connected: true, axes: [0.9, 0, 0, 0], buttons: Array.from({ length: 17 }, () => ({ pressed: false })), effects,
        vibrationActuator: { playEffect: (_, effect) => Promise.resolve(effects.push(effect)) },
      };
      navigator.getGamepads = () => [window.testPad];
    },
  });
  await padEvent('gamepadconnected');
};
const padEvent = (kind) => page.evaluate((name) => window.dispatchEvent(Object.assign(new Event(name), { gamepad: window.testPad })), kind);

test('AGamepadThatIsUnpluggedInMotionLetsGoAndSaysSo', async () => {
  await plug();
  await page.evaluate(() => (window.testPad.buttons[5].pressed = true));
  await held(true);
  const led = () => gateway.hands.at(-1).position_mm[0] - gateway.hands[0].position_mm[0];
  for (let i = 0; i < 500 && led() <= 2; ++i) await pause(20);
  assert.ok(led() > 2, `${led()} mm`);
  await padEvent('gamepaddisconnected');
  await held(false);
  assert.match(await text(page, 'said'), /unplugged while it led/);
});

test('AGamepadTremblesInContactAndStopsByItsButton', async () => {
  await plug();
  await pause(300);
  assert.equal(await page.evaluate(() => window.testPad.effects.length), 0);
  gateway.master.tip = [350, 0, 285]; // 30 N, as the made-up master says
  await until(page, () => window.testPad.effects.some(({ strongMagnitude }) => strongMagnitude > 0.5 && strongMagnitude < 0.7));
  await page.evaluate(() => (window.testPad.buttons[1].pressed = true));
  await ordered((o) => o.stop);
});

test('TheCursorStartsWhereTheDeviceIs', async () => {
  await start();
  const device = gateway.master.status.hand.position_mm.slice();
  await page.keyboard.down('Shift');
  await held(true);
  assert.deepEqual(gateway.hands[0].position_mm, device);
});

test('DraggingTheTipLeadsAndElsewhereLooksAround', async () => {
  await start({ query: '?stats' });
  await page.keyboard.press('e');
  const frame = await page.locator('#canvas3d').boundingBox();
  await page.mouse.move(frame.x + 60, frame.y + 300);
  await page.mouse.down();
  await page.mouse.move(frame.x + 90, frame.y + 300, { steps: 3 });
  await page.mouse.up();
  assert.equal(gateway.hands.length, 0);
  const tip = await page.evaluate(() => {
    const { tipX, tipY } = document.querySelector('#stats').dataset;
    return { x: Number(tipX), y: Number(tipY) };
  });
  await page.mouse.move(frame.x + tip.x, frame.y + tip.y);
  await page.mouse.down();
  await held(true);
  await ordered((o) => o.engage);
  await page.mouse.move(frame.x + tip.x + 60, frame.y + tip.y, { steps: 6 });
  await pause(300);
  const first = gateway.hands[0].position_mm, last = gateway.hands.at(-1).position_mm;
  assert.ok(Math.hypot(...last.map((value, i) => value - first[i])) > 5);
  await page.mouse.up();
  await held(false);
});
