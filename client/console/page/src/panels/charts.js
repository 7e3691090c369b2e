// Strip charts of the last ten seconds.
import uPlot from 'uplot';
import { box, number, setText } from './dom.js';

/** @typedef {import('../link/facts.js').Facts} Facts */

const SPAN_S = 10;
const SAMPLE_MS = 50; // 20 a second: a pixel each
const DRAW_MS = 125; // 8 a second: reads as moving

/** @typedef {{plot: uPlot | null, node: HTMLElement, values: (number | null)[], floor: number, colour: string}} Strip */

export class Charts {
  constructor() {
    /** @type {number[]} */
    this.times = [];
    /** @type {Record<'force' | 'error' | 'packet', Strip>} */
    this.strips = {
      force: { plot: null, node: box('chart-force'), values: [], floor: 2, colour: '--force' },
      error: { plot: null, node: box('chart-error'), values: [], floor: 2, colour: '--good' },
      packet: { plot: null, node: box('chart-packet'), values: [], floor: 20, colour: '--info' },
    };
    /** Of a recording: how often it was put to elsewhere. @type {number | undefined} */
    this.jumps = undefined;
    this.sampledAt = 0;
    this.drawnAt = 0;
    this.build();
    new ResizeObserver(() => this.resize()).observe(box('chart-force'));
  }

  /** Also for another theme. */
  build() {
    const style = getComputedStyle(document.documentElement);
    /** @param {string} name */
    const colour = (name) => style.getPropertyValue(name).trim();
    for (const strip of Object.values(this.strips)) {
      strip.plot?.destroy();
      strip.plot = new uPlot(this.options(strip, colour), [this.times, strip.values], strip.node);
    }
  }

  /** @param {Strip} strip @param {(name: string) => string} colour @returns {uPlot.Options} */
  options(strip, colour) {
    const ink = colour('--text-soft'), grid = { stroke: colour('--line'), width: 1 };
    const font = '11px system-ui, sans-serif';
    return {
      width: Math.max(80, strip.node.clientWidth),
      height: Math.max(40, strip.node.clientHeight),
      legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, range: () => [-SPAN_S, 0] },
        y: { range: (_, low, high) => [0, Math.max(strip.floor, 1.1 * (high ?? 0))] },
      },
      axes: [
        { stroke: ink, grid, ticks: { show: false }, font, size: 20, values: (_, ticks) => ticks.map((t) => (t === 0 ? 'now' : `${t} s`)), splits: () => [-10, -5, 0] },
        { stroke: ink, grid, ticks: { show: false }, font, size: 38, space: 26 },
      ],
      series: [{}, { stroke: colour(strip.colour), width: 1.75, points: { show: false } }],
    };
  }

  resize() {
    for (const { plot, node } of Object.values(this.strips)) {
      plot?.setSize({ width: Math.max(80, node.clientWidth), height: Math.max(40, node.clientHeight) });
    }
  }

  /** @param {Facts} facts */
  static now(facts) {
    const { status, isWalls } = facts;
    const fresh = facts.connected && !facts.problem && facts.age() < 1000;
    const age = facts.age();
    const since = facts.recording ? 0 : age; // of a recording it is the age that it had
    const packet = isWalls ? (facts.recording ? null : age) : status.packet_age_ms === undefined || status.packet_age_ms < 0 ? null : status.packet_age_ms + since;
    return {
      force: fresh ? status.device_force?.magnitude_n ?? null : null,
      error: fresh ? (isWalls ? status.walls?.penetration_mm : status.ledger?.behind_mm) ?? null : null,
      packet: Number.isFinite(age) && facts.connected ? packet : null,
    };
  }

  /** @param {Facts} facts */
  update(facts) {
    const now = performance.now();
    const time = facts.recording ? facts.play.position_s ?? 0 : now / 1000;
    if (this.jumps !== facts.play.jumps) this.clear(facts.play.jumps);
    if (now - this.sampledAt >= SAMPLE_MS && time !== this.times[this.times.length - 1]) {
      this.sampledAt = now;
      const values = Charts.now(facts);
      this.times.push(time);
      for (const name of /** @type {('force' | 'error' | 'packet')[]} */ (['force', 'error', 'packet'])) {
        this.strips[name].values.push(values[name]);
      }
      while ((this.times[0] ?? time) < time - SPAN_S - 1) {
        this.times.shift();
        for (const strip of Object.values(this.strips)) strip.values.shift();
      }
    }
    if (now - this.drawnAt < DRAW_MS) return;
    this.drawnAt = now;
    this.draw(facts, time);
  }

  /** What was before is no past of what comes. @param {number | undefined} jumps */
  clear(jumps) {
    this.jumps = jumps;
    this.times.length = 0;
    for (const strip of Object.values(this.strips)) strip.values.length = 0;
  }

  /** @param {Facts} facts @param {number} now [s] */
  draw(facts, now) {
    const back = this.times.map((time) => time - now);
    for (const { plot, values } of Object.values(this.strips)) plot?.setData([back, values]);
    const { force, error, packet } = Charts.now(facts);
    setText(box('force-now'), number(force ?? undefined, 2, 5));
    setText(box('error-now'), number(error ?? undefined, 1, 5));
    setText(box('packet-now'), number(packet ?? undefined, 0, 5));
    setText(box('packet-name'), facts.isWalls ? 'data age' : 'packet age');
    setText(box('error-name'), facts.isWalls ? 'hand into the wall' : 'arm behind the hand');
  }
}
