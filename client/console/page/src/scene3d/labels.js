// Words in the picture: plain elements over it, moved with what they name.
import * as THREE from 'three';

export class Labels {
  /** @param {HTMLElement} layer over the canvas, as large */
  constructor(layer) {
    this.layer = layer;
    /** @type {Map<string, {element: HTMLElement, at: THREE.Vector3}>} */
    this.all = new Map();
  }

  /** @param {string} name also its class @param {string} text @param {THREE.Vector3} at */
  put(name, text, at) {
    let label = this.all.get(name);
    if (!label) {
      const element = document.createElement('span');
      element.className = `label label-${name.replace(/ .*/, '')}`;
      this.layer.append(element);
      label = { element, at: new THREE.Vector3() };
      this.all.set(name, label);
    }
    label.at.copy(at);
    label.element.hidden = false;
    if (label.element.textContent !== text) label.element.textContent = text;
  }

  /** @param {string} name */
  hide(name) {
    const label = this.all.get(name);
    if (label) label.element.hidden = true;
  }

  /** @param {string} start of the names */
  drop(start) {
    for (const [name, label] of this.all) {
      if (!name.startsWith(start)) continue;
      label.element.remove();
      this.all.delete(name);
    }
  }

  /** Moves them to where they belong. @param {THREE.Camera} camera @param {number} width @param {number} height */
  layOut(camera, width, height) {
    const p = new THREE.Vector3();
    let last = -1e9;
    const shown = [...this.all.values()].filter((label) => !label.element.hidden);
    const places = shown.map((label) => {
      p.copy(label.at).project(camera);
      return { label, x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height, seen: p.z < 1 };
    });
    places.sort((a, b) => a.y - b.y);
    for (const { label, x, y, seen } of places) {
      const free = Math.max(y, last + 17); // one below the other, not on it [px]
      if (seen && Math.abs(x - width / 2) < width / 2) last = free;
      const left = Math.min(Math.max(4, x + 8), width - 110), top = Math.min(Math.max(4, free - 8), height - 22);
      label.element.style.transform = `translate(${left.toFixed(0)}px, ${top.toFixed(0)}px)`;
    }
  }
}
