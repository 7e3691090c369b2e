// A viewer as Foxglove is one: its own client, and messages read by the schema that is advertised.
import assert from 'node:assert/strict';
import ws_protocol from '@foxglove/ws-protocol';
import protobuf from 'protobufjs';
import 'protobufjs/ext/descriptor.js';
import WebSocket from 'ws';

export const PROTOCOLS = ['foxglove.sdk.v1', 'foxglove.websocket.v1'];
const { FoxgloveClient } = ws_protocol;
const FileDescriptorSet = protobuf.descriptor.FileDescriptorSet;

/** The advertised type, with its imports. */
export function typeOf(channel) {
  const root = protobuf.Root.fromDescriptor(FileDescriptorSet.decode(Buffer.from(channel.schema, 'base64')));
  root.resolveAll();
  return root.lookupType(channel.schemaName);
}

export const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Waits until `check` gives something. */
export async function until(check, what = check.toString(), patience = 20000) {
  for (const end = Date.now() + patience; Date.now() < end; await wait(20)) {
    const found = check();
    if (found) return found;
  }
  throw new Error(`waited in vain for ${what}`);
}

export class Viewer {
  /** topic -> messages {time, value, bytes} in the order they came */
  seen = new Map();
  said = [];
  problems = [];
  /** of a recording: how its player stands, and the times that are shown */
  states = [];
  times = [];

  async open(url, { protocols = PROTOCOLS, headers = {} } = {}) {
    this.socket = new WebSocket(url, protocols, { headers });
    const opened = new Promise((resolve, reject) => {
      this.socket.on('open', resolve);
      this.socket.on('unexpected-response', (_, answer) => reject(new Error(String(answer.statusCode))));
      this.socket.on('error', reject);
    });
    this.client = new FoxgloveClient({ ws: this.socket });
    this.socket.on('message', (data, binary) => binary && this.takePlayed(data));
    this.client.on('serverInfo', (info) => (this.info = info));
    this.client.on('advertise', (channels) => (this.channels = channels));
    this.client.on('status', (status) => this.said.push(status));
    this.client.on('error', (error) => this.problems.push(error));
    this.client.on('close', (event) => (this.ended = event));
    this.client.on('message', (message) => this.take(message));
    await opened;
    await until(() => this.info && this.channels, 'serverInfo and advertise');
    return this;
  }

  topics = new Map();

  subscribe(topic) {
    const channel = this.channels.find((each) => each.topic === topic);
    const id = this.client.subscribe(channel.id);
    this.topics.set(id, { topic, type: typeOf(channel) });
    this.seen.set(topic, []);
    return id;
  }

  /** What the client of npm does not know: it is in Foxglove's SDK alone. */
  takePlayed(data) {
    const bytes = new Uint8Array(data);
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    if (bytes[0] === 2) this.times.push(view.getBigUint64(1, true));
    if (bytes[0] !== 5) return;
    assert.equal(bytes.length, 19 + view.getUint32(15, true));
    this.states.push({ is: bytes[1], now: view.getBigUint64(2, true), speed: view.getFloat32(10, true), sought: bytes[14] !== 0, id: Buffer.from(bytes.subarray(19)).toString() });
  }

  take({ subscriptionId, timestamp, data }) {
    const { topic, type } = this.topics.get(subscriptionId);
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    this.seen.get(topic).push({ time: timestamp, value: type.decode(bytes), bytes: data.byteLength });
  }

  all(topic) {
    return this.seen.get(topic);
  }

  last(topic) {
    return this.all(topic).at(-1)?.value;
  }

  close() {
    this.client.close();
  }
}
