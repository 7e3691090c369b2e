// What the console does, in numbers: from the hand to the force and back, until a page is ready, how true
// its data age is, what viewers cost the haptic loop, what strangers cost those inside.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { readFile } from 'node:fs/promises';
import http from 'node:http';
import https from 'node:https';
import net from 'node:net';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import { engage, open, until } from './browser.mjs';

export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
export const quantile = (values, share) => {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.max(0, Math.ceil(share * sorted.length) - 1)];
};
const monotonic = () => Number(process.hrtime.bigint()) / 1e6; // CLOCK_MONOTONIC, as the gateway's [ms]

/** In a page, before all else: keeps when statuses came, moves, and what the age said. */
function listen() {
  window.seen = { statuses: [], moves: [], ages: [] };
  const Native = window.WebSocket;
  window.WebSocket = class extends Native {
    constructor(...how) {
      super(...how);
      this.addEventListener('message', ({ data }) => {
        const at = performance.now(), news = JSON.parse(data).status;
        if (!news?.status) return;
        const { status } = news;
        window.seen.statuses.push({ at, gateway: (news.gateway_s ?? 0) * 1e3, age: news.age_ms ?? 0, cursor: status.haptic?.cursor?.position_mm ?? [], force: status.device_force?.magnitude_n ?? 0 });
      });
    }
  };
  window.addEventListener('pointermove', ({ timeStamp }) => window.seen.moves.push(timeStamp), true);
  addEventListener('DOMContentLoaded', () => {
    const age = document.getElementById('age');
    new MutationObserver(() => window.seen.ages.push([performance.now(), Number(age.textContent)])).observe(age, { childList: true, characterData: true, subtree: true });
  });
}

/** From a pointer's move to the status that has its cursor, and to the one that has its force [ms]. */
export async function handToForceAndBack(browser, url, count = 60) {
  const page = await open(browser, url, { init: listen });
  await until(page, () => !document.querySelector('#frame2d').hidden);
  await pause(1000);
  const box = await page.locator('#canvas2d').boundingBox();
  const scale = await page.evaluate(() => Number(document.querySelector('#canvas2d').dataset.scale));
  const go = (x, y) => page.mouse.move(box.x + box.width / 2 + x * scale, box.y + box.height / 2 - y * scale);
  await go(0, 0);
  await page.mouse.down();
  await until(page, () => document.querySelector('#hold').textContent === 'hand held');
  await page.mouse.move(box.x + box.width / 2 + 20 * scale, box.y + box.height / 2, { steps: 15 });
  await pause(500);
  const cursor = [], force = [];
  for (let i = 0; i < count; ++i) {
    // Into a wall and out of it again.
    await page.evaluate(() => (window.seen.moves.length = 0));
    await go(20, i % 2 === 0 ? 30 : 0);
    await pause(250 + 17 * (i % 7));
    const [c, f] = await page.evaluate(() => {
      const { moves, statuses } = window.seen;
      const before = statuses.findLast((s) => s.at < moves[0]), settled = statuses.at(-1);
      const first = (differs) => (statuses.find((s) => s.at >= moves[0] && differs(s))?.at ?? Infinity) - moves[0];
      // Half of the way to where the force comes to rest.
      const way = settled.force - before.force;
      return [first((s) => Math.abs(s.cursor[1] - before.cursor[1]) > 5), Math.abs(way) < 1 ? null : first((s) => (s.force - before.force) / way >= 0.5)];
    });
    cursor.push(c);
    if (f !== null) force.push(f);
  }
  await page.mouse.up();
  await page.context().close();
  return { cursor, force };
}

/** From the address to a page that shows the master's state and a picture, by the page's own clock [ms]. */
export async function pageReady(browser, url, count = 9) {
  const out = [];
  for (let i = 0; i < count; ++i) {
    const page = await open(browser, url);
    const ready = await page.waitForFunction(() => {
      const state = document.querySelector('#state');
      const drawn = !document.querySelector('#frame2d').hidden || !document.querySelector('#frame3d').hidden;
      return state && state.textContent !== '–' && drawn && performance.now();
    }, null, { timeout: 20000, polling: 'raf' });
    out.push(await ready.jsonValue());
    await page.context().close();
  }
  return out;
}

