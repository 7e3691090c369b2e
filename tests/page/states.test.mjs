// What the page says when something is missing, old, another's, or cannot be drawn.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { launch, open, text, until } from './browser.mjs';
import { FakeGateway } from './fake/gateway.mjs';

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const notice = (page, pattern) => until(page, (source) => {
  const node = document.querySelector('#notice');
  return node && !node.hidden && new RegExp(source).test(node.textContent);
}, pattern.source);

let browser, gateway, pages;
before(async () => (browser = await launch()));
after(() => browser.close());
beforeEach(() => (pages = []));
afterEach(async () => {
  for (const page of pages) await page.context().close();
  await gateway.close();
});

const start = async (made = {}, options = {}) => {
  gateway = await new FakeGateway(made).listen();
  return another(options);
};
const another = async (options = {}) => {
  const page = await open(browser, gateway.url, options);
  pages.push(page);
  await until(page, () => document.querySelector('#state')?.textContent !== '–');
  return page;
};
/** What `read` says once it says the same for a third of a second, something, and not `other`. */
const settled = async (read, other) => {
  let last = await read(), same = 0;
  for (let i = 0; i < 200 && same < 7; ++i) {
    await pause(50);
    const now = await read();
    same = now && now === last && now !== other ? same + 1 : 0;
    last = now;
  }
  assert.ok(same >= 7, `${last} after ${other}`);
  return last;
};

// News.

test('OldDataTurnRedAndSaySinceWhen', async () => {
  const page = await start();
  await until(page, () => document.querySelector('#age-fact')?.getAttribute('data-mood') === 'good');
  gateway.silent = true;
  await notice(page, /[Nn]o news since \d\d:\d\d:\d\d/);
  assert.equal(await page.locator('#age-fact').getAttribute('data-mood'), 'bad');
  const colour = await page.locator('#age').evaluate((node) => getComputedStyle(node).color);
  const [red, green] = colour.match(/\d+/g).map(Number);
  assert.ok(red > 200 && green < 120, colour);
  gateway.silent = false;
  await until(page, () => document.querySelector('#age-fact')?.getAttribute('data-mood') === 'good');
});

test('SaysThatTheGatewayIsAwayAndComesBackWithoutAReload', async () => {
  const page = await start();
  const { port } = gateway;
  await gateway.close();
  await notice(page, /gateway does not answer.*Trying again/);
  assert.equal(await page.locator('#stop').isDisabled(), true);
  assert.match(await page.locator('#stop').getAttribute('title'), /emergency stop/);
  gateway = await new FakeGateway().listen(port);
  await until(page, () => document.querySelector('#notice')?.hidden && !document.querySelector('.old'));
  assert.equal(await page.locator('#stop').isDisabled(), false);
});

for (const [status, says] of [[403, /started anew.*open the address/], [503, /no further page/]]) {
  test(`SaysWhyItIsNotLetIn ${status}`, async () => {
    const page = await start();
    gateway.refuses = status;
    for (const socket of gateway.pages.keys()) socket.terminate();
    await notice(page, says);
  });
}

test('SaysThatTheMasterIsAway', async () => {
  const page = await start();
  gateway.problem = 'the master does not answer: start handrail-master';
  await notice(page, /start handrail-master/);
  assert.equal(await page.locator('[data-order="engage"]').isDisabled(), true);
  gateway.problem = '';
  await until(page, () => document.querySelector('#notice')?.hidden);
});

// Who leads.

test('TwoTabsSayWhoLeadsAndTakeOver', async () => {
  const first = await start();
  await first.keyboard.press('l');
  await until(first, () => document.querySelector('#leader')?.textContent === 'this page');
  const second = await another();
  await notice(second, /Another page leads: page 1/);
  assert.equal(await second.locator('[data-order="engage"]').isDisabled(), true);
  assert.match(await second.locator('[data-order="engage"]').getAttribute('title'), /page 1 leads/);
  assert.equal(await second.locator('#stop').isDisabled(), false);
  await second.locator('#notice-button').click();
  await until(second, () => document.querySelector('#leader')?.textContent === 'this page');
  await notice(first, /Another page leads: page 2/);
});

