// A match on one machine: two worlds that are told the same, and never of each other.

const SCRIPT = 0, PLAYER = 1;

export class Match {
  constructor(library, arena, script, golden) {
    // Agreement with nothing is none.
    const { every, hashes } = golden;
    const isHash = hash => typeof hash === "string" && /^[0-9a-f]{16}$/.test(hash);
    if (!(Number.isInteger(every) && every > 0 && Array.isArray(hashes) && hashes.length > 1 && hashes.every(isHash))) {
      throw new Error("golden.json has no hashes to compare with");
    }
    Object.assign(this, { library, golden });
    this.worlds = [0, 1].map(() => library.fromScene(arena));
    this.draft = library.draft();
    this.ship = this.worlds[0].find("ship");
    this.script = new Map();
    for (const { tick, body, impulse, angular_impulse } of script) {
      const who = this.worlds[0].find(body);
      const bytes = impulse
        ? this.draft.impulse(who, ...impulse.map(text => library.number(text)))
        : this.draft.angularImpulse(who, library.number(angular_impulse[0]));
      this.script.set(tick, [...this.script.get(tick) ?? [], bytes]);
    }
    this.worlds.forEach(world => world.leaveScene());
    // What was compared: how many ticks were alike, the first that was not, and how many were as the native program's.
    this.tick = 0;
    this.inputs = 0;
    this.alike = 0;
    this.parted = null;
    this.native = { compared: 0, equal: 0, parted: null };
    this.isScripted = true;
    this.hashes = this.worlds.map(world => world.hash);
    this.compare();
    if (this.native.compared !== 1) throw new Error("the start was not compared");
  }

  // A tick with these commands of the player's. They leave the script: no native program has seen them.
  step(commands = []) {
    if (commands.length > 0) this.isScripted = false;
    const inputs = [
      ...(this.script.get(this.tick) ?? []).map((bytes, sequence) => ({ player: SCRIPT, sequence, bytes })),
      ...commands.map((bytes, sequence) => ({ player: PLAYER, sequence, bytes })),
    ];
    this.inputs += inputs.length;
    this.worlds.forEach(world => world.step(inputs));
    this.tick++;
    this.hashes = this.worlds.map(world => world.hash);
    this.compare();
  }

  compare() {
    const [a, b] = this.hashes;
    if (a === b) {
      this.alike += this.tick > 0;
    } else {
      this.parted ??= { tick: this.tick, difference: this.worlds[0].firstDifference(this.worlds[1]) };
    }
    const index = this.tick / this.golden.every;
    const expected = Number.isInteger(index) && this.isScripted ? this.golden.hashes[index] : undefined;
    if (expected !== undefined) {
      this.native.compared++;
      if (BigInt(`0x${expected}`) === a) this.native.equal++;
      else this.native.parted ??= this.tick;
    }
  }

  get scriptedTicks() { return (this.golden.hashes.length - 1) * this.golden.every; }

  // Moves the ship of B to the right by the least there is, 2^-32 m: 0.23 nanometres.
  putOff() {
    const { x, y } = this.worlds[1].poses().find(pose => pose.body === this.ship);
    this.worlds[1].moveTo(this.ship, x + 1n, y);
  }

  // Commands that push all that is near a point away from it. Integers from the start: what is computed in floats, and where
  // the mouse is, differs from machine to machine.
  push(x, y) {
    const reach = 3n << 32n;
    return this.worlds[0].poses().flatMap(({ body, x: bodyX, y: bodyY, look }) => {
      const [dx, dy] = [bodyX - x, bodyY - y];
      if (dx * dx + dy * dy > reach * reach || ![1, 4, 5, 6, 7].includes(look)) return [];
      // Heavy ones take more, and boxes are to fly.
      const share = { 1: 30n, 4: 3n, 5: 300n, 6: 3n, 7: 1n }[look];
      return [this.draft.impulse(body, 3n * dx / share, 3n * dy / share)];
    });
  }

  free() {
    this.worlds.forEach(world => world.free());
    this.library.exports.umbra_world_free(this.draft.handle);
  }
}
