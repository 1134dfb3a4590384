// The page: plays a match, draws it between its ticks, and says what came of each.

import { BODY_FRAME, ONE, load } from "./umbra.js";
import { Match } from "./match.js";

const RATE = 60, MOST_TICKS_A_FRAME = 6, TRAIL = 70;
const VIEW = { left: -12.5, right: 12.5, bottom: -10, top: 14.5 };
// The boxes of the stack, and the top of the floor, m.
const BOX = 0.9, FLOOR = -9;
const get = id => document.getElementById(id);
const canvases = ["a", "b"].map(get), line = get("line");
const hex = hash => hash.toString(16).padStart(16, "0");

let library, sources, match, springs;
let isPlaying = true, behind = 0, last, before, now, trails, outcomes;
// What was thrown first: after a trap there is nothing left to agree, whatever is pressed.
let failure;
const keys = new Set();
let clicks = [];

function fail(error) {
  failure ??= error;
  setPlaying(false);
  get("verdict").dataset.state = "wrong";
  get("verdict").textContent = failure.message;
}

// The same function, but what it throws is told before it goes on.
function guarded(act) {
  return (...values) => {
    try {
      return act(...values);
    } catch (error) {
      fail(error);
      throw error;
    }
  };
}

async function text(file) {
  const answer = await fetch(file);
  if (!answer.ok) throw new Error(`${file}: ${answer.status}`);
  return answer.text();
}

function begin() {
  const ended = match;
  match = new Match(library, ...sources);
  ended?.free();
  springs = match.worlds[0].springs();
  trails = [new Map(), new Map()];
  outcomes = [];
  now = match.worlds.map(world => world.poses());
  before = now;
  behind = 0;
  last = undefined;
  clicks = [];
  tell();
}

// What the player does in the tick to come, as bytes.
function commands() {
  const list = clicks.flatMap(([x, y]) => match.push(x, y));
  clicks = [];
  const { draft, ship } = match;
  if (keys.has("ArrowUp")) list.push(draft.force(ship, 0n, 8n * ONE, BODY_FRAME));
  const turn = BigInt(keys.has("ArrowLeft")) - BigInt(keys.has("ArrowRight"));
  if (turn !== 0n) list.push(draft.torque(ship, turn * ONE / 2n));
  return list;
}

function tick() {
  match.step(commands());
  before = now;
  now = match.worlds.map(world => world.poses());
  now.forEach((poses, side) => poses.filter(pose => pose.look === 4 || pose.look === 6).forEach(({ body, drawX, drawY }) => {
    const trail = trails[side].get(body) ?? [];
    trail.push([drawX, drawY]);
    if (trail.length > TRAIL) trail.shift();
    trails[side].set(body, trail);
  }));
  const alike = match.hashes[0] === match.hashes[1];
  if (outcomes.at(-1)?.alike === alike) outcomes.at(-1).ticks++;
  else outcomes.push({ alike, ticks: 1 });
}

// So many ticks at once.
function advance(count) {
  for (let i = 0; i < count; i++) tick();
  tell();
  draw(1);
}

function farthest() {
  const [a, b] = now;
  return a.reduce((most, pose, i) => Math.max(most, Math.hypot(Number(pose.x - b[i].x), Number(pose.y - b[i].y))), 0) / 2 ** 32;
}

function tell() {
  const { parted, native } = match;
  const isWrong = native.parted !== null, verdict = get("verdict");
  const state = isWrong ? "wrong" : parted ? "parted" : "agree";
  if (!failure && (verdict.dataset.state !== state || state !== "agree")) {
    verdict.dataset.state = state;
    verdict.textContent = isWrong ? `A is not as native at tick ${native.parted}`
      : parted ? `parted at tick ${parted.tick}` : "in agreement";
  }
  tellDifference(parted);
  match.hashes.forEach((hash, i) => get(i ? "hash-b" : "hash-a").textContent = hex(hash));
  document.body.classList.toggle("differ", match.hashes[0] !== match.hashes[1]);
  get("tick").textContent = match.tick;
  get("inputs").textContent = match.inputs;
  get("alike").textContent = `${match.alike} of ${match.tick}`;
  const all = sources[2].hashes.length;
  get("native").textContent = `${native.equal} of ${native.compared}${match.isScripted ? "" : ", then by hand"}`;
  get("native").title = `${all} hashes of the native program, one every ${sources[2].every} ticks of the script`;
  const distance = farthest();
  get("apart").textContent = distance === 0 ? "0 m" : `${distance.toPrecision(3)} m`;
  get("ulp").disabled = Boolean(parted);
}

