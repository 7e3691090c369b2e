// The page from another computer's point of view: TLS, the browser's warning, links that are good once.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, open, text, until } from './browser.mjs';
import { Programs } from './programs.mjs';

let browser, programs;
before(async () => {
  browser = await launch();
  programs = await new Programs().open({ scene: 'gearshift' });
  programs.handrail('keys', 'new', 'operator');
  await programs.console({ remote: true });
});
after(async () => {
  await browser.close();
  await programs.close();
});
const link = (role) => programs.handrail('keys', 'link', role).trim();
/** A page that has opened the link: by its button. */
const enter = async (url) => {
  const page = await open(browser, url, { tls: true });
  await page.click('text=Open the console');
  return page;
};

test('TheBrowserWarnsBeforeAnythingIsSentAndTheLinkIsGoodAfterwards', async () => {
  const url = link('operator');
  const page = await browser.newPage();
  await assert.rejects(page.goto(url), /ERR_CERT_AUTHORITY_INVALID/);
  await page.close();
  const inside = await enter(url);
  await until(inside, () => /hand only|off/.test(document.querySelector('#state')?.textContent ?? ''));
  assert.equal(new URL(inside.url()).search, '', 'the token is gone from the address');
  assert.deepEqual(inside.faults, []);
  assert.deepEqual(inside.violations, []);
  await inside.context().close();
});

test('ALinkFromAnotherSiteLetsInToo', async () => {
  const context = await browser.newContext({ ignoreHTTPSErrors: true });
  const page = await context.newPage();
  const url = link('operator');
  await page.route('https://mail.example/', (route) => route.fulfill({ contentType: 'text/html', body: `<a href="${url}">open</a>` }));
  await page.goto('https://mail.example/');
  await page.click('a');
  await page.click('text=Open the console');
  await until(page, () => document.querySelector('#state') && document.querySelector('#state').textContent !== '–');
  await context.close();
});

test('AnObserversLinkShowsAllAndOrdersNothing', async () => {
  const url = link('observer');
  const page = await enter(url);
  await until(page, () => /observer/.test(document.querySelector('#notice')?.textContent ?? ''));
  assert.equal(await page.locator('#stop').isDisabled(), true);
  const again = await enter(url);
  assert.match(await again.locator('body').textContent(), /opened before/);
  await again.context().close();
  programs.handrail('keys', 'unlink', programs.handrail('keys', 'links').trim().split('\n').at(-1).slice(0, 6));
  await until(page, () => /link of this page has ended/.test(document.querySelector('#notice')?.textContent ?? ''));
  assert.match(await text(page, 'notice-text'), /a new link/);
  await page.context().close();
});
