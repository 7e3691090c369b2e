// The page in both themes and sizes: nothing runs over, and a picture of each in shots/.
import assert from 'node:assert/strict';
import { mkdir } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { launch, open, until } from './browser.mjs';
import { FakeGateway } from './fake/gateway.mjs';

const shots = fileURLToPath(new URL('shots/', import.meta.url));
let browser;
before(async () => {
  await mkdir(shots, { recursive: true });
  browser = await launch();
});
after(() => browser.close());

/** What is wider or taller than what holds it, of what people read. */
function overflowing() {
  const out = [];
  const { scrollWidth, clientWidth } = document.documentElement;
  if (scrollWidth > clientWidth) out.push(`the page is ${scrollWidth} wide, the window ${clientWidth}`);
  for (const node of document.querySelectorAll('button, .fact, .card, figure, figcaption, .chip, h2')) {
    if (!(node instanceof HTMLElement) || node.offsetParent === null) continue;
    if (node.scrollWidth > node.clientWidth + 1) out.push(`${node.className || node.id} ${node.textContent}: ${node.scrollWidth} in ${node.clientWidth}`);
  }
  return out;
}

async function drive(page, scene) {
  if (scene === 'gearshift') {
    const box = await page.locator('#canvas2d').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 - 40, box.y + box.height / 2 - 55, { steps: 5 });
  } else {
    for (const key of ['e', 'l', 'n']) await page.keyboard.press(key);
    await page.keyboard.down('Shift');
    await page.keyboard.down('ArrowRight');
  }
  await page.waitForTimeout(900);
}

for (const scene of ['linear-movement', 'gearshift']) {
  for (const [width, height] of [[1280, 720], [768, 1024]]) {
    for (const theme of ['dark', 'light']) {
      test(`NothingRunsOver ${scene} ${width}x${height} ${theme}`, async () => {
        const gateway = await new FakeGateway({ scene }).listen();
        const page = await open(browser, gateway.url, { width, height, theme });
        try {
          await until(page, () => document.querySelector('#state')?.textContent !== '–');
          await drive(page, scene);
          await page.screenshot({ path: `${shots}${scene}-${width}x${height}-${theme}.png` });
          assert.deepEqual(await page.evaluate(overflowing), []);
          const stop = await page.locator('#stop').boundingBox();
          assert.ok(stop.y >= 0 && stop.y + stop.height <= height && stop.x + stop.width <= width);
          const ground = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number)[0]);
          assert.equal(ground > 128, theme === 'light');
        } finally {
          await page.context().close();
          await gateway.close();
        }
      });
    }
  }
}

test('TheThemeIsTheSystemsUntilSomebodyChoosesAndThenIsKept', async () => {
  const gateway = await new FakeGateway().listen();
  const page = await open(browser, gateway.url, { theme: 'light' });
  const bright = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number)[0] > 128);
  try {
    assert.equal(await bright(), true);
    await page.locator('#theme').click();
    assert.equal(await bright(), false);
    await page.reload();
    assert.equal(await bright(), false);
  } finally {
    await page.context().close();
    await gateway.close();
  }
});
