// Which part of the plane is shown, and where its points are on the canvas.

const canvas = $("canvas");
const camera = { x: 0, y: 0, scale: 1 };
let size = { width: 1, height: 1 };

const screenX = x => (x - camera.x) * camera.scale + size.width / 2;
const screenY = y => (camera.y - y) * camera.scale + size.height / 2;
const worldX = x => (x - size.width / 2) / camera.scale + camera.x;
const worldY = y => camera.y - (y - size.height / 2) / camera.scale;

// What draws a collider that is not simply solid, by its letter: `drawing.rs` has it.
const SURFACES = ["sensor", "one-way", "belt"];

// The distance from a shape's centre of mass to what of it is farthest.
function reach(shape) {
  const far = points => Math.max(...points.map(([x, y]) => Math.hypot(x, y)));
  const reaches = {
    c: ([centre, radius]) => far([centre]) + radius,
    l: ([from, to, radius]) => far([from, to]) + radius,
    p: ([corners]) => far(corners),
    s: ends => far(ends),
  };
  for (const surface of SURFACES) reaches[surface] = ([parts]) => reach(parts);
  return Math.max(0, ...shape.map(([letter, ...rest]) => reaches[letter](rest)));
}
const reaches = run.shapes.map(reach);
const reachOf = look => look.shape === null ? 0 : reaches[look.shape];

// The box around a shape that is turned: left, bottom, right and top from its centre of mass.
function boxOf(shape, angle) {
  const cos = Math.cos(angle), sin = Math.sin(angle), box = [0, 0, 0, 0];
  let isEmpty = true;
  const add = ([x, y], radius) => {
    const [px, py] = [x * cos - y * sin, x * sin + y * cos];
    const [left, bottom, right, top] = isEmpty ? [px, py, px, py] : box;
    isEmpty = false;
    box[0] = Math.min(left, px - radius);
    box[1] = Math.min(bottom, py - radius);
    box[2] = Math.max(right, px + radius);
    box[3] = Math.max(top, py + radius);
  };
  const parts = {
    c: ([centre, radius]) => add(centre, radius),
    l: ([from, to, radius]) => [from, to].forEach(end => add(end, radius)),
    p: ([corners]) => corners.forEach(corner => add(corner, 0)),
    s: ends => ends.forEach(end => add(end, 0)),
  };
  const visit = ([letter, ...rest]) => SURFACES.includes(letter) ? rest[0].forEach(visit) : parts[letter](rest);
  shape.forEach(visit);
  return box;
}

// The box around a body at a frame, in the world.
function boxAt(body, frame) {
  const { shape } = body.look(tickOf(frame)), x = body.near(frame, X), y = body.near(frame, Y);
  const [left, bottom, right, top] = shape === null ? [0, 0, 0, 0] : boxOf(run.shapes[shape], body.near(frame, ANGLE));
  return [x + left, y + bottom, x + right, y + top];
}

// Values of bodies at frames spread over the run: some thousands.
function sampled(value) {
  const values = [];
  const total = bodies.reduce((sum, body) => sum + body.count, 0), step = Math.max(1, Math.floor(total / 20000));
  let next = 0, seen = 0;
  for (const body of bodies) {
    for (; next < seen + body.count; next += step) values.push(value(body, body.first + next - seen));
    seen += body.count;
  }
  return values;
}

// What to show at first: what the scene says, or where bodies are most of the time.
const wholeView = (() => {
  if (run.view) return run.view;
  const box = (xs, ys) => {
    const most = list => list.sort((a, b) => a - b) && [list[Math.floor(list.length * 0.01)], list[Math.ceil(list.length * 0.99) - 1]];
    const [[left, right], [bottom, top]] = [most(xs), most(ys)];
    return [left, bottom, right, top];
  };
  const isMoving = body => body.looks[0][1] !== 2;
  const extents = [[], []];
  const add = (body, frame) => {
    const [x, y] = [body.near(frame, X), body.near(frame, Y)];
    const [left, bottom, right, top] = isMoving(body) ? boxAt(body, frame) : [x, y, x, y];
    extents[0].push(left, right);
    extents[1].push(bottom, top);
  };
  sampled(add);
  if (extents[0].length === 0) return [[-5, -5], [5, 5]];
  let [left, bottom, right, top] = box(...extents);
  // Where they start is seen, and what is fixed, unless it is much larger than the rest or far away.
  const room = 3 * Math.max(right - left, top - bottom, 1), [x0, y0] = [(left + right) / 2, (bottom + top) / 2];
  const include = (least, lowest, most, highest) => {
    const radius = Math.max(most - least, highest - lowest) / 2;
    if (radius > room || Math.hypot((least + most) / 2 - x0, (lowest + highest) / 2 - y0) > 2 * room) return;
    [left, right] = [Math.min(left, least), Math.max(right, most)];
    [bottom, top] = [Math.min(bottom, lowest), Math.max(top, highest)];
  };
  for (const body of bodies) {
    if (body.isThere(0)) include(...boxAt(body, 0));
  }
  for (const [, , [letter, ...ends]] of run.fields) {
    for (const [point, body] of "as".includes(letter) ? ends : []) if (body === undefined) include(...point, ...point);
  }
  // The ends of joints, and not their axes: limits may be far out.
  for (const [letter, [point, body]] of run.joints.flatMap(([, , drawing]) => drawing)) {
    if (letter === "m" && body === undefined) include(...point, ...point);
  }
  return [[left, bottom], [right, top]];
})();

let isFitted = true;

function fit() {
  isFitted = true;
  const [[left, bottom], [right, top]] = wholeView;
  camera.x = (left + right) / 2;
  camera.y = (bottom + top) / 2;
  // Room for what stands over the picture.
  const [width, height] = [Math.max(size.width - 48, 40), Math.max(size.height - 112, 40)];
  camera.scale = Math.min(width / Math.max(right - left, 1e-6), height / Math.max(top - bottom, 1e-6), 1e5);
}
