// Which part of the plane is shown, and where its points are on the canvas.

const canvas = $("canvas");
const camera = { x: 0, y: 0, scale: 1 };
let size = { width: 1, height: 1 };

const screenX = x => (x - camera.x) * camera.scale + size.width / 2;
const screenY = y => (camera.y - y) * camera.scale + size.height / 2;
const worldX = x => (x - size.width / 2) / camera.scale + camera.x;
const worldY = y => camera.y - (y - size.height / 2) / camera.scale;

// The distance from a shape's centre of mass to what of it is farthest.
function reach(shape) {
  const far = points => Math.max(...points.map(([x, y]) => Math.hypot(x, y)));
  const reaches = {
    c: ([centre, radius]) => far([centre]) + radius,
    l: ([from, to, radius]) => far([from, to]) + radius,
    p: ([corners]) => far(corners),
    s: ends => far(ends),
  };
  return Math.max(0, ...shape.map(([letter, ...rest]) => reaches[letter](rest)));
}
const reaches = run.shapes.map(reach);
const reachOf = look => look.shape === null ? 0 : reaches[look.shape];

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
    const radius = isMoving(body) ? reachOf(body.look(tickOf(frame))) : 0;
    [X, Y].forEach((axis, i) => {
      const at = body.near(frame, axis);
      extents[i].push(at - radius, at + radius);
    });
  };
  sampled(add);
  if (extents[0].length === 0) return [[-5, -5], [5, 5]];
  let [left, bottom, right, top] = box(...extents);
  // Where they start is seen, and what is fixed, unless it is much larger than the rest or far away.
  const room = 3 * Math.max(right - left, top - bottom, 1), [x0, y0] = [(left + right) / 2, (bottom + top) / 2];
  const include = (x, y, radius) => {
    if (radius > room || Math.hypot(x - x0, y - y0) > 2 * room) return;
    [left, right] = [Math.min(left, x - radius), Math.max(right, x + radius)];
    [bottom, top] = [Math.min(bottom, y - radius), Math.max(top, y + radius)];
  };
  for (const body of bodies) {
    if (body.isThere(0)) include(body.near(0, X), body.near(0, Y), reachOf(body.look(run.start)));
  }
  for (const [, , [letter, ...ends]] of run.fields) {
    for (const [point, body] of "as".includes(letter) ? ends : []) if (body === undefined) include(...point, 0);
  }
  // The ends of joints, and not their axes: limits may be far out.
  for (const [letter, [point, body]] of run.joints.flatMap(([, , drawing]) => drawing)) {
    if (letter === "m" && body === undefined) include(...point, 0);
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
