// A headless Chromium with software rendering, and the page in it.
import { chromium } from 'playwright-core';

const PATH = process.env.HANDRAIL_CHROMIUM ?? '/usr/bin/chromium';
const SOFTWARE_GL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const NO_GL = ['--disable-gpu', '--disable-3d-apis'];

export const launch = ({ webgl = true } = {}) =>
  chromium.launch({ executablePath: PATH, args: ['--no-sandbox', ...(webgl ? SOFTWARE_GL : NO_GL)] });

/** A page that keeps what went wrong in `page.faults`, and what its policy forbade in `page.violations`. */
export async function open(browser, url, { width = 1280, height = 720, theme = 'dark', tour = false, init, tls = false } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: theme, ignoreHTTPSErrors: tls });
  if (!tour) await context.addInitScript(() => localStorage.setItem('handrail.tour', 'seen'));
  if (init) await context.addInitScript(init);
  const page = await context.newPage();
  page.faults = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) page.faults.push(message.text());
  });
  page.on('pageerror', (error) => page.faults.push(String(error)));
  page.violations = [];
  await page.exposeFunction('toldOfViolation', (what) => page.violations.push(what));
  await page.addInitScript(() => {
    document.addEventListener('securitypolicyviolation', ({ effectiveDirective, blockedURI }) => {
      console.error(`CSP: ${effectiveDirective} ${blockedURI}`);
      window.toldOfViolation(`${effectiveDirective} ${blockedURI}`);
    });
  });
  await page.goto(url);
  return page;
}

/** Waits until `check` is true of the page: 20 s, as a build beside it may leave a browser little. */
export const until = (page, check, argument) => page.waitForFunction(check, argument, { timeout: 20000, polling: 50 });

export const text = (page, id) => page.locator(`#${id}`).textContent();

/** Engages as a person does: the order, then the hand; again, where a busy machine lets the cursor come too late. */
export async function engage(page) {
  for (let i = 0; i < 6; ++i) {
    await page.keyboard.up('Shift');
    await page.keyboard.press('r'); // refused where nothing is latched
    await page.waitForTimeout(300);
    await page.keyboard.press('e');
    await page.keyboard.down('Shift');
    const engaged = () => document.querySelector('#state').textContent === 'engaged' && !document.querySelector('.waits');
    if (await page.waitForFunction(engaged, null, { timeout: 4000 }).catch(() => null)) return;
  }
  throw new Error(`not engaged: ${await text(page, 'why')} ${await text(page, 'said')}`);
}
