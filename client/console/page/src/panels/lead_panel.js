// Who leads: this page, another, another operator; taking, granting and giving back.
import { block, button, setText, show } from './dom.js';

/** @typedef {import('../link/facts.js').Facts} Facts */
/** @typedef {import('../link/orders.js').Orders} Orders */
/** @typedef {(text: string, mood?: string) => void} Say */

export class LeadPanel {
  /** @param {Facts} facts @param {Orders} orders @param {Say} say */
  constructor(facts, orders, say) {
    this.facts = facts;
    button('lead-take').addEventListener('click', () => this.ask(orders, facts.otherLeader ? 'TAKE_OVER' : 'TAKE', say));
    button('lead-release').addEventListener('click', () => this.ask(orders, 'RELEASE', say));
    button('lease-grant').addEventListener('click', () => void orders.give({ lease: { act: 'GRANT' } }));
  }

  /** @param {Orders} orders @param {import('../link/wire.d.ts').LeadAct} act @param {Say} say */
  async ask(orders, act, say) {
    const { done, reason } = await orders.lead(act);
    const word = act === 'RELEASE' ? 'the lead was given back' : 'this page leads';
    say(done ? reason || word : reason, done ? 'good' : 'bad');
  }

  update() {
    const { facts } = this;
    const recording = facts.recording ? 'this is a recording: there is nothing to lead' : '';
    const observer = facts.hello.role === 'OBSERVER' ? 'you are an observer: you may look, not lead' : '';
    const off = facts.connected ? recording || observer : 'not connected to the gateway';
    setText(button('lead-take'), facts.otherLeader ? 'Take over' : 'Take');
    block(button('lead-take'), off || (facts.leads ? 'this page leads already' : ''));
    block(button('lead-release'), off || (facts.leads ? '' : 'this page does not lead'));
    show(button('lease-grant'), !!facts.status.lease?.asked_by && facts.leads);
    if (facts.status.lease?.asked_by) setText(button('lease-grant'), `Grant ${facts.status.lease.asked_by}`);
  }
}
