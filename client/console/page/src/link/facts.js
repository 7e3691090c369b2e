// What the page knows at this moment, and how old it is. Written by what the gateway sends, read by
// everything that draws.

/** @typedef {import('./wire.d.ts').Hello} Hello */
/** @typedef {import('./wire.d.ts').Status} Status */
/** @typedef {import('./wire.d.ts').SceneNews} SceneNews */
/** @typedef {import('./gateway.js').Gateway} Gateway */

export const OLD_MS = 500; // what is older than this is shown as old: a person would act on it

export class Facts {
  /** @param {Gateway} gateway */
  constructor(gateway) {
    this.connected = false;
    /** @type {Hello} */
    this.hello = {};
    /** @type {Status} */
    this.status = {};
    /** @type {SceneNews} */
    this.scene = {};
    /** Why the master says nothing; empty: it does. */
    this.problem = '';
    /** Why the master does not take our cursor; empty: it does. */
    this.cursorRefused = '';
    this.hasStatus = false;
    /** What the simulated rig says; null: nobody told of one, as of a real arm. @type {import('./wire.d.ts').RigNews | null} */
    this.rig = null;
    /** The recording that is shown; null: it is live. @type {import('./wire.d.ts').RecordingNews | null} */
    this.recording = null;
    /** Where its player stands. @type {import('./wire.d.ts').PlayNews} */
    this.play = {};
    /** When the newest status was true, performance.now() [ms]. */
    this.trueAt = -Infinity;
    /** The same as a time of day. @type {Date | null} */
    this.trueAtDate = null;
    /** Counts statuses: what draws can see whether there is a newer one. */
    this.version = 0;
    /** @type {(() => void)[]} */
    this.onScene = [];
    /** The names of scenes that the gateway found. @type {string[]} */
    this.sceneNames = [];
    gateway.on('open', () => (this.connected = true));
    gateway.on('closed', () => this.lost());
    gateway.on('hello', (hello) => {
      this.hello = hello;
      this.sceneNames = hello.scene ?? [];
      this.recording = hello.recording ?? null;
    });
    gateway.on('scene', (scene) => this.setScene(scene));
    gateway.on('status', (news) => this.setStatus(news));
    gateway.on('hand', (news) => (this.cursorRefused = news.taken ? '' : news.reason ?? 'refused'));
  }

  lost() {
    this.connected = false;
    this.hello = {};
    this.cursorRefused = '';
  }

  /** @param {SceneNews} scene */
  setScene(scene) {
    this.scene = scene;
    for (const listener of this.onScene) listener();
  }

  /** @param {import('./wire.d.ts').StatusNews} news */
  setStatus(news) {
    this.problem = news.problem ?? '';
    this.rig = news.rig ?? null;
    this.play = news.play ?? {};
    if (!news.status) {
      if (!this.problem) this.problem = 'the master gives no status';
      if (this.recording) this.trueAt = performance.now(); // a moment that cannot be read is no silence
      return;
    }
    this.status = news.status;
    this.hasStatus = true;
    const age = news.age_ms ?? 0;
    this.trueAt = performance.now() - age;
    this.trueAtDate = new Date(Date.now() - age);
    this.version += 1;
  }

  /** Age of what is shown [ms]; Infinity: nothing came yet. */
  age() {
    return performance.now() - this.trueAt;
  }

  /** Whether the scene is one of walls for the hand alone. */
  get isWalls() {
    return this.scene.kind === 'WALLS';
  }

  /** Whether it is one of an arm, that can be drawn. */
  get isArm() {
    return !!this.scene.name && !this.scene.problem && (this.scene.kind ?? 'ARM') === 'ARM';
  }

  /** Whether this page leads. */
  get leads() {
    return !!this.hello.page && this.hello.leader === this.hello.page;
  }

  /** Number of another page that leads; 0: none. */
  get otherLeader() {
    return this.leads ? 0 : this.hello.leader ?? 0;
  }
}

/**
 * Why no order can be given now; empty: it can.
 * @param {Facts} facts
 * @returns {string}
 */
export function whyNoOrders(facts) {
  if (facts.recording) return 'this is a recording: no order can be given';
  if (!facts.connected) return 'not connected to the gateway';
  if (facts.hello.role === 'OBSERVER') return 'you are an observer: you may look, not order';
  if (facts.problem) return 'the master does not answer';
  if (facts.otherLeader) return `page ${facts.otherLeader} leads; take over to give orders`;
  return '';
}

/**
 * The same for a stop, which any page of an operator may give.
 * @param {Facts} facts
 * @returns {string}
 */
export function whyNoStop(facts) {
  if (facts.recording) return 'this is a recording: nothing is stopped by it';
  if (!facts.connected) return 'not connected: use the controller’s emergency stop';
  if (facts.hello.role === 'OBSERVER') return 'you are an observer: you may look, not stop';
  return '';
}
