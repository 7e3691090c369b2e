// node viewers.mjs ORIGIN COOKIE COUNT: so many pages that read and draw nothing, until standard input
// ends; prints "open", and then how many statuses a second each was told.
import { WebSocket } from 'ws';

const [origin, cookie, count] = process.argv.slice(2);
const counts = new Array(Number(count)).fill(0);
await Promise.all(counts.map((_, i) => new Promise((resolve, reject) => {
  const socket = new WebSocket(`${origin.replace('http', 'ws')}/ws`, 'handrail.console.v1', { origin, headers: { cookie }, rejectUnauthorized: false });
  socket.on('message', (text) => {
    if (text.subarray(0, 9).toString() === '{"status"') ++counts[i];
  });
  socket.on('open', resolve);
  socket.on('error', reject);
})));
counts.fill(0);
const begin = performance.now();
console.log('open');
process.stdin.resume().on('end', () => {
  const seconds = (performance.now() - begin) / 1000;
  console.log(JSON.stringify(counts.map((each) => each / seconds)));
  process.exit(0);
});
