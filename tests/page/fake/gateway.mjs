// A gateway as the page sees it (proto/console.proto), with a made-up master: for the page's own tests.
// `node fake/gateway.mjs [PORT] [SCENE]` serves it by hand.
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { fileURLToPath } from 'node:url';
import { WebSocketServer } from 'ws';
import { FakeMaster } from './master.mjs';
import { gearshiftPng } from './png.mjs';

const DIST = new URL('../../../client/console/page/dist/', import.meta.url);
const KINDS = { html: 'text/html; charset=utf-8', js: 'text/javascript', css: 'text/css', svg: 'image/svg+xml' };
export const CSP = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

export class FakeGateway {
  constructor({ scene = 'linear-movement', role = 'OPERATOR' } = {}) {
    this.master = new FakeMaster(scene);
    this.role = role;
    this.scenes = ['gearshift', 'linear-movement', 'my own', 'plane'];
    this.pages = new Map();
    this.nextPage = 1;
    this.leader = 0;
    /** Every frame that a page sent: {page, frame}. */
    this.frames = [];
    this.problem = '';
    this.silent = false;
    /** Answers to orders are kept back while true. */
    this.mute = false;
    /** Lets nobody in, as one that was started anew: with this HTTP status. */
    this.refuses = 0;
    /** What a picture waits for: its query -> a promise. */
    this.holds = new Map();
  }

  async listen(port = 0) {
    this.server = createServer((request, response) => this.serve(request, response));
    this.sockets = new WebSocketServer({ server: this.server, path: '/ws', verifyClient: (_, answer) => answer(!this.refuses, this.refuses || 200), handleProtocols: (offered) => (offered.has('handrail.console.v1') ? 'handrail.console.v1' : false) });
    this.sockets.on('connection', (socket) => this.welcome(socket));
    await new Promise((resolve) => this.server.listen(port, '127.0.0.1', resolve));
    this.timer = setInterval(() => this.tell(), 1000 / 60);
    this.port = this.server.address().port;
    this.url = `http://127.0.0.1:${this.port}/`;
    return this;
  }

  async close() {
    clearInterval(this.timer);
    for (const socket of this.pages.keys()) socket.terminate();
    this.sockets.close();
    this.server.closeAllConnections();
    await new Promise((resolve) => this.server.close(resolve));
  }

  async serve(request, response) {
    const { pathname, search } = new URL(request.url, 'http://x');
    if (this.refuses) return response.writeHead(this.refuses).end();
    const headers = { 'Content-Security-Policy': CSP, 'X-Content-Type-Options': 'nosniff' };
    if (pathname === '/scene/map.png') await this.holds.get(search);
    if (search === '?blank') return response.writeHead(200, { ...headers, 'Content-Type': 'image/png' }).end(gearshiftPng(() => true));
    if (pathname === '/scene/map.png') return response.writeHead(200, { ...headers, 'Content-Type': 'image/png' }).end(gearshiftPng());
    const name = pathname === '/' ? 'index.html' : pathname.slice(1);
    if (!/^(index\.html|app\.js|app\.css|icon\.svg)$/.test(name)) return response.writeHead(404, headers).end();
    const body = await readFile(fileURLToPath(new URL(name, DIST)));
    return response.writeHead(200, { ...headers, 'Content-Type': KINDS[name.split('.').pop()] }).end(body);
  }

  welcome(socket) {
    const page = this.nextPage++;
    this.pages.set(socket, page);
    socket.on('message', (text) => this.hear(socket, page, JSON.parse(text)));
    socket.on('close', () => {
      this.pages.delete(socket);
      if (this.leader === page) this.setLeader(0);
    });
    this.hello(socket, page);
    this.send(socket, { scene: this.master.scene });
  }

  send(socket, frame) {
    if (socket.readyState === 1) socket.send(JSON.stringify(frame));
  }

  hello(socket, page) {
    this.send(socket, { hello: { version: 'fake', role: this.role, page, leader: this.leader, leader_text: this.leader ? `page ${this.leader}, for 3 s` : '', name: 'anna', scene: this.scenes, limits: { hand_hz_most: 125, hand_patience_ms: 200 } } });
  }

  setLeader(page) {
    this.leader = page;
    this.master.status.lease = page ? { holder: 'anna', held_s: 3 } : {};
    if (!page) this.master.move({ ...this.master.cursor, held: false });
    for (const [socket, number] of this.pages) this.hello(socket, number);
  }

  hear(socket, page, frame) {
    this.frames.push({ page, frame });
    if (frame.hand && page === this.leader) this.master.move(frame.hand);
    if (frame.lead) this.lead(socket, page, frame.lead);
    if (frame.request) this.request(socket, page, frame.request);
  }

  lead(socket, page, { id, act }) {
    const other = this.leader !== 0 && this.leader !== page;
    const refused = this.role === 'OBSERVER' ? 'an observer does not lead' : act === 'TAKE' && other ? `page ${this.leader} leads` : '';
    if (!refused) this.setLeader(act === 'RELEASE' ? 0 : page);
    this.send(socket, { reply: { id, done: !refused, reason: refused } });
  }

  request(socket, page, { id, order }) {
    const leads = page === this.leader || order.stop;
    const scene = this.master.scene;
    const refused = this.role === 'OBSERVER' ? 'an observer orders nothing' : leads ? this.master.order(order) : 'this page does not lead';
    if (scene !== this.master.scene) for (const each of this.pages.keys()) this.send(each, { scene: this.master.scene });
    if (!this.mute) this.send(socket, { reply: { id, done: !refused, reason: refused } });
  }

  tell() {
    if (this.silent) return;
    const status = this.problem ? undefined : this.master.next();
    for (const socket of this.pages.keys()) this.send(socket, { status: { status, age_ms: 2, problem: this.problem || undefined, rig: this.rig } });
  }

  /** Orders that pages gave, without how they came to lead. */
  get orders() {
    return this.frames.flatMap(({ frame }) => (frame.request ? [frame.request.order] : []));
  }

  /** The cursors that pages sent. */
  get hands() {
    return this.frames.flatMap(({ frame }) => (frame.hand ? [frame.hand] : []));
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const gateway = await new FakeGateway({ scene: process.argv[3] }).listen(Number(process.argv[2] ?? 0));
  console.log(`READY url=${gateway.url}`);
}
