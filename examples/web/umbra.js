// The C interface for JavaScript. Numbers are BigInt, multiples of 2^-32; no float goes in.

// Of `capi/include/umbra_physics.h`: no padding, so that places are sums of sizes.
const POSE = 56, FIELD_DEF = 232, NO_HANDLE = 0xffff_ffff_ffff_ffffn;
const API = 2, SPRING = 1, BUFFER_TOO_SMALL = 903;
const PAGE = 65536;

export const ONE = 1n << 32n;
export const BODY_FRAME = 1;
// For drawing alone.
export const toFloat = number => Number(number) / 4294967296;

export async function load(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status}: build.sh makes it`);
  const { instance } = await WebAssembly.instantiate(await answer.arrayBuffer());
  return new Library(instance.exports);
}

class Library {
  // Room for arguments and answers: pages that the module's own allocator does not know. Results are at the start, arguments
  // behind, lists at the end.
  static RESULT = 0;
  static ARGUMENT = 256;
  static LIST = 4096;

  constructor(exports) {
    this.exports = exports;
    this.pages = 4;
    this.base = exports.memory.grow(this.pages) * PAGE;
    if (exports.umbra_api() !== API) throw new Error("the module has another interface");
  }

  get view() { return new DataView(this.exports.memory.buffer); }
  get bytes() { return new Uint8Array(this.exports.memory.buffer); }
  get physicsVersion() { return this.exports.umbra_physics_version(); }

  // Calls, and throws what is refused, with its words and number.
  call(name, ...args) {
    const status = this.exports[name](...args);
    if (status !== 0) throw Object.assign(new Error(`${name}: ${this.lastMessage()} [E${status}]`), { status });
  }

  // The value that a call writes where its last argument points.
  get64(name, ...args) {
    const place = this.base + Library.RESULT;
    this.call(name, ...args, place);
    return this.view.getBigUint64(place, true);
  }

  get32(name, ...args) {
    const place = this.base + Library.RESULT;
    this.call(name, ...args, place);
    return this.view.getUint32(place, true);
  }

  lastMessage() {
    const at = this.base + Library.LIST, capacity = this.pages * PAGE - Library.LIST;
    this.exports.umbra_last_message(at, capacity, this.base + Library.RESULT);
    return this.textAt(at);
  }

  textAt(at) {
    const length = this.view.getUint32(this.base + Library.RESULT, true);
    return new TextDecoder().decode(this.bytes.slice(at, at + length));
  }

  text(name, ...args) {
    const at = this.base + Library.LIST;
    this.call(name, ...args, at, this.pages * PAGE - Library.LIST, this.base + Library.RESULT);
    return this.textAt(at);
  }

  // Copies bytes to where arguments are; gives the place and the length.
  put(bytes) {
    const at = this.base + Library.LIST;
    if (bytes.length > this.pages * PAGE - Library.LIST) throw new Error("too long");
    this.bytes.set(bytes, at);
    return [at, bytes.length];
  }

  putText(text) { return this.put(new TextEncoder().encode(text)); }

  // A list of entries of so many bytes: a view of them, until the next call.
  list(name, size, ...args) {
    const at = this.base + Library.LIST, count = this.base + Library.RESULT;
    const status = this.exports[name](...args, at, Math.floor((this.pages * PAGE - Library.LIST) / size), count);
    if (status === BUFFER_TOO_SMALL) throw new Error(`${name}: more than there is room for`);
    if (status !== 0) throw new Error(`${name}: ${this.lastMessage()} [E${status}]`);
    const length = this.view.getUint32(count, true);
    return { length, view: new DataView(this.exports.memory.buffer, at, length * size), size };
  }

  // The number nearest to a decimal text, to the bit as the library reads it.
  number(text) { return BigInt.asIntN(64, this.get64("umbra_fx_from_text", ...this.putText(text))); }

  fromScene(text) { return new World(this, this.get32("umbra_world_from_scene", ...this.putText(text), 131072)); }

  draft() { return new Draft(this, this.get32("umbra_draft_new")); }
}

class World {
  constructor(library, handle) {
    this.library = library;
    this.handle = handle;
    this.inputs = library.get32("umbra_inputs_new");
  }

  free() {
    this.library.exports.umbra_inputs_free(this.inputs);
    this.library.exports.umbra_world_free(this.handle);
  }

  find(name) { return this.library.get64("umbra_world_find_body", this.handle, ...this.library.putText(name)); }
  leaveScene() { this.library.call("umbra_world_leave_scene", this.handle); }
  get tick() { return Number(this.library.get64("umbra_world_tick", this.handle)); }
  get hash() { return this.library.get64("umbra_world_state_hash", this.handle); }

  // Carries out commands, bytes of `{player, sequence, bytes}`, and steps.
  step(commands) {
    this.library.call("umbra_inputs_clear", this.inputs);
    for (const { player, sequence, bytes } of commands) {
      this.library.call("umbra_inputs_insert", this.inputs, player, sequence, ...this.library.put(bytes));
    }
    this.library.call("umbra_world_step_inputs", this.handle, this.inputs);
  }

  // Where all bodies are, in integers and for drawing.
  poses() {
    const { length, view } = this.library.list("umbra_world_poses", POSE, this.handle);
    return Array.from({ length }, (_, i) => {
      const at = i * POSE, x = view.getBigInt64(at + 8, true), y = view.getBigInt64(at + 16, true);
      return {
        body: view.getBigUint64(at, true), x, y, drawX: toFloat(x), drawY: toFloat(y),
        angle: toFloat(view.getBigInt64(at + 24, true)), look: Number(view.getBigUint64(at + 40, true)),
      };
    });
  }

  // The pairs of bodies that springs join.
  springs() {
    const { length, view } = this.library.list("umbra_world_fields", 8, this.handle);
    const fields = Array.from({ length }, (_, i) => view.getBigUint64(i * 8, true));
    const at = this.library.base + Library.ARGUMENT;
    return fields.flatMap(field => {
      this.library.call("umbra_world_field", this.handle, field, at);
      const def = new DataView(this.library.exports.memory.buffer, at, FIELD_DEF);
      const near = def.getBigUint64(16, true), far = def.getBigUint64(40, true);
      return def.getUint32(0, true) === SPRING && far !== NO_HANDLE ? [[near, far]] : [];
    });
  }

  moveTo(body, x, y) { this.library.call("umbra_world_set_position", this.handle, body, x, y); }

  firstDifference(other) {
    return this.library.text("umbra_world_first_difference", this.handle, other.handle);
  }
}

// Writes down what would be done, as the bytes to send.
class Draft {
  constructor(library, handle) {
    this.library = library;
    this.handle = handle;
  }

  taken() {
    const { length, view } = this.library.list("umbra_draft_command", 1, this.handle);
    return new Uint8Array(view.buffer.slice(view.byteOffset, view.byteOffset + length));
  }

  impulse(body, x, y) {
    this.library.call("umbra_world_apply_impulse", this.handle, body, x, y, 0, 0);
    return this.taken();
  }

  angularImpulse(body, by) {
    this.library.call("umbra_world_apply_angular_impulse", this.handle, body, by, 0);
    return this.taken();
  }

  force(body, x, y, options) {
    this.library.call("umbra_world_apply_force", this.handle, body, x, y, 0, options);
    return this.taken();
  }

  torque(body, by) {
    this.library.call("umbra_world_apply_torque", this.handle, body, by, 0);
    return this.taken();
  }
}
