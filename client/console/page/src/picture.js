// The picture: of an arm in space, or of walls in the plane; or words, where neither can be drawn.
import { dragMap } from './hand/drag_map.js';
import { dragTip } from './hand/drag_tip.js';
import { View2d } from './map2d/view2d.js';
import { box, element, setText, show } from './panels/dom.js';
import { USUAL_ROTATION } from './scene3d/vectors.js';
import { View3d } from './scene3d/view3d.js';

/** @typedef {import('./link/facts.js').Facts} Facts */

const PACE_MS = 1000 / 31; // pictures a second: the eye's due, and half of a processor's

export class Picture {
  /**
   * @param {Facts} facts
   * @param {{cursor: import('./hand/cursor.js').Cursor, deadMan: import('./hand/dead_man.js').DeadMan, mayHold: () => boolean,
   *   engage: import('./hand/engage.js').Engage}} hand
   */
  constructor(facts, hand) {
    this.facts = facts;
    this.hand = hand;
    /** Why there is no picture of an arm; empty: there is. */
    this.noWebGl = '';
    /** Made for the first scene of an arm: it takes a browser longer than all the rest of the page. @type {View3d | null} */
    this.view3d = null;
    this.view2d = new View2d(element('canvas2d', HTMLCanvasElement), hand.cursor);
    this.view2d.canvas.addEventListener('contextmenu', (event) => event.preventDefault()); // a long press is a grip
    dragMap(this.view2d.canvas, { ...hand, scale: () => this.view2d.frame(facts).scale });
    this.observeSizes();
    this.setUpViews();
    this.drawnAt = 0;
    /** When pictures were drawn, for the rate. @type {number[]} */
    this.times = [];
    this.setScene();
  }

  /** The view of an arm, and why there is none. */
  make3d() {
    if (this.view3d || this.noWebGl) return;
    try {
      const view = new View3d(element('canvas3d', HTMLCanvasElement), box('labels'));
      const mapping = () => {
        const { scale = 2, rotation } = this.facts.scene;
        return { scale, R: rotation?.length === 9 ? rotation : USUAL_ROTATION };
      };
      dragTip(box('frame3d'), { ...this.hand, view, mapping });
      view.canvas.addEventListener('webglcontextlost', (event) => {
        event.preventDefault();
        this.noWebGl = 'The browser gave the graphics away (WebGL context lost). It comes back by itself, or with a reload.';
        this.setScene();
      });
      view.canvas.addEventListener('webglcontextrestored', () => {
        this.noWebGl = '';
        view.dirty = true;
        this.setScene();
      });
      const { clientWidth: width, clientHeight: height } = box('frame3d');
      if (width > 0) view.resize(width, height);
      this.view3d = view;
    } catch {
      this.noWebGl = 'This browser has no WebGL, so the arm cannot be drawn. Scenes of walls, all orders, charts and the stop work.';
    }
  }

  observeSizes() {
    new ResizeObserver(() => {
      const { clientWidth: width, clientHeight: height } = box('frame2d');
      if (width > 0) this.view2d.resize(width, height);
    }).observe(box('frame2d'));
    new ResizeObserver(() => {
      const { clientWidth: width, clientHeight: height } = box('frame3d');
      if (width > 0) this.view3d?.resize(width, height);
    }).observe(box('frame3d'));
  }

  setUpViews() {
    for (const node of document.querySelectorAll('[data-view], [data-zoom]')) {
      if (!(node instanceof HTMLElement)) continue;
      node.addEventListener('click', () => {
        if (!this.view3d) return;
        if (node.dataset.zoom) this.view3d.eye.zoom(Number(node.dataset.zoom));
        else this.view3d.eye.look(node.dataset.view ?? 'whole', this.view3d.tip);
      });
    }
  }

  setTheme() {
    this.view2d.setTheme(this.facts);
    if (this.view3d) this.view3d.dirty = true;
  }

  setScene() {
    const { facts } = this;
    if (facts.isWalls) this.view2d.setScene(facts);
    else if (facts.isArm) {
      this.make3d();
      this.view3d?.setScene(facts);
    }
    this.choose();
  }

  /** Why there is nothing to see; empty: there is. */
  problem() {
    const { scene, isWalls } = this.facts;
    if (scene.problem) return `This scene cannot be drawn: ${scene.problem}`;
    if (isWalls) return this.view2d.problem;
    if (scene.kind && scene.kind !== 'ARM') return `This scene cannot be drawn: this page does not know the kind ${scene.kind}.`;
    return this.noWebGl;
  }

  choose() {
    const problem = this.problem();
    show(box('frame2d'), !problem && this.facts.isWalls);
    show(box('frame3d'), !problem && !this.facts.isWalls);
    show(box('no-picture'), problem !== '');
    setText(box('no-picture-text'), problem);
  }

  /** Draws what looks different, at most so often. */
  draw() {
    const now = performance.now();
    if (now - this.drawnAt < PACE_MS) return;
    this.choose();
    const { facts } = this;
    let drew = false;
    if (facts.isWalls) {
      drew = this.view2d.draw(facts);
      this.sayPlace();
    } else if (this.view3d) {
      this.view3d.update(facts);
      drew = this.view3d.draw();
    }
    this.sayHint();
    if (!drew) return;
    this.drawnAt = now;
    this.times.push(now);
    while ((this.times[0] ?? now) < now - 1000) this.times.shift();
    this.sayCost();
  }

  sayPlace() {
    const { walls } = this.facts.status;
    const locked = !!walls?.place;
    setText(box('place'), walls?.place || (walls?.touching ? 'wall' : walls?.region_name || '–'));
    setText(box('place-what'), locked ? 'locked' : walls?.touching ? 'touched' : 'region');
    box('place').classList.toggle('locked', locked);
  }

  sayHint() {
    const { facts, hand } = this;
    const state = facts.status.state;
    let text = hand.cursor.atEdge && !facts.isWalls ? 'The hand is at the edge of its reach: let go and take it anew.' : '';
    if (!hand.deadMan.held && !this.problem() && facts.connected && !facts.otherLeader && facts.hello.role !== 'OBSERVER') {
      if (facts.isWalls) text = 'Drag the lever. Or hold Shift and use the arrows.';
      else if (hand.engage.waits) text = 'Now hold the ring at the tip, or Shift: it engages then.';
      else if (state === 'fault' || facts.status.ledger?.way_out_order?.some((order) => order.reset)) text = 'Reset (R), then engage (E).';
      else if (state === 'off') text = 'Engage (E), then drag the ring at the tip.';
      else text = 'Drag the ring at the tip; wheel: nearer, further; Ctrl: turn. Or hold Shift and use the arrows.';
    }
    if (facts.recording) text = 'K plays and pauses; ← and → go 5 s back and on, [ and ] to the marks.' + (facts.isWalls ? '' : ' The mouse looks around.');
    setText(box('hint'), text);
    show(box('hint'), text !== '');
  }

  sayCost() {
    const node = box('stats');
    if (node.hidden) return;
    const { calls = 0, triangles = 0, drawn = 0 } = this.facts.isWalls ? {} : this.view3d?.cost() ?? {};
    setText(node, `${calls} draw calls, ${triangles} triangles, ${this.times.length} pictures/s, ${drawn} drawn`);
    const { x = 0, y = 0 } = this.view3d?.tipOnScreen() ?? {};
    Object.assign(node.dataset, { calls, triangles, drawn, tipX: x, tipY: y });
  }
}