// The first value that differs, with what is the same of both in a fainter ink. It comes as `body 3, position.x: 1 and 2`.
let told;
function tellDifference(parted) {
  if (parted === told) return;
  told = parted;
  get("difference").hidden = !parted;
  if (!parted) return;
  const [what, values] = parted.difference.split(": "), pair = values.split(" and ");
  let same = 0;
  while (same < pair[0].length && pair[0][same] === pair[1][same]) same++;
  const element = (name, text, ...children) => {
    const made = document.createElement(name);
    made.append(text, ...children);
    return made;
  };
  get("difference").replaceChildren(
    element("strong", what), " is the first value that differs",
    ...pair.map((value, i) => element("code", `${"AB"[i]} `, element("span", value.slice(0, same)), value.slice(same))),
  );
}

// Colours are those of the style sheet.
let colours = {};
function readColours() {
  const style = getComputedStyle(document.documentElement);
  const names = ["ink", "soft", "faint", "paper", "panel", "thread", "node", "star", "planet", "dust", "ship", "box", "agree", "parted", "native"];
  colours = Object.fromEntries(names.map(name => [name, style.getPropertyValue(`--${name}`).trim()]));
}

// Makes a canvas as sharp as the screen; gives its size in CSS pixels and a pen.
function pen(canvas) {
  const ratio = devicePixelRatio || 1, { clientWidth: width, clientHeight: height } = canvas;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

// Metres to pixels of a canvas.
function camera(width, height) {
  const scale = Math.min(width / (VIEW.right - VIEW.left), height / (VIEW.top - VIEW.bottom));
  const x0 = width / 2 - scale * (VIEW.left + VIEW.right) / 2, y0 = height / 2 + scale * (VIEW.bottom + VIEW.top) / 2;
  return { scale, to: (x, y) => [x0 + x * scale, y0 - y * scale], from: (px, py) => [(px - x0) / scale, (y0 - py) / scale] };
}

// The world between its last two ticks.
function drawWorld(side, share) {
  const { context: c, width, height } = pen(canvases[side]);
  const { scale, to } = camera(width, height);
  const earlier = new Map(before[side].map(pose => [pose.body, pose]));
  const places = new Map();
  for (const pose of now[side]) {
    const from = earlier.get(pose.body) ?? pose;
    // The shorter way round.
    const turn = pose.angle - from.angle, way = turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI));
    const x = from.drawX + (pose.drawX - from.drawX) * share, y = from.drawY + (pose.drawY - from.drawY) * share;
    places.set(pose.body, { at: to(x, y), angle: from.angle + way * share, look: pose.look });
  }
  c.lineJoin = c.lineCap = "round";
  c.strokeStyle = colours.thread;
  c.lineWidth = 1;
  c.beginPath();
  for (const [near, far] of springs) {
    c.moveTo(...places.get(near).at);
    c.lineTo(...places.get(far).at);
  }
  c.stroke();
  for (const [body, trail] of trails[side]) {
    c.strokeStyle = places.get(body)?.look === 6 ? colours.ship : colours.planet;
    c.lineWidth = 1.5;
    const groups = 7;
    for (let group = 0; group < groups; group++) {
      c.globalAlpha = 0.06 + 0.4 * group / groups;
      c.beginPath();
      const first = Math.floor(trail.length * group / groups), end = Math.ceil(trail.length * (group + 1) / groups);
      trail.slice(first, end + 1).forEach(([x, y], i) => i ? c.lineTo(...to(x, y)) : c.moveTo(...to(x, y)));
      c.stroke();
    }
    c.globalAlpha = 1;
  }
  const disc = ([x, y], radius, colour) => {
    c.fillStyle = colour;
    c.beginPath();
    c.arc(x, y, Math.max(radius * scale, 1), 0, 2 * Math.PI);
    c.fill();
  };
  const outline = (corners, at, angle, colour) => {
    c.save();
    c.translate(...at);
    c.rotate(-angle);
    c.beginPath();
    corners.forEach(([x, y]) => c.lineTo(x * scale, -y * scale));
    c.closePath();
    c.fillStyle = colour;
    c.strokeStyle = colours.paper;
    c.lineWidth = 1.5;
    c.fill();
    c.stroke();
    c.restore();
  };
  for (const { at, angle, look } of places.values()) {
    if (look === 1) disc(at, 0.09, colours.node);
    if (look === 2) disc(at, 0.14, colours.ink);
    if (look === 5) disc(at, 0.07, colours.dust);
    if (look === 4) disc(at, 0.3, colours.planet);
    if (look === 3) {
      for (const [radius, alpha] of [[1.7, 0.08], [1.3, 0.12], [0.95, 0.2], [0.65, 1]]) {
        c.globalAlpha = alpha;
        disc(at, radius, colours.star);
      }
    }
    if (look === 6) outline([[-0.4, -0.45], [0.4, -0.45], [0, 0.65]], at, angle, colours.ship);
    if (look === 7) outline([[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [x * BOX / 2, y * BOX / 2]), at, angle, colours.box);
    if (look === 8) {
      const [left, top] = to(VIEW.left, FLOOR), [right, bottom] = to(VIEW.right, VIEW.bottom);
      c.fillStyle = colours.faint;
      c.fillRect(left, top, right - left, bottom - top);
    }
  }
}

