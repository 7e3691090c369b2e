// Which scene, which stage of its walls.
import { whyNoOrders } from '../link/facts.js';
import { block, box, button, element, setText, show } from './dom.js';

/** @typedef {import('../link/facts.js').Facts} Facts */
/** @typedef {import('../link/lead.js').Lead} Lead */

/** For scenes that the master knows and the gateway does not. */
const OTHER = 'another …';

export class ScenePanel {
  /** @param {Facts} facts @param {Lead} lead */
  constructor(facts, lead) {
    this.facts = facts;
    this.lead = lead;
    this.select = element('scene', HTMLSelectElement);
    this.name = element('scene-name', HTMLInputElement);
    /** Those that are offered, as one text. */
    this.offered = '';
    this.offer();
    this.select.addEventListener('change', () => {
      show(box('scene-other'), this.select.value === OTHER);
      if (this.select.value === OTHER) this.name.focus();
    });
    button('scene-load').addEventListener('click', () => this.load());
    this.name.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') this.load();
    });
  }

  /** The names as the gateway says them; what is chosen stays. */
  offer() {
    const names = [...this.facts.sceneNames, OTHER];
    if (names.join('\n') === this.offered) return;
    this.offered = names.join('\n');
    const chosen = this.select.value && this.select.value !== OTHER ? this.select.value : this.facts.scene.name;
    this.select.replaceChildren(...names.map((name) => new Option(name, name)));
    if (chosen && names.includes(chosen)) this.select.value = chosen;
    show(box('scene-other'), this.select.value === OTHER);
  }

  load() {
    const name = this.select.value === OTHER ? this.name.value.trim() : this.select.value;
    if (name) void this.lead.give({ scene_load: name });
  }

  setScene() {
    const { scene } = this.facts;
    this.offer();
    if (scene.name && this.facts.sceneNames.includes(scene.name)) this.select.value = scene.name;
    show(box('scene-other'), this.select.value === OTHER);
    setText(box('scene-text'), scene.description ?? '');
    const stages = (scene.map?.stage ?? []).filter((stage) => stage.name);
    box('stages').replaceChildren(...stages.map(({ name = '' }) => {
      const node = document.createElement('button');
      node.type = 'button';
      node.textContent = name;
      node.dataset.stage = name;
      node.addEventListener('click', () => void this.lead.give({ stage: name }));
      return node;
    }));
    show(box('stages'), stages.length > 0);
  }

  update() {
    this.offer();
    const blocked = whyNoOrders(this.facts);
    block(button('scene-load'), blocked);
    for (const node of box('stages').querySelectorAll('button')) {
      block(node, blocked);
      node.setAttribute('aria-pressed', String(node.dataset.stage === this.facts.status.walls?.stage_name));
    }
    setText(box('scene-now'), this.facts.scene.name ?? this.facts.status.scene ?? '–');
  }
}
