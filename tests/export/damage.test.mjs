// Files that are cut, damaged or of something else, names that are taken, and a converter that is ended: what it
// says, and that no half-written data set stays.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, readdirSync, symlinkSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { MASTER, SLAVE, bothGolden, decode, encode, folder, fresh, readAll, readSet, run, writeAll } from './recordings.mjs';

const golden = readFileSync(MASTER);
const MAIN = fileURLToPath(new URL('../../client/export/src/main.mjs', import.meta.url));
const made = (out) => [out, `${out}.part`].filter(existsSync).map((path) => basename(path));
const put = (name, bytes) => {
  const path = join(folder, name);
  writeFileSync(path, bytes);
  return path;
};
/** Runs, expects that nothing was made, and that the error says this. */
async function refused(argv, words, out = fresh()) {
  const { code, out: text, err } = await run(out, ...argv);
  assert.equal(code, 2, err);
  assert.equal(text, '');
  assert.match(err, words);
  assert.match(err, /^lerobot: [^\n]*\n$/); // a line, and no stack
  assert.deepEqual(made(out), []);
}

test('a file that is cut is read up to there', async () => {
  const whole = fresh();
  await run(whole, MASTER);
  const all = (await readSet(whole)).frames;
  let before = 0;
  for (const share of [0.4, 0.6, 0.8, 0.95, (golden.length - 1) / golden.length]) {
    const path = put(`cut-${share}.mcap`, golden.subarray(0, Math.floor(golden.length * share)));
    const out = fresh();
    const { code, out: text } = await run(out, path, '--json');
    assert.equal(code, 1);
    assert.equal(JSON.parse(text).recordings[0].damage, 'is cut off');
    const { frames } = await readSet(out);
    assert.ok(frames.length > before || share > 0.99, `${frames.length} frames of ${share}`);
    before = frames.length;
    frames.slice(0, -1).forEach((frame, i) => assert.deepEqual(frame, all[i]));
    assert.equal(frames.at(-1)['next.done'], true);
  }
  assert.equal(before, all.length);
});

test('a file that is cut in what it begins with is no recording', async () => {
  for (const length of [0, 1, 7, 8, 9, 60, 1000]) {
    await refused([put(`begin-${length}.mcap`, golden.subarray(0, length))], length === 0 ? /is empty, expected a recording/ : length < 8 ? /expected an MCAP file/ : /no message on \/start, and the file is cut off/);
  }
});

test('a bit that has changed ends the reading there, or is refused; it never makes other numbers', async () => {
  const whole = fresh();
  await run(whole, MASTER);
  const all = (await readSet(whole)).frames;
  const ends = new Set();
  for (let i = 0; i < 16; ++i) {
    const bytes = Buffer.from(golden);
    const at = Math.floor(((i + 0.37) / 16) * bytes.length);
    bytes[at] ^= 1 << i % 8;
    const out = fresh();
    const { code, out: text, err } = await run(out, put(`flip-${i}.mcap`, bytes), '--json');
    ends.add(code);
    if (code === 2) {
      assert.match(err, /^lerobot: [^\n]*\n$/);
      assert.deepEqual(made(out), []);
      continue;
    }
    const { damage } = JSON.parse(text).recordings[0];
    assert.equal(code === 1, damage !== '');
    const { frames } = await readSet(out);
    frames.slice(0, -1).forEach((frame, k) => assert.deepEqual(frame, all[k], `bit of byte ${at}`));
  }
  assert.ok(ends.has(1));
});

test('a length or a size that a file claims is not believed', async () => {
  const bytes = Buffer.from(golden);
  let chunk = 8; // where the first begins: an opcode, a length, what it holds
  while (bytes[chunk] !== 6) chunk += 9 + Number(bytes.readBigUInt64LE(chunk + 1));
  for (const [name, at, value, words] of [
    ['length', chunk + 1, 1n << 62n, /no message on \/start, and the file is/],
    ['size', chunk + 9 + 16, 1n << 31n, /is damaged: a chunk of 2147483648 bytes, expected at most 67108864/],
  ]) {
    const changed = Buffer.from(bytes);
    changed.writeBigUInt64LE(value, at);
    await refused([put(`claims-${name}.mcap`, changed)], words);
  }
});

test('what is no recording is refused, with what it is', async () => {
  await refused([join(folder, 'not-there.mcap')], /not-there\.mcap: cannot be read: ENOENT/);
  await refused([folder], /cannot be read: it is no file/);
  await refused([put('text.mcap', 'a text of some length, and no recording')], /text\.mcap: begins with "a text o", expected an MCAP file/);
  const version = Buffer.from(golden);
  version[5] = 0x31;
  await refused([put('version.mcap', version)], /is MCAP of version '1', expected '0'/);
  await refused([SLAVE], /is a slave's recording, expected a master's/);
  const { messages } = await readAll(MASTER);
  await refused([await writeAll(join(folder, 'other.mcap'), messages, { library: 'someone 1.0' })], /was written by 'someone 1.0', expected a recording of Handrail/);
  await refused([await writeAll(join(folder, 'no-start.mcap'), messages.filter(({ topic }) => topic !== '/start'))], /has no message on \/start; expected/);
  await refused([await writeAll(join(folder, 'no-tick.mcap'), messages.filter(({ topic }) => topic !== '/tick'))], /has no tick; expected at least one/);
});

