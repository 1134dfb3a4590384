// Drives the module as a host does: node run.mjs FILE GOLDEN. Exits with 1 if something is not as it should be.
import { readFile } from 'node:fs/promises';

const [, , file, golden] = process.argv;
const { instance } = await WebAssembly.instantiate(await readFile(file), {});
const engine = instance.exports;
const fx = (number) => BigInt(number) << 32n;
const check = (what, found, expected) => {
  if (found !== expected) {
    console.error(`${what}: ${found}, expected ${expected}`);
    process.exitCode = 1;
  }
};
const [REFUSED, DONE] = [-1n, -2n];
// Commands as the network brings them (docs/formats.md): bytes are numbers, those of 64 bits BigInts.
const send = (world, ...parts) => {
  const bytes = parts.flatMap((part) => (typeof part === 'number' ? [part] : bytesOf64(part)));
  const buffer = engine.buffer(bytes.length);
  bytesOf(buffer).set(bytes);
  const made = engine.execute(world, buffer);
  engine.discard(buffer);
  return made;
};
const bytesOf64 = (value) => Array.from({ length: 8 }, (_, i) => Number(BigInt.asUintN(64, value) >> BigInt(8 * i) & 255n));
const bytesOf = (buffer) => new Uint8Array(engine.memory.buffer, engine.address(buffer), engine.length(buffer));
const setGravity = (world, y) => send(world, 21, fx(0), fx(y));
// Dynamic; position, angle, velocity, angular velocity; no shape, no colliders; a mass in kg; gravity, no dampings, no limits, no locks;
// dominance 0, no bullet; group 1, key, user data.
const addBody = (world, [x, y], [u, v], mass) =>
  send(world, 0, 2, fx(x), fx(y), 0n, fx(u), fx(v), 0n, 0, 0, 0, 0, 0, 1, fx(mass), fx(1), 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 1, 0, 0, 0, 0n, 0n);
const pushed = (world, body, x, y) => send(world, 2, body, 2, fx(x), fx(y), 0, 0, 1);

check('a world of no rate', engine.create(0), 0);
const world = engine.create(64);
check('a gravity', setGravity(world, -8), DONE);
const ball = addBody(world, [1, 100], [3, 0], 2);
check('a body', ball, 0n);
check('a mass out of range', addBody(world, [1, 1], [0, 0], -2), REFUSED);
check('no command', send(world, 99), REFUSED);
for (let tick = 0; tick < 64; tick++) engine.step(world);
// 100 − ½·8·1², 1 + 3·1.
check('place', [0, 1].map((i) => engine.read(world, ball, i)).join(), [fx(4), fx(96)].join());
const saved = engine.snapshot(world);
const before = engine.hash(world);
check('an impulse', pushed(world, ball, 2, 0), DONE);
check('velocity after an impulse', engine.read(world, ball, 2), fx(4));
for (let tick = 0; tick < 64; tick++) engine.step(world);
if (engine.hash(world) === before) check('the hash of another state', before, 'another');
check('bytes that are a snapshot', engine.restore(world, saved), 0);
check('the hash of a state that is back', engine.hash(world), before);
check('the text of a number', engine.texts(world, -12345n) & 1n, 1n);
check('a gravity', setGravity(world, -4), DONE);
const recorder = engine.record(world);
for (let tick = 0; tick < 100; tick++) engine.record_step(recorder, world);
const replay = engine.record_end(recorder, world);
check('a replay', engine.verify(replay), 100n);
bytesOf(replay)[200] ^= 1;
check('a replay that was changed', engine.verify(replay), -1n);
bytesOf(saved)[40] ^= 1;
check('bytes that are no snapshot', engine.restore(world, saved), -1);
for (const buffer of [saved, replay]) engine.discard(buffer);
engine.destroy(world);
const digest = BigInt.asUintN(64, engine.corpus()).toString(16).padStart(16, '0');
check('the digest of the corpus', digest, golden);
console.log(`corpus ${digest}`);
