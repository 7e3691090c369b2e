// A recording of the real programs, opened by the reader that MCAP's own people keep: its index, its schemas and
// its counts are what it says, and it agrees with our own.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { open, readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { McapIndexedReader, McapStreamReader } from '@mcap/core';
import { decompress } from 'fzstd';
import protobuf from 'protobufjs';
import descriptor from 'protobufjs/ext/descriptor/index.js';
import { until, wait } from './foxglove.mjs';
import { BIN, Programs } from './programs.mjs';

const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };
const programs = new Programs();
let files;

/** A file as @mcap/core reads it, by its index. */
const indexed = async (path) => {
  const file = await open(path);
  const { size } = await file.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const out = new Uint8Array(Number(length));
      const { bytesRead } = await file.read(out, 0, out.length, Number(offset));
      assert.equal(bytesRead, out.length);
      return out;
    },
  };
  return McapIndexedReader.Initialize({ readable, decompressHandlers });
};

/** channel id -> what decodes its messages, by the schema in the file. */
const types = (reader) => new Map([...reader.channelsById.values()].map(({ id, schemaId, topic }) => {
  const { name, encoding, data } = reader.schemasById.get(schemaId);
  assert.equal(encoding, 'protobuf');
  const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(data));
  return [id, { topic, type: root.lookupType(name) }];
}));

before(async () => {
  await programs.open();
  const recording = " recording { folder: 'rec' }";
  for (const name of ['master', 'slave']) {
    await programs.end(name);
  }
  for (const name of ['slave', 'master']) {
    const config = await readFile(join(programs.folder, `${name}.cfg`), 'utf8');
    await programs.start(name, config + recording);
  }
  await until(() => {
    try {
      return programs.handrail('status', '--socket', programs.socket).includes('tip');
    } catch {
      return false;
    }
  }, 'a slave with an arm');
  programs.handrail('record', 'start', 'core', '--socket', programs.socket);
  await wait(1500);
  programs.handrail('record', 'mark', 'now', '--socket', programs.socket);
  programs.handrail('record', 'stop', '--socket', programs.socket);
  const folder = join(programs.folder, 'rec');
  await until(() => {
    files = existsSync(folder) ? readdirSync(folder).map((name) => join(folder, name)) : [];
    const whole = (path) => readFileSync(path).subarray(-8).toString('latin1') === '\x89MCAP0\r\n';
    return files.length === 2 && files.every(whole);
  }, 'two whole files');
});
after(() => programs.close());

test('@mcap/core finds by the index what our own reader finds in order', async () => {
  for (const path of files) {
    const reader = await indexed(path);
    assert.match(reader.header.library, /^handrail /);
    const known = types(reader);
    const counts = {};
    let last = 0n;
    for await (const { channelId, logTime, data } of reader.readMessages()) {
      assert.ok(logTime >= last);
      last = logTime;
      const { topic, type } = known.get(channelId);
      type.decode(data); // throws where it is none
      counts[topic] = (counts[topic] ?? 0) + 1;
    }
    const { statistics } = reader;
    assert.equal(Object.values(counts).reduce((a, b) => a + b), Number(statistics.messageCount));
    for (const [id, count] of statistics.channelMessageCounts) assert.equal(counts[known.get(id).topic], Number(count));
    assert.equal(counts['/start'], 1);
    assert.ok(counts['/image'] >= 1);
    const ours = JSON.parse(execFileSync(join(BIN, 'handrail-lab'), ['replay', path, '--json'], { encoding: 'utf8' }));
    assert.equal(ours.different, 0);
    assert.equal(ours.entries, counts['/tick'] ?? counts['/cycle']);
    assert.equal(ours.damage, '');
  }
});

test('ticks are a millisecond apart in the file, and say what the hand did', async () => {
  const reader = await indexed(files.find((path) => path.includes('-master-')));
  const { type } = [...types(reader).values()].find(({ topic }) => topic === '/tick');
  let number = 0, first, count = 0;
  for await (const { data, logTime } of reader.readMessages({ topics: ['/tick'] })) {
    const tick = type.decode(data);
    first ??= logTime;
    if (number) assert.equal(Number(tick.number), number + 1);
    number = Number(tick.number);
    assert.equal(tick.hand.length, 10);
    assert.equal(tick.force.length, 24);
    ++count;
  }
  assert.ok(count > 1000);
});

test('datagrams stand there as they went: the joints that were ordered, and the same bytes on both sides of the link', async () => {
  const sides = {};
  for (const side of ['master', 'slave']) {
    const reader = await indexed(files.find((path) => path.includes(`-${side}`)));
    const known = types(reader);
    const rows = (sides[side] = []);
    for await (const { channelId, data } of reader.readMessages()) {
      const { topic, type } = known.get(channelId);
      if (topic === '/packet' || topic === '/cycle') rows.push({ topic, ...type.decode(data) });
    }
  }
  const ways = (side) => {
    const out = {};
    for (const { topic, way } of sides[side]) if (topic === '/packet') out[way] = (out[way] ?? 0) + 1;
    return out;
  };
  const [linkIn, linkOut, robotIn, robotOut, sensorIn] = [0, 1, 2, 3, 4];
  assert.deepEqual(Object.keys(ways('master')).map(Number).sort(), [linkIn, linkOut]);
  const of = ways('slave');
  for (const [way, least] of [[linkIn, 1000], [linkOut, 1000], [robotIn, 150], [robotOut, 150], [sensorIn, 500]]) {
    assert.ok(of[way] >= least, `${way}: ${of[way]} of at least ${least}`);
  }
  const packets = (side, wanted) => sides[side].filter(({ topic, way }) => topic === '/packet' && way === wanted).map(({ packet }) => Buffer.from(packet).toString('hex'));
  // The files begin and end at moments of their own: of what one has heard within both, all was sent.
  const sent = new Set(packets('master', linkOut));
  const heard = packets('slave', linkIn);
  assert.ok(heard.filter((packet) => sent.has(packet)).length > 0.8 * Math.min(heard.length, sent.size));
  const whole = heard.slice(heard.findIndex((packet) => sent.has(packet)), heard.findLastIndex((packet) => sent.has(packet)) + 1);
  assert.ok(whole.every((packet) => sent.has(packet)));
  // MXT's command block: six 32-bit numbers from byte 8 on.
  const order = sides.slave.filter(({ topic, way }) => topic === '/cycle' || way === robotOut).sort((a, b) => Number(a.at_ns) - Number(b.at_ns));
  let compared = 0;
  order.forEach(({ topic, send, q_target: target }, i) => {
    if (topic !== '/cycle' || send !== 1 || order[i + 1]?.topic !== '/packet') return;
    const bytes = Buffer.from(order[i + 1].packet);
    for (let j = 0; j < 6; ++j) assert.equal(bytes.readFloatLE(8 + 4 * j), Math.fround(target[j]));
    ++compared;
  });
  assert.ok(compared > 100, `${compared} orders`);
});

test('a file that was cut is read by the stream reader up to there', async () => {
  const path = files.find((name) => name.includes('-slave'));
  const bytes = await readFile(path);
  const cut = bytes.subarray(0, Math.floor(bytes.length * 0.7));
  const stream = new McapStreamReader({ decompressHandlers });
  stream.append(cut);
  let messages = 0;
  for (let record; (record = stream.nextRecord());) messages += record.type === 'Message';
  assert.ok(messages > 50);
});
