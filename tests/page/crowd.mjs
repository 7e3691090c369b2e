// node crowd.mjs ORIGIN COOKIE COUNT: so many WebSockets within a second, again each second those that were not
// let in, until standard input ends. Prints what became of the first ones, and at the end of the others.
import { WebSocket } from 'ws';

const [origin, cookie, count] = process.argv.slice(2);
const inside = new Set();

/** What one is answered: "in", the status with its text, or what went wrong; and after how long [ms]. */
const knock = (_, i) => new Promise((resolve) => setTimeout(resolve, (1000 * i) / count)).then(() => new Promise((resolve) => {
  const begin = performance.now();
  const tell = (said) => resolve({ said, ms: performance.now() - begin });
  const socket = new WebSocket(`${origin.replace('http', 'ws')}/ws`, 'handrail.console.v1', { origin, headers: { cookie }, rejectUnauthorized: false });
  socket.on('open', () => {
    inside.add(socket);
    tell('in');
  });
  socket.on('close', () => inside.delete(socket));
  socket.on('error', ({ message }) => tell(message));
  socket.on('unexpected-response', (_, response) => {
    let text = '';
    response.on('data', (part) => (text += part));
    response.on('end', () => tell(`${response.statusCode} ${text.trim()}`));
    response.on('error', ({ message }) => tell(`${response.statusCode} ${message}`));
  });
}));
const rush = async (many) => {
  const answers = await Promise.all(Array.from({ length: many }, knock));
  const counts = {};
  for (const { said } of answers) counts[said] = (counts[said] ?? 0) + 1;
  return { counts, slowest: Math.max(...answers.map(({ ms }) => ms)) };
};

let ends = false;
process.stdin.resume().on('end', () => (ends = true));
console.log(JSON.stringify(await rush(Number(count))));
const later = { counts: {}, slowest: 0, rounds: 0 };
while (!ends) {
  await new Promise((resolve) => setTimeout(resolve, 1000));
  const { counts, slowest } = await rush(Number(count) - inside.size);
  for (const [said, many] of Object.entries(counts)) later.counts[said] = (later.counts[said] ?? 0) + many;
  later.slowest = Math.max(later.slowest, slowest);
  ++later.rounds;
}
console.log(JSON.stringify(later));
process.exit(0);