/** How far the age that is shown is from the true one, in whole ms, for some seconds; and how well that is known. */
export async function dataAge(browser, url, seconds = 5) {
  const page = await open(browser, url, { init: listen });
  await until(page, () => document.querySelector('#state').textContent !== '–');
  await pause(1000);
  const offsets = [];
  for (let i = 0; i < 50; ++i) {
    const before = monotonic(), there = await page.evaluate(() => performance.now()), after = monotonic();
    offsets.push({ offset: (before + after) / 2 - there, error: (after - before) / 2 });
  }
  const { offset, error } = offsets.sort((a, b) => a.error - b.error)[0];
  await page.evaluate(() => (window.seen.ages.length = 0));
  await pause(1000 * seconds);
  const { ages, statuses } = await page.evaluate(() => window.seen);
  await page.context().close();
  const wrong = ages.flatMap(([at, shown]) => {
    const newest = statuses.findLast((s) => s.at <= at);
    return newest ? [shown - (at + offset - newest.gateway + newest.age)] : [];
  });
  return { wrong, error };
}

/** A cookie of a session, by the printed address or a link. */
export async function cookieOf(url) {
  const opened = url.startsWith('https:') // a link, by its button
    ? https.request(url, { method: 'POST', headers: { origin: new URL(url).origin }, rejectUnauthorized: false }).end()
    : http.get(url);
  const [response] = await once(opened, 'response');
  response.resume();
  return response.headers['set-cookie'][0].split(';')[0];
}

/** Pages without a picture, in a process of the lowest priority: frames a second of each, when it is ended. */
export async function viewers(url, count) {
  const cookie = await cookieOf(url);
  const script = fileURLToPath(new URL('viewers.mjs', import.meta.url));
  const child = spawn('nice', ['-n', '19', process.execPath, script, new URL(url).origin, cookie, String(count)], { stdio: ['pipe', 'pipe', 'inherit'] });
  const [ready] = await once(child.stdout, 'data');
  if (!String(ready).startsWith('open')) throw new Error(`viewers: ${ready}`);
  return {
    async end() {
      child.stdin.end();
      const [rates] = await once(child.stdout, 'data');
      return JSON.parse(String(rates));
    },
  };
}

/** The haptic loop's 99.9 % lateness [us] of a master that was started for it and ran for so long; with what `join` gives. */
async function lateness(programs, seconds, join = async () => {}) {
  await programs.end('master');
  await programs.start('master');
  const company = await join();
  await pause(1000 * seconds);
  const status = JSON.parse(programs.handrail('status', '--json', '--socket', programs.socket));
  if (Number(status.ticks) < 800 * seconds) throw new Error(`the loop ran ${status.ticks} times in ${seconds} s`);
  return { late: status.loop_lateness_us.p999, company };
}

/** Windows in turn, of a master that has no recorder and of one that writes everything down: lateness of each. */
export async function recordingCost(programs, { rounds = 9, seconds = 5 } = {}) {
  const plain = await programs.config('master');
  const without = [], with_ = [];
  for (let i = 0; i < rounds; ++i) {
    await programs.configure('master', plain);
    // Someone calls in both: what a call costs is not the recorder's.
    without.push((await lateness(programs, seconds, async () => programs.handrail('status', '--socket', programs.socket))).late);
    await programs.configure('master', `${plain} recording { folder: 'recordings' }`);
    with_.push((await lateness(programs, seconds, async () => programs.handrail('record', 'start', '--socket', programs.socket))).late);
  }
  await programs.configure('master', plain);
  return { without, with: with_ };
}

/** Windows in turn, without and with viewers: lateness of each, and the slowest viewer's frames a second. */
export async function viewersCost(programs, url, { count = 20, rounds = 9, seconds = 5 } = {}) {
  const without = [], with_ = [], slowest = [];
  for (let i = 0; i < rounds; ++i) {
    without.push((await lateness(programs, seconds)).late);
    // They come once the master runs: what it does not tell while it starts is not theirs to miss.
    const { late, company: crowd } = await lateness(programs, seconds, () => viewers(url, count));
    with_.push(late);
    slowest.push(Math.min(...await crowd.end()));
  }
  return { without, with: with_, slowest };
}