test('a schema that lacks a field is another version\'s, and one that is none is told', async () => {
  const { messages } = await readAll(MASTER);
  const other = (change) => {
    const schemas = new Map();
    return messages.map((message) => {
      const { schema } = message;
      if (!schemas.has(schema)) schemas.set(schema, { ...schema, data: change(schema) });
      return { ...message, schema: schemas.get(schema) };
    });
  };
  // The field keeps its number, and its name is another one of the same length.
  const renamed = ({ data }) => {
    const bytes = Buffer.from(data);
    for (let at; (at = bytes.indexOf('energy_made')) >= 0; ) bytes.write('energy_mode', at);
    return bytes;
  };
  await refused([await writeAll(join(folder, 'renamed.mcap'), other(renamed))], /message RecordedTick has no field 'energy_made', expected a recording of Handrail 0\.1/);
  await refused([await writeAll(join(folder, 'schema.mcap'), other(() => Buffer.from('nonsense')))], /its schema handrail\.pb\.\w+ cannot be read/);
});

test('numbers that a message lacks or that are none are named', async () => {
  const { messages } = await readAll(MASTER);
  const changed = (change) => messages.map((message) => {
    if (message.topic !== '/tick') return message;
    const tick = decode(message);
    if (Number(tick.number) !== 1500) return message;
    change(tick);
    return { ...message, data: encode('RecordedTick', tick) };
  });
  await refused([await writeAll(join(folder, 'short.mcap'), changed((tick) => tick.motion.pop()))], /short\.mcap: tick 1500: motion has 23 numbers, expected 24/);
  await refused([await writeAll(join(folder, 'none.mcap'), changed((tick) => delete tick.command))], /tick 1500: has no command, expected one/);
  const nan = messages.map((message) => {
    if (message.topic !== '/tick') return message;
    const tick = decode(message);
    if (Number(tick.number) >= 1500) tick.wrench[2] = NaN;
    return { ...message, data: encode('RecordedTick', tick) };
  });
  await refused([await writeAll(join(folder, 'nan.mcap'), nan)], /tick 15\d\d: hand_wrench\[2\] is NaN, expected a finite number/);
});

test('words that are wrong are answered', async () => {
  for (const [argv, words] of [
    [[], /no folder and no recording is named, expected OUT RECORDING/],
    [[fresh()], /no recording is named/],
    [[fresh(), MASTER, '--fps'], /unknown option '--fps', expected --json, --simulated or --help/],
    [[join(folder, 'no', 'such'), MASTER], /no: is not there, expected the folder/],
  ]) {
    const { code, err } = await run(...argv);
    assert.equal(code, 2);
    assert.match(err, words);
  }
  symlinkSync(MASTER, join(folder, 'link.mcap'));
  await refused([MASTER, join(folder, 'link.mcap')], /link\.mcap: is named twice, first as .*master\.mcap/);
  const both = await writeAll(join(folder, 'both.mcap'), await bothGolden());
  await refused([MASTER, both], /both\.mcap: is both sides', and .*master\.mcap is a master's alone; expected one kind/);
  const { code, out } = await run('--help');
  assert.equal(code, 0);
  assert.match(out, /^lerobot OUT RECORDING\.\.\./);
});

test('what is there already stays as it is', async () => {
  for (const kind of ['folder', 'file', 'link', 'part']) {
    const out = fresh();
    if (kind === 'folder') mkdirSync(out);
    if (kind === 'file') writeFileSync(out, 'mine');
    if (kind === 'link') symlinkSync('/nowhere', out);
    if (kind === 'part') {
      mkdirSync(`${out}.part`);
      writeFileSync(join(`${out}.part`, 'mine'), 'mine');
    }
    const { code, err } = await run(out, MASTER);
    assert.equal(code, 2);
    assert.match(err, kind === 'part' ? /\.part: is there, of an export that was killed or still runs/ : /is there already, expected a name that is free/);
    if (kind === 'folder') assert.deepEqual(readdirSync(out), []);
    if (kind === 'file') assert.equal(readFileSync(out, 'utf8'), 'mine');
    if (kind === 'part') assert.deepEqual(readdirSync(`${out}.part`), ['mine']);
  }
});

test('Ctrl-C and an end from outside leave nothing behind', async () => {
  const files = Array.from({ length: 5 }, (_, i) => put(`many-${i}.mcap`, golden));
  for (const [signal, expected] of [['SIGINT', 130], ['SIGTERM', 143]]) {
    const out = fresh();
    const child = spawn(process.execPath, [MAIN, out, ...files], { stdio: ['ignore', 'pipe', 'pipe'] });
    let err = '';
    child.stderr.on('data', (text) => (err += text));
    const ended = new Promise((resolve) => child.on('exit', (code) => resolve(code)));
    while (!existsSync(join(`${out}.part`, 'data'))) {
      assert.equal(child.exitCode, null, err);
      await new Promise((resolve) => setTimeout(resolve, 5));
    }
    child.kill(signal);
    assert.equal(await ended, expected);
    assert.match(err, /lerobot: interrupted, nothing was made\n$/);
    assert.deepEqual(made(out), []);
  }
});

test('long work says how far it is', async () => {
  const { code, progress } = await run(fresh(), ...Array.from({ length: 8 }, (_, i) => put(`long-${i}.mcap`, golden)));
  assert.equal(code, 0);
  assert.ok(progress.length > 0);
  for (const line of progress) assert.match(line, /^lerobot: (looking through|converting) \S+long-\d+\.mcap: \d+ %$/);
});

test('a disk that is full is told, and nothing stays', async () => {
  const child = spawn('bash', ['-c', 'ulimit -f 20; trap "" XFSZ; exec "$@"', '-', process.execPath, MAIN, join(folder, 'full'), MASTER], { stdio: ['ignore', 'pipe', 'pipe'] });
  let err = '';
  child.stderr.on('data', (text) => (err += text));
  assert.equal(await new Promise((resolve) => child.on('exit', resolve)), 2);
  assert.match(err, /^lerobot: \S+full\.part: cannot be written: EFBIG[^\n]*\n$/m);
  assert.deepEqual(made(join(folder, 'full')), []);
});