// A column a tick: alike or not; a tick mark where the native program's hash was compared.
function drawLine() {
  const { context: c, width, height } = pen(line);
  const ticks = Math.max(match.scriptedTicks, match.tick), share = width / ticks;
  c.fillStyle = colours.faint;
  c.fillRect(0, 6, width, height - 12);
  let from = 0;
  for (const { alike, ticks } of outcomes) {
    c.fillStyle = alike ? colours.agree : colours.parted;
    c.fillRect(from * share, 6, ticks * share, height - 12);
    from += ticks;
  }
  const { every, hashes } = sources[2];
  for (let i = 0; i < hashes.length; i++) {
    const isCompared = i < match.native.compared, isWrong = match.native.parted !== null && i * every >= match.native.parted;
    c.fillStyle = isWrong && isCompared ? colours.parted : isCompared ? colours.native : colours.faint;
    c.fillRect(Math.min(i * every * share, width - 2), 0, 2, height);
  }
}

function draw(share) {
  [0, 1].forEach(side => drawWorld(side, share));
  drawLine();
}

const frame = guarded(time => {
  if (isPlaying) {
    behind += last === undefined ? 0 : (time - last) / 1000 * RATE;
    // A machine that is too slow, or a tab that was away, lags instead of catching up.
    let ticks = Math.min(Math.floor(behind), MOST_TICKS_A_FRAME);
    behind = Math.min(behind - ticks, 1);
    if (ticks > 0) {
      while (ticks-- > 0) tick();
      tell();
    }
  }
  last = time;
  draw(Math.min(behind, 1));
  requestAnimationFrame(frame);
});

function setPlaying(on) {
  isPlaying = on;
  last = undefined;
  get("play").textContent = on ? "Pause" : "Play";
}

get("play").onclick = () => setPlaying(!isPlaying);
get("again").onclick = guarded(begin);
get("ulp").onclick = guarded(() => match.putOff());
for (const canvas of canvases) {
  canvas.onpointerdown = event => {
    const box = canvas.getBoundingClientRect();
    const point = camera(box.width, box.height).from(event.clientX - box.left, event.clientY - box.top);
    // Here the float ends: what is said of the click is whole, and the same for both.
    clicks.push(point.map(metres => BigInt(Math.round(metres * 65536)) << 16n));
  };
}
const steers = event => ["ArrowUp", "ArrowLeft", "ArrowRight"].includes(event.key);
addEventListener("keydown", event => {
  if (!steers(event)) return;
  keys.add(event.key);
  event.preventDefault();
});
addEventListener("keyup", event => keys.delete(event.key));
addEventListener("blur", () => keys.clear());
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", readColours);

// For whoever tries the page from outside.
window.demo = {
  get match() { return match; },
  advance: guarded(advance),
  begin: guarded(begin),
  setPlaying,
};

try {
  const [arena, script, golden] = await Promise.all(["arena.json", "script.json", "golden.json"].map(text));
  library = await load("umbra_physics.wasm");
  sources = [arena, JSON.parse(script), JSON.parse(golden)];
  if (sources[2].physics_version !== library.physicsVersion) {
    throw new Error(`golden.json is of physics version ${sources[2].physics_version}, the module of ${library.physicsVersion}`);
  }
  readColours();
  begin();
  requestAnimationFrame(frame);
  document.body.classList.add("ready");
} catch (error) {
  fail(error);
  throw error;
}