/** So many WebSockets at once, again each second: what the first ones and the later ones are told, and the loop's lateness in windows without and with them. */
export async function crowd(programs, url, { count = 1000, rounds = 3, seconds = 5 } = {}) {
  const cookie = await cookieOf(url);
  const script = fileURLToPath(new URL('crowd.mjs', import.meta.url));
  const without = [], with_ = [], first = [], later = [];
  for (let i = 0; i < rounds; ++i) {
    without.push((await lateness(programs, seconds)).late);
    const child = spawn('nice', ['-n', '19', process.execPath, script, new URL(url).origin, cookie, String(count)], { stdio: ['pipe', 'pipe', 'inherit'] });
    const lines = createInterface(child.stdout)[Symbol.asyncIterator]();
    first.push(JSON.parse((await lines.next()).value));
    with_.push((await lateness(programs, seconds)).late);
    child.stdin.end();
    later.push(JSON.parse((await lines.next()).value));
  }
  return { without, with: with_, first, later };
}

/** In a page, before all else: pictures are cleared, and nothing is drawn into them. */
function drawNothing() {
  const { prototype } = window.WebGL2RenderingContext;
  prototype.drawArrays = prototype.drawElements = prototype.drawArraysInstanced = prototype.drawElementsInstanced = () => {};
}

/** Pictures of the arm that are drawn in a second while the hand leads it, without a graphics card: a value each second. */
export async function pictures(browser, url, { seconds = 10, empty = false } = {}) {
  const page = await open(browser, url, empty ? { init: drawNothing } : {});
  await page.goto(new URL('/?stats', url).href);
  await until(page, () => document.querySelector('#state').textContent === 'off');
  await engage(page);
  await page.keyboard.press('l');
  const drawn = () => page.evaluate(() => [Number(document.querySelector('#stats').dataset.drawn), performance.now()]);
  const rates = [];
  for (let i = 0, last = await drawn(); i < seconds; ++i) {
    const key = i % 2 ? 'ArrowLeft' : 'ArrowRight';
    await page.keyboard.down(key);
    await pause(1000);
    await page.keyboard.up(key);
    const [count, at] = await drawn();
    rates.push((1000 * (count - last[0])) / (at - last[1]));
    last = [count, at];
  }
  await page.context().close();
  return rates;
}

const memory = async (pid) => Number(/VmRSS:\s+(\d+)/.exec(await readFile(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;

/** A thousand that say what they want a byte a second, or half a greeting: how long others wait [ms], how the gateway grows [MiB]. */
export async function strangers(programs, url, count = 1000, seconds = 10) {
  const { port, protocol } = new URL(url);
  const encrypted = protocol === 'https:';
  const cookie = await cookieOf(url);
  const pid = programs.running.get('console').pid;
  const before = await memory(pid);
  const start = encrypted ? Buffer.from([0x16, 3, 1, 2, 0, 1]) : 'GET / HTTP/1.1\r\nX: ';
  const sockets = [];
  const call = () => {
    const socket = net.connect(Number(port), '127.0.0.1', () => socket.write(start));
    socket.on('error', () => {}).on('close', () => sockets.splice(sockets.indexOf(socket), 1));
    sockets.push(socket);
  };
  const drip = setInterval(() => {
    for (const socket of sockets) socket.write(encrypted ? Buffer.from([0]) : 'x');
    while (sockets.length < count) call(); // who is closed calls again
  }, 1000);
  while (sockets.length < count) call();
  const waits = [];
  let most = before;
  for (const end = monotonic() + 1000 * seconds; monotonic() < end;) {
    const begin = monotonic();
    // The whole page, as it is loaded.
    const request = (encrypted ? https : http).get(`${new URL(url).origin}/app.js`, { headers: { cookie }, rejectUnauthorized: false, agent: false });
    const [response] = await once(request, 'response');
    if (response.statusCode !== 200) throw new Error(`status ${response.statusCode}`);
    response.resume();
    await once(response, 'end');
    waits.push(monotonic() - begin);
    most = Math.max(most, await memory(pid));
    await pause(100);
  }
  clearInterval(drip);
  for (const socket of [...sockets]) socket.destroy();
  return { waits, growth: most - before };
}
