// Reads a recording message by message, as far as it is whole, by the schemas that stand in it.
import { open } from 'node:fs/promises';
import { McapStreamReader } from '@mcap/core';
import { decompress } from 'fzstd';
import protobuf from 'protobufjs';
import descriptor from 'protobufjs/ext/descriptor/index.js';

const MAGIC = Buffer.from('\x89MCAP0\r\n', 'latin1');
const READ_BYTES = 1 << 18;
// A chunk is at most 0.1 s, some 300 kB, or one image or scene with a picture of some MB.
const CHUNK_LIMIT = 64 << 20;

// What an export reads of each message. A schema without one of these is another version's.
const FIELDS = {
  RecordedStart: ['program', 'version', 'run', 'device', 'arm', 'why'],
  RecordedDevice: ['simulated'],
  RecordedTick: ['number', 'at_ns', 'slave', 'slave_known', 'slave_age_ns', 'link', 'wrench', 'command', 'reason', 'motion', 'energy_made'],
  RecordedCycle: ['number', 'at_ns', 'q_target', 'state'],
  RecordedLink: ['loop_age_ns', 'peer_age_ns'],
  RecordedEvent: ['at_ns', 'kind', 'text'],
  MasterDatagram: ['state', 'command_pose', 'command_valid', 'position_kind', 'position_id', 'position_geometry', 'orientation_kind', 'orientation_id', 'orientation_geometry'],
  SlaveDatagram: ['command_pose', 'measured_pose', 'pose_valid', 'joints', 'wrench', 'wrench_valid', 'payload_removed'],
};
const READ = ['RecordedStart', 'RecordedTick', 'RecordedCycle', 'RecordedEvent'];

/** What is wrong with the words or a file: the message names place, value and what was expected. */
export class ExportError extends Error {}

/** The type of a schema's messages. Throws where it cannot be one that is known here. */
function typeOf(path, { name, encoding, data }) {
  if (encoding !== 'protobuf') throw new ExportError(`${path}: the schema ${name} is in '${encoding}', expected protobuf`);
  let type;
  try {
    const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(data));
    root.resolveAll();
    type = root.lookupType(name);
    for (const [message, fields] of Object.entries(FIELDS)) {
      const found = type.parent.get(message);
      if (!found) continue;
      for (const field of fields) {
        if (!found.fields[field]) throw new ExportError(`${path}: its message ${message} has no field '${field}', expected a recording of Handrail 0.1`);
      }
    }
  } catch (error) {
    if (error instanceof ExportError) throw error;
    throw new ExportError(`${path}: its schema ${name} cannot be read (${error.message}), expected a protobuf FileDescriptorSet`);
  }
  return type;
}

function unpack(bytes, size) {
  if (size > CHUNK_LIMIT) throw new Error(`a chunk of ${size} bytes, expected at most ${CHUNK_LIMIT}`);
  const out = decompress(bytes, new Uint8Array(Number(size)));
  if (out.length !== Number(size)) throw new Error(`a chunk of ${out.length} bytes, expected ${size}`);
  return out;
}

async function* pieces(path, file, progress) {
  const { size } = await file.stat();
  for (let at = 0; ; ) {
    const piece = Buffer.allocUnsafe(READ_BYTES);
    const { bytesRead } = await file.read(piece, 0, READ_BYTES, at);
    if (bytesRead === 0) return;
    at += bytesRead;
    progress(path, at / size);
    yield piece.subarray(0, bytesRead);
  }
}

function checkBeginning(path, bytes) {
  const seen = bytes.subarray(0, 8);
  if (seen.equals(MAGIC)) return;
  const version = seen[5];
  if (seen.length === MAGIC.length && Buffer.from(seen).fill(MAGIC[5], 5, 6).equals(MAGIC)) {
    throw new ExportError(`${path}: is MCAP of version '${String.fromCharCode(version)}', expected '0'`);
  }
  throw new ExportError(`${path}: begins with ${JSON.stringify(seen.toString('latin1'))}, expected an MCAP file`);
}

/** The messages that a record of the file holds, decoded. */
class Decoder {
  types = new Map();
  channels = new Map();

  constructor(path) {
    this.path = path;
  }

  /** {side, name, at, value} of a message that an export reads, else null. `at`: calendar [ns]. */
  take(record) {
    switch (record.type) {
      case 'Header':
        if (!record.library.startsWith('handrail ')) {
          throw new ExportError(`${this.path}: was written by '${record.library}', expected a recording of Handrail`);
        }
        return null;
      case 'Schema': {
        const name = record.name.replace(/^handrail\.pb\./, '');
        if (READ.includes(name)) this.types.set(record.id, { name, type: typeOf(this.path, record) });
        return null;
      }
      case 'Channel':
        this.channels.set(record.id, record);
        return null;
      case 'Message':
        return this.message(record);
      default:
        return null;
    }
  }

  message({ channelId, data, logTime }) {
    const channel = this.channels.get(channelId);
    const known = this.types.get(channel.schemaId);
    if (!known) return null;
    const side = /^\/(master|slave)\//.exec(channel.topic)?.[1] ?? '';
    return { side, name: known.name, at: logTime, value: known.type.decode(data) };
  }
}

/**
 * Reads `path` from its begin, and gives each message to `each` until the file ends or is damaged.
 * Gives what is wrong with the file: '' where it is whole. Throws ExportError where it is no recording.
 */
export async function readRecording(path, each, progress = () => {}) {
  let file;
  try {
    file = await open(path);
    if (!(await file.stat()).isFile()) throw new Error('it is no file');
  } catch (error) {
    await file?.close();
    throw new ExportError(`${path}: cannot be read: ${error.message}`);
  }
  try {
    const reader = new McapStreamReader({ decompressHandlers: { zstd: unpack } });
    const decoder = new Decoder(path);
    let begun = false;
    for await (const piece of pieces(path, file, progress)) {
      if (!begun) checkBeginning(path, piece);
      begun = true;
      const damage = takeAll(reader, decoder, piece, each);
      if (damage) return damage;
    }
    if (!begun) throw new ExportError(`${path}: is empty, expected a recording`);
    return reader.done() ? '' : 'is cut off';
  } finally {
    await file.close();
  }
}

/** What is wrong with these bytes, '' for nothing. */
function takeAll(reader, decoder, piece, each) {
  let message;
  const next = () => {
    for (let record; (record = reader.nextRecord()); ) {
      message = decoder.take(record);
      if (message) return true;
    }
    return false;
  };
  try {
    reader.append(piece);
  } catch (error) {
    return `is damaged: ${error.message}`;
  }
  for (;;) {
    try {
      if (!next()) return '';
    } catch (error) {
      if (error instanceof ExportError) throw error;
      return `is damaged: ${error.message}`;
    }
    each(message);
  }
}
