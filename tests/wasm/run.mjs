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
const REFUSED = -1n;
const command = (world, number, ...rest) => engine.command(world, number, ...rest.concat(Array(6).fill(0n)).slice(0, 6));

check('a world of no rate', engine.create(0), 0);
const world = engine.create(64);
command(world, 24, fx(0), fx(-8));
const ball = command(world, 0, 2n, fx(1), fx(100), fx(3), fx(0), fx(2));
check('a mass out of range', command(world, 0, 2n, fx(1), fx(1), fx(0), fx(0), fx(-2)), REFUSED);
check('no command', command(world, 999), REFUSED);
for (let tick = 0; tick < 64; tick++) engine.step(world);
// 100 − ½·8·1², 1 + 3·1.
check('place', [0, 1].map((i) => engine.read(world, ball, i)).join(), [fx(4), fx(96)].join());
const saved = engine.snapshot(world);
const before = engine.hash(world);
command(world, 4, ball, fx(2), fx(0), 0n, 0n, 4n);
check('velocity after an impulse', engine.read(world, ball, 2), fx(4));
for (let tick = 0; tick < 64; tick++) engine.step(world);
if (engine.hash(world) === before) check('the hash of another state', before, 'another');
check('bytes that are a snapshot', engine.restore(world, saved), 0);
check('the hash of a state that is back', engine.hash(world), before);
check('the text of a number', engine.texts(world, -12345n) & 1n, 1n);
const bytesOf = (buffer) => new Uint8Array(engine.memory.buffer, engine.address(buffer), engine.length(buffer));
// A command as the network brings it: number 21, gravity, two numbers of 64 bits.
const gravity = engine.buffer(17);
const view = new DataView(engine.memory.buffer, engine.address(gravity), 17);
view.setUint8(0, 21);
view.setBigInt64(9, fx(-4), true);
check('a command of bytes', engine.execute(world, gravity), 0);
const recorder = engine.record(world);
for (let tick = 0; tick < 100; tick++) engine.record_step(recorder, world);
const replay = engine.record_end(recorder, world);
check('a replay', engine.verify(replay), 100n);
bytesOf(replay)[200] ^= 1;
check('a replay that was changed', engine.verify(replay), -1n);
bytesOf(saved)[40] ^= 1;
check('bytes that are no snapshot', engine.restore(world, saved), -1);
for (const buffer of [saved, gravity, replay]) engine.discard(buffer);
engine.destroy(world);
const digest = BigInt.asUintN(64, engine.corpus()).toString(16).padStart(16, '0');
check('the digest of the corpus', digest, golden);
console.log(`corpus ${digest}`);