test('AHandThatIsHeldIsLetGoWhenAnotherPageTakesOver', async () => {
  const first = await start();
  await first.keyboard.press('e');
  await first.keyboard.down('Shift');
  await until(first, () => document.querySelector('#hold')?.textContent === 'hand held');
  const second = await another();
  await second.locator('#notice-button').click();
  await until(first, () => document.querySelector('#hold')?.textContent === 'hand free');
  assert.match(await text(first, 'said'), /another page leads/);
});

test('ALeaseThatTheMasterForgotIsTakenAgainWithTheNextOrder', async () => {
  const page = await start();
  await page.keyboard.press('d');
  await until(page, () => /\(here\)/.test(document.querySelector('#lease')?.textContent ?? ''));
  gateway.master.status.lease = {};
  await until(page, () => document.querySelector('#lease')?.textContent === 'free');
  await page.keyboard.press('l');
  await until(page, () => /\(here\)/.test(document.querySelector('#lease')?.textContent ?? ''));
});

test('AHandIsLetGoWhenTheMasterIsAway', async () => {
  const page = await start();
  await page.keyboard.down('Shift');
  await until(page, () => document.querySelector('#hold')?.textContent === 'hand held');
  gateway.problem = 'the master does not answer';
  await until(page, () => document.querySelector('#hold')?.textContent === 'hand free');
});

test('AnObserverSeesAllAndOrdersNothing', async () => {
  const page = await start({ role: 'OBSERVER' });
  await notice(page, /You are an observer/);
  for (const selector of ['[data-order="engage"]', '[data-tool="LINE"]', '#stop', '#scene-load', '#lead-take']) {
    assert.equal(await page.locator(selector).isDisabled(), true, selector);
    assert.match(await page.locator(selector).getAttribute('title'), /observer/, selector);
  }
  for (const key of ['e', 'l', 'Escape', 'Shift']) await page.keyboard.press(key);
  await pause(200);
  assert.deepEqual(gateway.orders.filter((order) => !order.stop), []);
  assert.deepEqual(gateway.hands, []);
});

// Pictures.

test('ASceneThatCannotBeDrawnSaysSo', async () => {
  const page = await start({ scene: 'mystery' });
  await until(page, () => !document.querySelector('#no-picture')?.hidden);
  assert.match(await text(page, 'no-picture-text'), /cannot be drawn: no drawing of 'mystery' is known/);
  assert.equal(await page.locator('#frame3d').isVisible(), false);
});

test('AnotherSceneShowsWithoutAReload', async () => {
  const page = await start();
  await page.selectOption('#scene', 'gearshift');
  await page.locator('#scene-load').click();
  await until(page, () => !document.querySelector('#frame2d')?.hidden);
  assert.equal(await page.locator('#frame3d').isVisible(), false);
  assert.equal(await page.locator('#tools-card').isVisible(), false);
});

test('AMapThatComesLateDoesNotReplaceTheNextScenes', async () => {
  const page = await start({ scene: 'gearshift' });
  const shows = (query) => {
    const { scene } = gateway.master;
    for (const each of gateway.pages.keys()) gateway.send(each, { scene: { ...scene, map: { ...scene.map, picture: `/scene/map.png${query}` } } });
  };
  const between = () => page.evaluate(() => {
    const canvas = document.querySelector('#canvas2d');
    const scale = Number(canvas.dataset.scale);
    // Between two aisles [mm]; nothing before the first picture.
    return scale > 0 && canvas.getContext('2d').getImageData(canvas.width / 2 + 20 * scale, canvas.height / 2 - 30 * scale, 1, 1).data.join();
  });
  const wall = await settled(between);
  let release;
  gateway.holds.set('?late', new Promise((resolve) => (release = resolve)));
  shows('?late');
  shows('?blank');
  const free = await settled(between, wall);
  release();
  await pause(500);
  assert.equal(await between(), free);
});

test('TheScenesToLoadAreThoseThatTheGatewayFound', async () => {
  const page = await start();
  const names = () => page.locator('#scene option').allTextContents();
  assert.deepEqual(await names(), ['gearshift', 'linear-movement', 'my own', 'plane', 'another …']);
  assert.equal(await page.locator('#scene').inputValue(), 'linear-movement');
  await page.selectOption('#scene', 'my own');
  await page.locator('#scene-load').click();
  for (let i = 0; i < 100 && !gateway.orders.some((order) => order.scene_load); ++i) await pause(20);
  assert.ok(gateway.orders.some((order) => order.scene_load === 'my own'), JSON.stringify(gateway.orders));
});

