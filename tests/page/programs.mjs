// The real programs of build/release/bin, in a folder of their own, started and ended one by one.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { after, before } from 'node:test';
import { launch } from './browser.mjs';

export const BIN = process.env.HANDRAIL_BIN ?? fileURLToPath(new URL('../../build/release/bin', import.meta.url));
const DIST = fileURLToPath(new URL('../../client/console/page/dist', import.meta.url));
const START_MS = 30000;

const freePort = () => new Promise((resolve) => {
  const server = createServer().listen(0, '127.0.0.1', () => {
    const { port } = server.address();
    server.close(() => resolve(port));
  });
});

export class Programs {
  /** name -> {child, ready, argv} */
  running = new Map();

  async open({ scene = 'linear-movement' } = {}) {
    this.folder = await mkdtemp(join(tmpdir(), 'handrail-page.'));
    this.consolePort = await freePort();
    const [robot, sensor] = [await freePort(), await freePort()];
    await this.start('rig', `robot_port: ${robot} sensor_port: ${sensor} status_socket: 'rig.sock'`);
    await this.start('slave', `link_socket: 'link.sock' scene: '${scene}' robot { port: ${robot} gripper { open_output: 901 } } force_sensor { port: ${sensor} }`);
    await this.start('master', `link_socket: 'link.sock' scene: '${scene}' operator_socket: "${this.socket}" device { kind: PAGE }`);
    return this;
  }

  get socket() {
    return join(this.folder, 'operator', 'operator.sock');
  }

  /** Where the rig says what happens at its workpiece. */
  get rigSocket() {
    return join(this.folder, 'rig.sock');
  }

  /** A daemon's configuration, and another for its next start. */
  config(name) {
    return readFile(join(this.folder, `${name}.cfg`), 'utf8');
  }

  configure(name, config) {
    return writeFile(join(this.folder, `${name}.cfg`), config);
  }

  /** Starts a daemon with that configuration, or again as it was. */
  async start(name, config) {
    if (config) await this.configure(name, config);
    return this.run(name, ['--config', join(this.folder, `${name}.cfg`)]);
  }

  /** The gateway; its address comes back, and `viewers` has the one for Foxglove where there is one. */
  async console({ observe = false, name = 'console', port = this.consolePort, remote = false, more = [] } = {}) {
    const place = remote ? ['--listen', `any:${port}`, '--name', '127.0.0.1'] : ['--listen', `127.0.0.1:${port}`];
    const argv = [...place, '--socket', this.socket, '--rig', this.rigSocket, '--page', DIST, '--as', name];
    const ready = await this.run('console', [...argv, ...(observe ? ['--observe'] : []), ...more], name);
    this.viewers = /^VIEWERS (\S+)/m.exec(ready)?.[1];
    return /url=(\S+)/.exec(ready)[1];
  }

  get environment() {
    return { ...process.env, HANDRAIL_KEYS: join(this.folder, 'keys') };
  }

  /** What the command line prints; throws where it says no. */
  handrail(...argv) {
    return execFileSync(join(BIN, 'handrail'), argv, { env: this.environment, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
  }

  run(program, argv, name = program) {
    const child = spawn(join(BIN, `handrail-${program}`), argv, { cwd: this.folder, env: this.environment, stdio: ['ignore', 'pipe', 'pipe'] });
    let said = '', log = '';
    child.stderr.on('data', (text) => (log += text));
    this.running.set(name, child);
    return new Promise((resolve, reject) => {
      const late = setTimeout(() => reject(new Error(`handrail-${program} was not ready in 30 s: ${log}`)), START_MS);
      child.on('exit', (code) => reject(new Error(`handrail-${program} ended with ${code}: ${log}`)));
      child.stdout.on('data', (text) => {
        said += text;
        if (!/^READY.*\n/m.test(said)) return;
        clearTimeout(late);
        resolve(said);
      });
    });
  }

  async end(name, signal = 'SIGTERM') {
    const child = this.running.get(name);
    if (!child) return;
    this.running.delete(name);
    if (child.exitCode !== null) return;
    await new Promise((resolve) => {
      child.on('exit', resolve);
      child.kill(signal);
    });
  }

  async close() {
    for (const name of [...this.running.keys()].reverse()) await this.end(name);
    await rm(this.folder, { recursive: true, force: true });
  }
}

/** What the tests of a file share: `browser`, `programs` and the console's `url`, there while they run. */
export function sharedCell(scene) {
  const cell = {};
  before(async () => {
    cell.browser = await launch();
    cell.programs = await new Programs().open({ scene });
    cell.url = await cell.programs.console();
  });
  after(async () => {
    await cell.browser.close();
    await cell.programs.close();
  });
  return cell;
}
