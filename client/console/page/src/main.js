// Puts the page together. Orders and the hand go from event handlers to the socket (link/, hand/); what
// is drawn is drawn from the newest facts (picture.js, panels/), and neither waits for the other.
import { Cursor } from './hand/cursor.js';
import { DeadMan, watchPage } from './hand/dead_man.js';
import { Engage } from './hand/engage.js';
import { Pad } from './hand/gamepad.js';
import { handKeys } from './hand/keys.js';
import { Facts, whyNoOrders } from './link/facts.js';
import { Gateway } from './link/gateway.js';
import { Lead } from './link/lead.js';
import { Orders } from './link/orders.js';
import { Charts } from './panels/charts.js';
import { box, button, setData, setText, show } from './panels/dom.js';
import { LeadPanel } from './panels/lead_panel.js';
import { notice, Said } from './panels/notice.js';
import { OrderPanel } from './panels/order_panel.js';
import { PlayBar } from './panels/play_bar.js';
import { ScenePanel } from './panels/scene_panel.js';
import { updateScrew } from './panels/screw_panel.js';
import { updateBar, whatIsMissing } from './panels/state_bar.js';
import { setUpTheme } from './panels/theme.js';
import { Tour } from './panels/tour.js';
import { setUpWhy, updateWhy } from './panels/why_panel.js';
import { Picture } from './picture.js';
import { rotationVector } from './scene3d/rotation.js';

const PANELS_MS = 50; // a chart's sample; texts change less often
const LEASE_MS = 500; // in which a lease is taken or refused

const url = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`;
const gateway = new Gateway(url);
const facts = new Facts(gateway);
const orders = new Orders(gateway);
const lead = new Lead(orders, facts);
const said = new Said();
orders.onOutcome = (order, outcome) => said.outcome(order, outcome);

// The hand.
const deadMan = new DeadMan();
const cursor = new Cursor(gateway, deadMan);
const engage = new Engage(lead, facts, deadMan, (text) => said.say(text));
const stop = () => {
  void orders.stop();
  engage.drop();
};
watchPage(deadMan);
gateway.on('closed', () => {
  deadMan.letAllGo('the connection was lost');
  engage.drop();
});
cursor.deviceAt = () => facts.status.hand?.position_mm ?? [0, 0, 0];
cursor.deviceTurn = () => rotationVector(facts.status.hand?.quaternion ?? []);
cursor.returns = () => facts.isArm;
gateway.on('hello', () => {
  if (!facts.otherLeader) return;
  deadMan.letAllGo('another page leads');
  engage.drop();
});
gateway.on('status', () => {
  const half = facts.status.haptic?.workspace_half_mm;
  if (half?.length) cursor.half = half;
  if (facts.problem) deadMan.letAllGo('the master does not answer');
  if (!facts.recording) pad.feel(facts.status);
  engage.look();
});

/** Whether the hand may be taken now; takes the lead if nobody has it, and says why if not. */
function mayHold() {
  const no = whyNoOrders(facts) || (facts.hasStatus && !facts.status.haptic?.cursor ? 'the master’s device is not `page`: start it with device { kind: PAGE }' : '');
  if (no) said.say(no, 'bad');
  else void lead.ensure().then(({ done, reason }) => done || refuse(reason));
  return !no;
}

/** @param {string} reason */
function refuse(reason) {
  deadMan.letAllGo(reason);
  said.say(`the hand was not taken: ${reason}`, 'bad');
}

deadMan.onChange((held, why) => {
  setData(box('hold'), 'held', String(held));
  setText(box('hold'), held ? 'hand held' : 'hand free');
  if (!held && why) said.say(`hand let go: ${why}`, 'bad');
});
gateway.on('hand', () => {
  // The first cursors may come before the lease that was asked for with them.
  if (facts.cursorRefused && cursor.heldFor() > LEASE_MS) refuse(facts.cursorRefused);
});
const hand = { cursor, deadMan, mayHold, engage };
handKeys(hand);
const pad = new Pad({ ...hand, stop, say: (text) => said.say(text) });

gateway.connect(); // answers while the browser makes ready what is drawn

// What is drawn.
const picture = new Picture(facts, hand);
const panel = new OrderPanel(facts, engage, { stop, say: (text, mood) => said.say(text, mood) });
const scenes = new ScenePanel(facts, lead);
const leads = new LeadPanel(facts, orders, (text, mood) => said.say(text, mood));
const player = new PlayBar(facts, orders, (text, mood) => said.say(text, mood));
const charts = new Charts();
setUpWhy(facts, engage);
setUpTheme(() => {
  charts.build();
  picture.setTheme();
});
new Tour();
facts.onScene.push(() => {
  picture.setScene();
  panel.setScene();
  scenes.setScene();
});
panel.setScene();

/** A button beside the notice, where one helps. */
function wayOn() {
  if (facts.recording || !facts.connected || facts.hello.role === 'OBSERVER' || !facts.otherLeader) return null;
  return { text: 'Take over', blocked: '', press: () => button('lead-take').click() };
}

/** @returns {string} */
function noticeText() {
  const missing = whatIsMissing(facts, gateway);
  if (missing) return missing;
  if (facts.recording) return facts.recording.damage ? `This recording is not whole: ${facts.recording.damage}. It is shown up to there.` : '';
  if (facts.hello.role === 'OBSERVER') return 'You are an observer: you see everything and order nothing.';
  if (facts.otherLeader) return `Another page leads: ${facts.hello.leader_text || `page ${facts.hello.leader}`}. This one looks on; a stop passes all the same.`;
  return '';
}

function updatePanels() {
  updateBar(facts);
  player.update();
  updateWhy(facts);
  panel.update();
  scenes.update();
  leads.update();
  charts.update(facts);
  updateScrew(facts.rig);
  notice(noticeText(), wayOn());
  setText(box('prompt-text'), facts.status.prompt ?? '');
  show(box('prompt'), !!facts.status.prompt);
  show(button('mark'), !facts.isWalls); // what is done among walls is seen there
}

function frame() {
  picture.draw();
  requestAnimationFrame(frame);
}

show(box('stats'), new URLSearchParams(location.search).has('stats'));
setInterval(updatePanels, PANELS_MS);
requestAnimationFrame(frame);