test('WhereAPromptLeadsIsDrawnAndTheScrewThatIsTurned', async () => {
  const page = await start({ scene: 'gearshift' });
  const { walls } = gateway.master.status;
  const corner = () => page.evaluate(() => {
    const { data } = document.querySelector('#canvas2d').getContext('2d').getImageData(18, 86, 36, 36);
    return new Set(new Uint32Array(data.buffer)).size;
  });
  await page.waitForTimeout(300);
  assert.equal(await corner(), 1); // nothing but wall
  Object.assign(walls, { ball_mm: [20, -10], turned_rad: 1, screw_c: 5 });
  await until(page, () => document.querySelector('#canvas2d').dataset.ball);
  assert.ok(await page.isVisible('#key-ball'), 'the legend names it');
  const [ball, scale, green] = await page.evaluate(() => {
    const canvas = document.querySelector('#canvas2d');
    const [x, y] = canvas.dataset.ball.split(' ').map(Number);
    const [r, g, b] = canvas.getContext('2d').getImageData(x, y, 1, 1).data;
    return [[x - canvas.width / 2, y - canvas.height / 2], Number(canvas.dataset.scale), g > r && g > b];
  });
  assert.ok(Math.hypot(ball[0] - 20 * scale, ball[1] - 10 * scale) < 1, `${ball} at ${scale}`);
  assert.ok(green);
  assert.ok((await corner()) > 1, 'the screw is drawn');
  delete walls.ball_mm;
  await until(page, () => !document.querySelector('#canvas2d').dataset.ball);
  assert.ok(!(await page.isVisible('#key-ball')));
});

test('TheScrewIsTurnedAsTheSimulatedRigSaysAndAmissIsSaid', async () => {
  gateway = await new FakeGateway({}).listen();
  const { master } = gateway;
  master.scene = { ...master.scene, body: [{ kind: 'SOCKET', pose: { position_mm: [350, 0, 260], quaternion: [1, 0, 0, 0] }, size_mm: [6, 5] }] };
  const page = await another();
  await page.evaluate(() => (document.querySelector('#stats').hidden = false));
  const hidden = () => page.evaluate(() => document.querySelector('#screw').hidden);
  const drawn = () => page.evaluate(() => Number(document.querySelector('#stats').dataset.drawn));
  assert.equal(await hidden(), true, 'a real arm has none');
  const screw = { turned_deg: 123.4, depth_mm: 4.71, off_flats_deg: 1, slipped: false, jammed: false };
  gateway.rig = { scene: 'screw-fastening', moment: { force_n: [3, 4, 0], screw } };
  await until(page, () => document.querySelector('#screw-turned').textContent === '123°');
  assert.equal(await hidden(), false);
  assert.equal(await text(page, 'screw-key'), 'key 4.7 mm in, 5 N');
  assert.equal(await text(page, 'screw-trouble'), '');
  await page.screenshot({ path: 'shots/screw.png' });
  // Nothing else moves: what is drawn anew is the screw.
  const before = await settled(drawn);
  screw.turned_deg = 153.4;
  await until(page, (count) => Number(document.querySelector('#stats').dataset.drawn) > count, before);
  screw.jammed = true;
  await until(page, () => document.querySelector('#screw-trouble').textContent === 'jammed');
  screw.slipped = true;
  await until(page, () => document.querySelector('#screw-trouble').textContent === 'slipped');
  Object.assign(screw, { depth_mm: -3.2, off_flats_deg: -12 });
  await until(page, () => document.querySelector('#screw-key').textContent === 'key 3.2 mm above, fits 12° counterclockwise, 5 N');
  gateway.rig = { problem: "play: scene '<img src=x>': no such file" };
  await until(page, () => document.querySelector('#screw-trouble').textContent.includes('<img src=x>'));
  assert.equal(await page.locator('#screw img').count(), 0);
  delete gateway.rig;
  await until(page, () => document.querySelector('#screw').hidden);
  assert.deepEqual(page.faults, []);
});

