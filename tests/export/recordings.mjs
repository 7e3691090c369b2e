// Recordings for the tests: read by MCAP's indexed reader and the .proto files of the sources, which the export
// does not use, and made anew of the golden ones with something changed.
import { execFile } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { McapIndexedReader, McapWriter } from '@mcap/core';
import { DuckDBInstance } from '@duckdb/node-api';
import { decompress } from 'fzstd';
import protobuf from 'protobufjs';

const ROOT = fileURLToPath(new URL('../..', import.meta.url));
const golden = (side) => join(ROOT, `tests/loopback/recording/golden/${side}.mcap`);
export const MASTER = golden('master'), SLAVE = golden('slave');
const proto = new protobuf.Root();
proto.resolvePath = (_, target) => join(ROOT, target);
proto.loadSync('proto/record.proto', { keepCase: true });
export const typeOf = (name) => proto.lookupType(`handrail.pb.${name}`);
const KINDS = { tick: 'RecordedTick', cycle: 'RecordedCycle', event: 'RecordedEvent', start: 'RecordedStart' };

export const folder = mkdtempSync(join(tmpdir(), 'handrail-export.'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
let count = 0;
export const fresh = (name = 'out') => join(folder, `${name}-${++count}`);

/** All of a recording: {messages: [{topic, at, data}], schemas, channels}. */
export async function readAll(path) {
  const bytes = readFileSync(path);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
  const decompressHandlers = { zstd: (packed, size) => decompress(packed, new Uint8Array(Number(size))) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const messages = [];
  for await (const { channelId, logTime, data } of reader.readMessages()) {
    const { topic, schemaId } = reader.channelsById.get(channelId);
    messages.push({ topic, at: logTime, data, schema: reader.schemasById.get(schemaId) });
  }
  return { messages, library: reader.header.library };
}

/** The values of a message. */
export function decode({ topic, data }) {
  return typeOf(KINDS[topic.split('/').pop()]).decode(data);
}
export const encode = (kind, value) => typeOf(kind).encode(typeOf(kind).fromObject(value)).finish();

/** A mark as an experiment sets it, at that time. */
export function mark(like, at, text) {
  return { topic: like.topic, schema: like.schema, at, data: encode('RecordedEvent', { at_ns: 1, kind: 'MARK', text, who: 'test' }) };
}

/** Writes a recording of these messages, in the order of their times. */
export async function writeAll(path, messages, { library = 'handrail 0.1.0' } = {}) {
  const parts = [];
  let position = 0n;
  const writable = {
    write: async (bytes) => {
      parts.push(Buffer.from(bytes));
      position += BigInt(bytes.length);
    },
    position: () => position,
  };
  const writer = new McapWriter({ writable, chunkSize: 100_000 });
  await writer.start({ profile: '', library });
  const schemas = new Map(), channels = new Map();
  for (const { topic, schema } of messages) {
    if (channels.has(topic)) continue;
    if (!schemas.has(schema)) schemas.set(schema, await writer.registerSchema(schema));
    channels.set(topic, await writer.registerChannel({ topic, schemaId: schemas.get(schema), messageEncoding: 'protobuf', metadata: new Map() }));
  }
  const sorted = [...messages].sort((a, b) => (a.at < b.at ? -1 : a.at > b.at ? 1 : 0));
  for (const { topic, at, data } of sorted) {
    await writer.addMessage({ channelId: channels.get(topic), sequence: 0, logTime: at, publishTime: at, data });
  }
  await writer.end();
  writeFileSync(path, Buffer.concat(parts));
  return path;
}

/** Both golden sides as one file; they are of one computer, and so their times are of one clock. */
export async function bothGolden() {
  const named = async (path, side) => (await readAll(path)).messages.map((message) => ({ ...message, topic: `/${side}${message.topic}` }));
  return [...(await named(MASTER, 'master')), ...(await named(SLAVE, 'slave'))];
}

/** {code, out, err, progress} of the export; `err` without the lines of progress. */
export function run(...argv) {
  return new Promise((resolve) => {
    execFile(join(ROOT, 'client/export/lerobot'), argv, { encoding: 'utf8', maxBuffer: 1 << 26, timeout: 120_000 }, (error, out, err) => {
      const progress = err.split('\n').filter((line) => /: \d+ %$/.test(line));
      resolve({ code: error ? error.code : 0, out, err: err.replace(/^.*: \d+ %\n/gm, ''), progress });
    });
  });
}

const duck = await (await DuckDBInstance.create(':memory:')).connect();
const rowsOf = async (sql) => (await duck.runAndReadAll(sql)).getRowObjectsJS();
export const sql = rowsOf;
export const json = (out, name) => JSON.parse(readFileSync(join(out, 'meta', name), 'utf8'));

/** What DuckDB reads of a data set. */
export async function readSet(out) {
  return {
    info: json(out, 'info.json'),
    stats: json(out, 'stats.json'),
    frames: await rowsOf(`select * from '${out}/data/*/*.parquet' order by index`),
    episodes: await rowsOf(`select * from '${out}/meta/episodes/*/*.parquet' order by episode_index`),
    tasks: await rowsOf(`select * from '${out}/meta/tasks.parquet'`),
  };
}

export const here = dirname(fileURLToPath(import.meta.url));
