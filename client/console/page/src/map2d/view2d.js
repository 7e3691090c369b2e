// The picture of a scene of walls: the map, the lever, the hand, the cursor and the force between them.
import { lieOf, toDevice, wayToDevice, window2d } from './frames.js';
import { palette, recolour, rgb } from './recolour.js';

/** @typedef {import('../link/facts.js').Facts} Facts */
/** @typedef {import('../link/wire.d.ts').Vec} Vec */

const FORCE_MM_N = 2; // an arrow's length: 10 N are 20 mm of a map of about 100
const LEAST_N = 0.05; // smaller forces are the device's own noise

export class View2d {
  /** @param {HTMLCanvasElement} canvas @param {import('../hand/cursor.js').Cursor} cursor */
  constructor(canvas, cursor) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    this.cursor = cursor;
    this.size = { width: 1, height: 1 };
    /** @type {HTMLImageElement | null} */
    this.image = null;
    /** @type {HTMLCanvasElement | null} */
    this.painted = null;
    /** Why there is no map; empty: there is. */
    this.problem = '';
    this.shown = '';
    this.colours = this.readColours();
  }

  readColours() {
    const style = getComputedStyle(document.documentElement);
    /** @param {string} name */
    const read = (name) => style.getPropertyValue(`--${name}`).trim();
    return {
      wall: read('map-wall'), free: read('map-free'), aisle: read('map-aisle'), edge: read('map-edge'),
      text: read('text'), soft: read('text-soft'), lever: read('lever'), ring: read('ring'), force: read('force'),
      locked: read('good'),
    };
  }

  /** Another theme. @param {Facts} facts */
  setTheme(facts) {
    this.colours = this.readColours();
    this.paint(facts);
    this.shown = '';
  }

  /** @param {Facts} facts */
  setScene(facts) {
    this.image = this.painted = this.awaited = null;
    this.problem = '';
    this.shown = '';
    const picture = facts.scene.map?.picture;
    if (!picture) {
      this.problem = facts.isWalls ? 'this scene cannot be drawn: it came without a map' : '';
      return;
    }
    const image = new Image();
    image.onload = () => {
      if (this.awaited !== image) return;
      this.image = image;
      this.paint(facts);
    };
    image.onerror = () => {
      if (this.awaited === image) this.problem = 'this scene cannot be drawn: its map did not load';
    };
    this.awaited = image;
    image.src = picture;
  }

  /** The map in the page's colours. @param {Facts} facts */
  paint({ scene, status }) {
    if (!this.image || !scene.map) return;
    const canvas = document.createElement('canvas');
    canvas.width = this.image.naturalWidth;
    canvas.height = this.image.naturalHeight;
    const context = canvas.getContext('2d', { willReadFrequently: true });
    if (!context) return;
    context.drawImage(this.image, 0, 0);
    const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
    this.stage = status.walls?.stage ?? 0;
    const without = scene.map.stage?.[this.stage]?.without ?? [];
    const { wall, free, aisle } = this.colours;
    const kinds = { wall, free, aisle };
    recolour(pixels.data, palette(scene.map, without, (kind) =>
      rgb(kinds[/** @type {'wall'} */ (kind)] ?? wall) ?? [128, 128, 128]));
    context.putImageData(pixels, 0, 0);
    this.painted = canvas;
    this.shown = '';
  }

  /** @param {number} width @param {number} height [px] */
  resize(width, height) {
    this.canvas.width = width;
    this.canvas.height = height;
    this.size = { width, height };
    this.shown = '';
  }

  /** Where things are, M [mm]. @param {Facts} facts */
  places({ status, scene }) {
    const map = scene.map ?? {};
    const lie = lieOf(map, status.walls?.stage ?? 0);
    const hand = status.hand?.position_mm ?? (status.walls?.hand_mm ? toDevice(lie, status.walls.hand_mm) : [0, 0]);
    const proxy = status.walls?.proxy_mm;
    const lever = proxy ? toDevice(lie, proxy) : hand;
    const told = status.haptic?.cursor?.position_mm;
    const ring = this.cursor.held ? this.cursor.position : status.haptic?.cursor?.held && told ? told : hand;
    const ball = status.walls?.ball_mm?.length ? toDevice(lie, status.walls.ball_mm) : null;
    const force = status.walls?.force_n ? wayToDevice(lie, status.walls.force_n) : (status.device_force?.force_n ?? [0, 0]);
    return { lie, hand, lever, ring, ball, force, map };
  }

  /** @param {Facts} facts */
  frame(facts) {
    const { lie, map } = this.places(facts);
    return window2d(lie, map.size_mm ?? [100, 100], this.size.width, this.size.height);
  }

  /** Draws if anything looks different. @param {Facts} facts @returns {boolean} whether it drew */
  draw(facts) {
    if (this.painted && this.stage !== (facts.status.walls?.stage ?? 0)) this.paint(facts);
    const { lever, hand, ring, ball, force, lie } = this.places(facts);
    const { place, screw_c: c, turned_rad: turned } = facts.status.walls ?? {};
    const now = [lever, hand, ring, ball ?? [], force, turned ?? 0].flat().map((value) => value.toFixed(2)).join() +
      JSON.stringify([lie, place, c, !!this.painted, this.problem]);
    if (now === this.shown) return false;
    this.shown = now;
    this.drawAll(facts);
    return true;
  }

  /** @param {Facts} facts */
  drawAll(facts) {
    const { context: c, size } = this;
    const { lie, lever, hand, ring, ball, force, map } = this.places(facts);
    const view = window2d(lie, map.size_mm ?? [100, 100], size.width, size.height);
    this.canvas.dataset.scale = String(view.scale); // pixels a millimetre
    c.fillStyle = this.colours.wall; // beyond the map nothing is free
    c.fillRect(0, 0, size.width, size.height);
    if (this.painted) {
      const [w = 100, h = 100] = map.size_mm ?? [];
      c.save();
      c.translate(...view.px([lie.x, lie.y]));
      c.rotate(-lie.turn);
      c.imageSmoothingQuality = 'high';
      c.drawImage(this.painted, (-w / 2) * view.scale, (-h / 2) * view.scale, w * view.scale, h * view.scale);
      c.restore();
    }
    this.drawPlaces(facts, view, lie);
    this.drawHand(view, lever, hand, ring);
    /** @type {HTMLElement} */ (document.querySelector('#key-ball')).hidden = !ball;
    if (ball) this.drawBall(view, ball);
    else delete this.canvas.dataset.ball;
    this.drawForce(view, lever, force);
    this.drawScrew(facts);
  }

  /** Where the person is led to. @param {ReturnType<typeof window2d>} view @param {Vec} ball */
  drawBall(view, ball) {
    const { context: c, colours } = this;
    const [x, y] = view.px(ball);
    this.canvas.dataset.ball = `${x.toFixed(1)} ${y.toFixed(1)}`; // for tests, as the scale
    c.beginPath();
    c.arc(x, y, Math.max(5, 2 * view.scale), 0, 2 * Math.PI);
    c.fillStyle = colours.locked;
    c.fill();
    c.lineWidth = 2;
    c.strokeStyle = colours.edge;
    c.stroke();
  }

  /** The head of a screw that is turned, in the corner. @param {Facts} facts */
  drawScrew({ status }) {
    const { turned_rad: turned, screw_c: growth } = status.walls ?? {};
    if (turned === undefined) return;
    const { context: c, colours } = this;
    const x = 36, y = 104, radius = 18; // below the name of the place
    c.beginPath();
    for (let i = 0; i < 6; ++i) c.lineTo(x + radius * Math.cos(turned + (i * Math.PI) / 3), y + radius * Math.sin(turned + (i * Math.PI) / 3));
    c.closePath();
    c.lineWidth = 2;
    c.strokeStyle = colours.text;
    c.stroke();
    c.beginPath(); // a mark, or six turns look the same
    c.moveTo(x, y);
    c.lineTo(x + radius * Math.cos(turned), y + radius * Math.sin(turned));
    c.stroke();
    c.font = '600 14px system-ui, sans-serif';
    c.textAlign = 'left';
    c.textBaseline = 'middle';
    c.fillStyle = colours.text;
    c.fillText(`turned ${turned.toFixed(1)} rad, c ${growth ?? 0} N s/(m rad)`, x + radius + 10, y);
  }

  /** @param {Facts} facts @param {ReturnType<typeof window2d>} view @param {import('./frames.js').Lie} lie */
  drawPlaces({ scene, status }, view, lie) {
    const { context: c } = this;
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    for (const place of scene.map?.place ?? []) {
      const [x, y] = view.px(toDevice(lie, place.at_mm ?? []));
      const here = !!place.name && status.walls?.place === place.name;
      const radius = Math.max(8, 0.5 * (place.radius_mm ?? 6) * view.scale);
      c.beginPath();
      c.arc(x, y, radius, 0, 2 * Math.PI);
      c.lineWidth = here ? 3 : 1.5;
      c.setLineDash(here ? [] : [3, 4]);
      c.strokeStyle = here ? this.colours.locked : this.colours.soft;
      c.stroke();
      c.setLineDash([]);
      const side = y < this.size.height / 2 ? -1 : 1; // the name stands outside, where no lever covers it
      c.font = `700 ${Math.round(Math.min(30, 4.5 * view.scale + 8))}px system-ui, sans-serif`;
      c.fillStyle = here ? this.colours.locked : this.colours.text;
      const outside = y + side * (radius + 0.5 * radius + 14);
      c.fillText(place.name ?? '', x, Math.max(14, Math.min(this.size.height - 14, outside)));
    }
  }

  /** @param {ReturnType<typeof window2d>} view @param {Vec} lever @param {Vec} hand @param {Vec} ring */
  drawHand(view, lever, hand, ring) {
    const { context: c, colours } = this;
    const [lx, ly] = view.px(lever), [hx, hy] = view.px(hand), [rx, ry] = view.px(ring);
    const apart = Math.hypot(lx - rx, ly - ry);
    if (apart > 2) {
      c.beginPath();
      c.moveTo(lx, ly);
      c.lineTo(rx, ry);
      c.lineWidth = Math.max(1, 3.5 - apart / 60); // a band is thinner the further it is stretched
      c.strokeStyle = colours.ring;
      c.stroke();
    }
    const knob = Math.max(7, 3.6 * view.scale);
    c.beginPath();
    c.arc(lx, ly, knob, 0, 2 * Math.PI);
    c.globalAlpha = 0.85;
    c.fillStyle = colours.lever;
    c.fill();
    c.globalAlpha = 1;
    c.lineWidth = 2;
    c.strokeStyle = colours.edge;
    c.stroke();
    c.beginPath();
    c.arc(hx, hy, 3, 0, 2 * Math.PI);
    c.fillStyle = colours.edge;
    c.fill();
    c.beginPath();
    c.arc(rx, ry, knob + 5, 0, 2 * Math.PI);
    c.lineWidth = this.cursor.held ? 3 : 1.5;
    c.strokeStyle = colours.ring;
    c.stroke();
  }

  /** @param {ReturnType<typeof window2d>} view @param {Vec} from @param {Vec} force [N] */
  drawForce(view, from, force) {
    const [fx = 0, fy = 0] = force;
    const size = Math.hypot(fx, fy);
    if (size < LEAST_N) return;
    const { context: c, colours } = this;
    const [x, y] = view.px(from);
    const px = FORCE_MM_N * view.scale;
    const ex = x + fx * px, ey = y - fy * px;
    const turn = Math.atan2(ey - y, ex - x), head = Math.min(12, 0.6 * size * px);
    c.lineWidth = 4;
    c.strokeStyle = c.fillStyle = colours.force;
    c.beginPath();
    c.moveTo(x, y);
    c.lineTo(ex - head * 0.8 * Math.cos(turn), ey - head * 0.8 * Math.sin(turn));
    c.stroke();
    c.beginPath();
    c.moveTo(ex, ey);
    for (const side of [-0.45, 0.45]) c.lineTo(ex - head * Math.cos(turn + side), ey - head * Math.sin(turn + side));
    c.fill();
    c.font = '600 14px system-ui, sans-serif';
    c.textAlign = ex >= x ? 'left' : 'right';
    c.textBaseline = 'middle';
    c.lineWidth = 4;
    c.strokeStyle = colours.edge;
    const text = `${size.toFixed(1)} N`;
    const tx = Math.max(40, Math.min(this.size.width - 40, ex + (ex >= x ? 8 : -8)));
    c.strokeText(text, tx, ey);
    c.fillText(text, tx, ey);
  }
}
