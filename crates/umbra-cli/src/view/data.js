// What was recorded: exact, as it stands in the page.

const $ = id => document.getElementById(id);
const run = JSON.parse($("run").textContent);

const bytes = (() => {
  const text = atob($("bytes").textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
})();

const TWO32 = 4294967296;
// The values of a sample, as Rust's `Sample` has them.
const X = 0, Y = 1, ANGLE = 2, VX = 3, VY = 4, SPIN = 5, VALUES = 6;

// The samples of a track, each value as two words of 32 bits, the lower first. `track.rs` says how they are stored.
function decoded(offset, count) {
  const words = new Int32Array(count * 2 * VALUES);
  let at = offset, run = 0;
  let low = 0, high = 0;
  // A varint of 64 bits into `low` and `high`.
  const read = () => {
    low = high = 0;
    for (let shift = 0; shift < 70; shift += 7) {
      const byte = bytes[at++], seven = byte & 0x7f;
      if (shift < 32) low |= seven << shift;
      if (shift > 28) high |= seven << (shift - 32);
      if (shift === 28) high |= seven >> 4;
      if (byte < 0x80) return;
    }
  };
  for (let n = 0; n < count; n++) {
    let which = 0;
    if (run > 0) run--;
    else {
      which = bytes[at++];
      if (which === 0) {
        read();
        run = (high >>> 0) * TWO32 + (low >>> 0);
      }
    }
    const to = n * 2 * VALUES;
    // The first sample stands for the two before it too.
    const a = to - 2 * VALUES, b = n > 1 ? a - 2 * VALUES : a, c = n > 2 ? b - 2 * VALUES : b;
    for (let i = 0; i < 2 * VALUES; i += 2) {
      let l = 0, h = 0;
      if (n > 0) {
        l = 3 * ((words[a + i] >>> 0) - (words[b + i] >>> 0)) + (words[c + i] >>> 0);
        h = 3 * (words[a + i + 1] - words[b + i + 1]) + words[c + i + 1];
      }
      if (which >> (i / 2) & 1) {
        read();
        const sign = -(low & 1);
        l += ((low >>> 1 | high << 31) ^ sign) >>> 0;
        h += high >>> 1 ^ sign;
      }
      // All sums are below 2^53, and `|` cuts them to 32 bits.
      words[to + i] = l | 0;
      words[to + i + 1] = h + Math.floor(l / TWO32) | 0;
    }
  }
  return words;
}

// A value as a double, for drawing.
const near = (words, at) => words[2 * at + 1] + (words[2 * at] >>> 0) / TWO32;

// A value as an exact decimal, as `Fx` writes it.
function exact(words, at) {
  const bits = (BigInt(words[2 * at + 1]) << 32n) + BigInt(words[2 * at] >>> 0);
  const size = bits < 0n ? -bits : bits;
  let rest = size & 0xffffffffn, digits = "";
  while (rest > 0n) {
    rest *= 10n;
    digits += rest >> 32n;
    rest &= 0xffffffffn;
  }
  return (bits < 0n ? "-" : "") + (size >> 32n) + (digits && "." + digits);
}

const LOOKS = ["dynamic", "kinematic", "static", "asleep", "quarantined", "disabled"];

class Body {
  constructor([slot, generation, name, from, to, first, count, offset, looks, jumps], index) {
    Object.assign(this, { slot, generation, name, from, to, first, count, looks, jumps, index });
    this.words = decoded(offset, count);
    this.id = `body ${slot}` + (generation > 0 ? ` (generation ${generation})` : "");
    this.label = name || this.id;
  }

  isThere(frame) {
    return frame >= this.first && frame < this.first + this.count;
  }

  // Where its values of a frame begin.
  at(frame) {
    return (frame - this.first) * VALUES;
  }

  near(frame, value) {
    return near(this.words, this.at(frame) + value);
  }

  exact(frame, value) {
    return exact(this.words, this.at(frame) + value);
  }

  look(tick) {
    let i = this.looks.length - 1;
    while (i > 0 && this.looks[i][0] > tick) i--;
    const [, kind, activity, shape, key, mass] = this.looks[i];
    return { kind, shape, key, mass, index: activity > 0 ? 2 + activity : kind };
  }
}

const bodies = run.bodies.map((body, index) => new Body(body, index));
const lastFrame = run.frames - 1;
const tickOf = frame => frame >= lastFrame ? run.last : run.start + frame * run.stride;
// The last frame that is not after a tick, and the first that is not before it.
const frameBefore = tick => tick >= run.last ? lastFrame : Math.max(0, Math.floor((tick - run.start) / run.stride));
const frameFrom = tick => Math.min(lastFrame, Math.max(0, Math.ceil((tick - run.start) / run.stride)));

function hashOf(frame) {
  let hash = "";
  for (let i = 7; i >= 0; i--) hash += bytes[8 * frame + i].toString(16).padStart(2, "0");
  return hash;
}

const clock = run.clock.map(([tick, top, bottom, num, den]) => ({
  tick, top: BigInt(top), bottom: BigInt(bottom), num: BigInt(num), den: BigInt(den),
  seconds: Number(BigInt(top)) / Number(BigInt(bottom)), step: num / den,
}));
const spanOf = tick => clock.findLast(span => span.tick <= tick) ?? clock[0];

// The time at a tick in s: exact, as a ratio of integers in lowest terms, and as a double.
function timeOf(tick) {
  const span = spanOf(tick);
  const top = span.top * span.den + BigInt(tick - span.tick) * span.num * span.bottom;
  const bottom = span.bottom * span.den;
  let [a, b] = [top, bottom];
  while (b > 0n) [a, b] = [b, a % b];
  return [top / a, bottom / a];
}

function secondsOf(tick) {
  const span = spanOf(tick);
  return span.seconds + (tick - span.tick) * span.step;
}

// A ratio as a decimal where that ends within six digits, else as a ratio and about.
function timeText(tick) {
  const [top, bottom] = timeOf(tick);
  const millionths = top * 1000000n;
  const about = (Number(millionths / bottom) / 1e6).toFixed(3);
  if (millionths % bottom === 0n) return `${Number(millionths / bottom) / 1e6} s`;
  return `${top}/${bottom} s ≈ ${about} s`;
}