test('TheLeverAndTheCursorComeApartAtAWall', async () => {
  const page = await start({ scene: 'gearshift' });
  gateway.master.status.hand.position_mm = [0, 0, 0];
  await page.waitForTimeout(200);
  const box = await page.locator('#canvas2d').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 - 60, { steps: 6 });
  await page.waitForTimeout(300);
  const hand = gateway.hands.at(-1), { walls } = gateway.master.status;
  assert.ok(hand.held && hand.position_mm[1] > 10);
  assert.ok(walls.touching && walls.proxy_mm[1] <= 7.01, JSON.stringify(walls));
  assert.equal(await text(page, 'place'), 'wall');
  await page.mouse.up();
});

test('ACursorIsToldAHundredAndTwentyFiveTimesASecondAtMostHoweverTheMouseMoves', async () => {
  const page = await start({ scene: 'gearshift' });
  const box = await page.locator('#canvas2d').boundingBox();
  const go = (x) => page.mouse.move(box.x + box.width / 2 + x, box.y + box.height / 2);
  await go(0);
  await page.mouse.down();
  await until(page, () => document.querySelector('#hold').textContent === 'hand held');
  gateway.frames.length = 0;
  const started = performance.now();
  for (let i = 0; performance.now() - started < 2000; ++i) await go(i % 40);
  const rate = gateway.hands.length / ((performance.now() - started) / 1000);
  assert.ok(rate > 30 && rate <= 126, `${rate} a second`);
  await page.mouse.up();
});

test('AFingerDragsTheLever', async () => {
  const page = await start({ scene: 'gearshift' });
  gateway.master.status.hand.position_mm = [0, 0, 0];
  await page.waitForTimeout(200);
  const box = await page.locator('#canvas2d').boundingBox();
  const x = box.x + box.width / 2, y = box.y + box.height / 2;
  const touch = await page.context().newCDPSession(page);
  await touch.send('Emulation.setTouchEmulationEnabled', { enabled: true });
  const finger = (type, ...touchPoints) => touch.send('Input.dispatchTouchEvent', { type, touchPoints });
  await finger('touchStart', { x, y });
  for (let way = 10; way <= 60; way += 10) await finger('touchMove', { x: x + way, y });
  await page.waitForTimeout(300);
  assert.ok(gateway.hands.at(-1).held && gateway.hands.at(-1).position_mm[0] > 10);
  await finger('touchEnd');
  await until(page, () => document.querySelector('#hold')?.textContent === 'hand free');
});

test('GraphicsThatAreTakenAwayAreSaidAndComeBack', async () => {
  const page = await start();
  await page.waitForTimeout(300);
  await page.evaluate(() => {
    window.lose = document.querySelector('#canvas3d').getContext('webgl2').getExtension('WEBGL_lose_context');
    window.lose.loseContext();
  });
  await until(page, () => /WebGL context lost/.test(document.querySelector('#no-picture-text')?.textContent ?? ''));
  await page.evaluate(() => window.lose.restoreContext());
  await until(page, () => !document.querySelector('#frame3d')?.hidden);
});

test('WithoutWebGlTheWallsWorkAndTheArmSaysSo', async () => {
  const plain = await launch({ webgl: false });
  try {
    gateway = await new FakeGateway().listen();
    const page = await open(plain, gateway.url);
    await until(page, () => !document.querySelector('#no-picture')?.hidden);
    assert.match(await text(page, 'no-picture-text'), /no WebGL/);
    await page.selectOption('#scene', 'gearshift');
    await page.locator('#scene-load').click();
    await until(page, () => !document.querySelector('#frame2d')?.hidden);
    await page.keyboard.press('Escape');
    await page.waitForTimeout(200);
    assert.ok(gateway.orders.some((order) => order.stop));
  } finally {
    await plain.close();
  }
});

test('TheTourLeavesTheStopButtonFreeAndIsShownOnce', async () => {
  const page = await start({}, { tour: true });
  assert.equal(await page.locator('#tour').isVisible(), true);
  await page.locator('#stop').click();
  await page.waitForTimeout(200);
  assert.ok(gateway.orders.some((order) => order.stop));
  for (let step = 0; step < 5; ++step) await page.locator('#tour-next').click();
  assert.equal(await page.locator('#tour').isVisible(), false);
  await page.reload();
  await page.waitForTimeout(300);
  assert.equal(await page.locator('#tour').isVisible(), false);
});
