// The picture.

const pen = canvas.getContext("2d");
let colours = {};

// Reads the colours of the theme that is on.
function readColours() {
  const style = getComputedStyle(document.documentElement);
  colours = {};
  for (const name of ["ink", "soft", "faint", "grid", "paper", "field", "contact", ...LOOKS]) {
    colours[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

// Adds what a shape is drawn as to a path of areas and one of lines, its centre of mass at x, y on the canvas. Sensors, one-way
// colliders and belts go to paths of their own, if there are some.
function trace(shape, areas, lines, x, y, angle, surfaces) {
  const scale = camera.scale, cos = Math.cos(angle) * scale, sin = Math.sin(angle) * scale;
  const point = ([px, py]) => [x + px * cos - py * sin, y - px * sin - py * cos];
  const line = (from, to) => {
    lines.moveTo(...point(from));
    lines.lineTo(...point(to));
  };
  for (const [letter, a, b, c] of shape) {
    if (SURFACES.includes(letter)) {
      const path = surfaces?.[letter];
      trace(a, path ?? areas, path ?? lines, x, y, angle);
      if (path && b) {
        const [dx, dy] = [(c[0] * cos - c[1] * sin) / scale, (c[0] * sin + c[1] * cos) / scale];
        arrow(surfaces.arrows, ...point(b), 16 * dx, -16 * dy);
      }
      continue;
    }
    switch (letter) {
      case "c": {
        const [cx, cy] = point(a);
        areas.moveTo(cx + b * scale, cy);
        areas.arc(cx, cy, b * scale, 0, 2 * Math.PI);
        // A spoke shows that it turns.
        if (b * scale > 2.5) line(a, c);
        break;
      }
      case "l": {
        const along = -angle - Math.atan2(b[1] - a[1], b[0] - a[0]), [fx, fy] = point(a), [tx, ty] = point(b);
        areas.moveTo(tx + c * scale * Math.sin(along), ty - c * scale * Math.cos(along));
        areas.arc(tx, ty, c * scale, along - Math.PI / 2, along + Math.PI / 2);
        areas.arc(fx, fy, c * scale, along + Math.PI / 2, along + 1.5 * Math.PI);
        areas.closePath();
        break;
      }
      case "p":
        a.map(point).forEach(([px, py], i) => i ? areas.lineTo(px, py) : areas.moveTo(px, py));
        areas.closePath();
        break;
      case "s":
        line(a, b);
        break;
    }
  }
}

// A body with a smaller radius than this, px, is a dot: a square one where there are thousands, which take less time.
const areMany = bodies.length > 500, DOT = areMany ? 1.3 : 3;

// A length that is 1, 2 or 5 times a power of ten, at least this.
function rounded(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * ([1, 2, 5].find(digit => digit * power >= least * 0.999999) ?? 10);
}

function drawGrid() {
  const each = rounded(70 / camera.scale);
  pen.lineWidth = 1;
  for (const [from, to, screen, length, isAcross] of [
    [worldX(0), worldX(size.width), screenX, size.height, false],
    [worldY(size.height), worldY(0), screenY, size.width, true],
  ]) {
    // Beyond 2^53 lines from the origin they are no more told apart.
    const first = Math.ceil(from / each), last = Math.floor(to / each);
    if (!(last - first < 1000)) continue;
    for (let n = first; n <= last; n++) {
      const at = Math.round(screen(n * each)) + 0.5;
      pen.strokeStyle = n === 0 ? colours.faint : colours.grid;
      pen.beginPath();
      pen.moveTo(isAcross ? 0 : at, isAcross ? at : 0);
      pen.lineTo(isAcross ? length : at, isAcross ? at : length);
      pen.stroke();
    }
  }
}

// How long a metre is and, for the kinds of arrows that are drawn, what one of them stands for.
function drawScales(...arrows) {
  const each = rounded(36 / camera.scale), length = each * camera.scale, right = size.width - 14;
  let bottom = size.height - 18;
  const path = new Path2D();
  path.moveTo(right - length, bottom - 4);
  path.lineTo(right - length, bottom);
  path.lineTo(right, bottom);
  path.lineTo(right, bottom - 4);
  const label = text => {
    pen.lineWidth = 3;
    pen.strokeStyle = colours.paper;
    pen.strokeText(text, right, bottom - 8);
    pen.fillText(text, right, bottom - 8);
  };
  pen.fillStyle = colours.soft;
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "right";
  label(`${Number(each.toPrecision(3))} m`);
  for (const [value, unit] of arrows.filter(shown => shown)) {
    bottom -= 36;
    arrow(path, right - FAST, bottom, FAST, 0);
    label(`${Number(value.toPrecision(3))} ${unit}`);
  }
  pen.strokeStyle = colours.soft;
  pen.lineWidth = 1.5;
  pen.stroke(path);
}

// Where a point of the world, or of a body, is on the canvas; null if the body is not there.
function anchor([[x, y], index], frame) {
  if (index === undefined) return [screenX(x), screenY(y)];
  const body = bodies[index];
  if (!body.isThere(frame)) return null;
  const angle = body.near(frame, ANGLE), cos = Math.cos(angle), sin = Math.sin(angle);
  return [
    screenX(body.near(frame, X) + x * cos - y * sin),
    screenY(body.near(frame, Y) + x * sin + y * cos),
    angle,
  ];
}

function arrow(path, x, y, dx, dy) {
  const length = Math.hypot(dx, dy);
  if (length < 2) return;
  const head = Math.min(8, length * 0.45), ux = dx / length, uy = dy / length;
  path.moveTo(x, y);
  path.lineTo(x + dx, y + dy);
  for (const side of [0.5, -0.5]) {
    path.moveTo(x + dx, y + dy);
    path.lineTo(x + dx - head * (ux + side * uy), y + dy - head * (uy - side * ux));
  }
}

function drawFields(frame, tick) {
  const springs = new Path2D(), centres = new Path2D(), zones = new Path2D(), pushes = new Path2D();
  for (const [from, to, [letter, a, b, c]] of run.fields) {
    if (tick < from || tick > to) continue;
    if (letter === "s") {
      const near = anchor(a, frame), far = anchor(b, frame);
      if (!near || !far) continue;
      springs.moveTo(near[0], near[1]);
      springs.lineTo(far[0], far[1]);
    } else if (letter === "a") {
      const at = anchor(a, frame);
      for (const radius of at ? [4, 9, 15] : []) {
        centres.moveTo(at[0] + radius, at[1]);
        centres.arc(at[0], at[1], radius, 0, 2 * Math.PI);
      }
    } else if (letter === "t") {
      const at = anchor(a, frame), length = Math.hypot(...b);
      if (!at || length === 0) continue;
      const angle = at[2] + Math.atan2(b[1], b[0]), cos = 26 * Math.cos(angle), sin = 26 * Math.sin(angle);
      arrow(pushes, at[0] - cos, at[1] + sin, cos, -sin);
    } else {
      let middle;
      if (letter === "d") {
        middle = [screenX(a[0]), screenY(a[1])];
        zones.moveTo(middle[0] + b * camera.scale, middle[1]);
        zones.arc(...middle, b * camera.scale, 0, 2 * Math.PI);
      } else {
        const [left, top, right, bottom] = [screenX(a[0]), screenY(b[1]), screenX(b[0]), screenY(a[1])];
        middle = [(left + right) / 2, (top + bottom) / 2];
        zones.rect(left, top, right - left, bottom - top);
      }
      const length = Math.hypot(...c);
      if (length > 0) arrow(pushes, ...middle, 30 * c[0] / length, -30 * c[1] / length);
    }
  }
  pen.lineWidth = 1;
  pen.fillStyle = pen.strokeStyle = colours.field;
  pen.globalAlpha = 0.08;
  pen.fill(zones);
  pen.globalAlpha = 0.4;
  pen.stroke(zones);
  pen.globalAlpha = 0.6;
  pen.stroke(pushes);
  pen.strokeStyle = colours.soft;
  pen.stroke(centres);
  pen.globalAlpha = bodies.length > 300 ? 0.35 : 0.6;
  pen.stroke(springs);
  pen.globalAlpha = 1;
}

// Of more ends of joints than this, the lines alone are drawn.
const JOINT_CROWD = 400;

// The joints, as `joints.rs` says: their lines, and a small diamond at each mark.
function drawJoints(frame, tick) {
  const lines = new Path2D(), marks = new Path2D();
  let count = 0;
  for (const [from, to, drawing] of run.joints) {
    if (tick < from || tick > to) continue;
    for (const [letter, ...ends] of drawing) {
      const points = ends.map(end => anchor(end, frame));
      if (points.includes(null)) continue;
      const [[x, y]] = points;
      if (letter === "s") {
        lines.moveTo(x, y);
        lines.lineTo(points[1][0], points[1][1]);
      } else {
        count++;
        marks.moveTo(x - 2.5, y);
        for (const [dx, dy] of [[0, -2.5], [2.5, 0], [0, 2.5]]) marks.lineTo(x + dx, y + dy);
        marks.closePath();
      }
    }
  }
  pen.lineWidth = 1.2;
  pen.strokeStyle = colours.ink;
  pen.globalAlpha = 0.8;
  pen.stroke(lines);
  if (count <= JOINT_CROWD) pen.stroke(marks);
  pen.globalAlpha = 1;
}

// Points of ways on a picture, at most about.
const TRAIL_POINTS = 60000;
const trailStep = Math.max(1, Math.ceil(run.frames * bodies.length / TRAIL_POINTS));

function drawTrails(frame, tick, selected) {
  const many = new Path2D(), one = new Path2D();
  for (const body of bodies) {
    if (!body.isThere(frame) || body.look(tick).kind === 2) continue;
    const path = body === selected ? one : many;
    let jump = 0;
    const go = f => {
      // A way has a gap where a call put the body elsewhere.
      const from = jump;
      while (body.jumps[jump] <= tickOf(f)) jump++;
      const isLed = f > body.first && jump === from;
      path[isLed ? "lineTo" : "moveTo"](screenX(body.near(f, X)), screenY(body.near(f, Y)));
    };
    go(body.first);
    for (let f = Math.ceil((body.first + 1) / trailStep) * trailStep; f < frame; f += trailStep) go(f);
    go(frame);
  }
  pen.strokeStyle = colours.dynamic;
  pen.lineWidth = 1.2;
  pen.lineJoin = "round";
  pen.globalAlpha = bodies.length > 300 ? 0.15 : 0.5;
  pen.stroke(many);
  pen.globalAlpha = 0.9;
  pen.stroke(one);
  pen.globalAlpha = 1;
}

// How each look is drawn: the opacity of its area, and the dashes of its outline.
const FILLS = [0.3, 0.3, 0.45, 0.08, 0.15, 0.04], DASHES = [[], [5, 3], [], [2, 3], [], [1, 4]];
// And each surface: the share of that opacity, and the dashes. A sensor has a colour of its own.
const SURFACE_FILLS = { sensor: 0.2, "one-way": 0.4, belt: 1 }, SURFACE_DASHES = { sensor: [4, 4], "one-way": [9, 3, 2, 3], belt: [2, 2] };

function drawSurfaces(paths, look) {
  for (const surface of SURFACES) {
    pen.fillStyle = pen.strokeStyle = surface === "sensor" ? colours.field : colours[LOOKS[look]];
    pen.setLineDash(SURFACE_DASHES[surface]);
    pen.globalAlpha = FILLS[look] * SURFACE_FILLS[surface];
    pen.fill(paths[surface]);
    pen.globalAlpha = 1;
    pen.stroke(paths[surface]);
  }
  pen.setLineDash([]);
  pen.strokeStyle = colours.ink;
  pen.stroke(paths.arrows);
}

// Returns how many bodies there are of each look.
function drawBodies(frame, tick) {
  const areas = LOOKS.map(() => new Path2D()), lines = LOOKS.map(() => new Path2D());
  const surfaces = LOOKS.map(() => Object.fromEntries([...SURFACES, "arrows"].map(name => [name, new Path2D()])));
  const dots = LOOKS.map(() => []), counts = LOOKS.map(() => 0);
  for (const body of bodies) {
    if (!body.isThere(frame)) continue;
    const look = body.look(tick), radius = reachOf(look);
    counts[look.index]++;
    const x = screenX(body.near(frame, X)), y = screenY(body.near(frame, Y)), margin = radius * camera.scale + 10;
    if (x < -margin || y < -margin || x > size.width + margin || y > size.height + margin) continue;
    if (radius * camera.scale >= DOT) {
      trace(run.shapes[look.shape], areas[look.index], lines[look.index], x, y, body.near(frame, ANGLE), surfaces[look.index]);
    } else if (areMany) dots[look.index].push(x, y);
    else {
      areas[look.index].moveTo(x + DOT, y);
      areas[look.index].arc(x, y, DOT, 0, 2 * Math.PI);
    }
    if (look.index === 4) {
      for (const side of [6, -6]) {
        lines[4].moveTo(x - side, y - 6);
        lines[4].lineTo(x + side, y + 6);
      }
    }
  }
  // What moves is drawn over what does not.
  for (const look of [5, 2, 3, 1, 0, 4]) {
    pen.fillStyle = pen.strokeStyle = colours[LOOKS[look]];
    pen.lineWidth = 1.4;
    pen.setLineDash(DASHES[look]);
    pen.globalAlpha = FILLS[look];
    pen.fill(areas[look]);
    pen.globalAlpha = 1;
    for (let i = 0; i < dots[look].length; i += 2) {
      pen.fillRect(dots[look][i] - DOT, dots[look][i + 1] - DOT, 2 * DOT, 2 * DOT);
    }
    pen.stroke(areas[look]);
    pen.setLineDash([]);
    pen.stroke(lines[look]);
    drawSurfaces(surfaces[look], look);
  }
  return counts;
}

// The length of an arrow, px, and the speed that it stands for: few bodies are ever faster.
const FAST = 60;
const fastSpeed = (() => {
  const speeds = sampled((body, frame) => Math.hypot(body.near(frame, VX), body.near(frame, VY))).filter(v => v > 0);
  speeds.sort((a, b) => a - b);
  return speeds[Math.floor(speeds.length * 0.95)] ?? 1;
})();

function drawArrows(frame) {
  const path = new Path2D(), each = FAST / fastSpeed;
  for (const body of bodies) {
    if (!body.isThere(frame)) continue;
    let dx = body.near(frame, VX) * each, dy = -body.near(frame, VY) * each;
    const length = Math.hypot(dx, dy);
    if (length > 180) [dx, dy] = [dx * 180 / length, dy * 180 / length];
    arrow(path, screenX(body.near(frame, X)), screenY(body.near(frame, Y)), dx, dy);
  }
  pen.strokeStyle = colours.ink;
  pen.lineWidth = 1.3;
  pen.stroke(path);
}

function drawNamed(body, frame, isSelected) {
  const look = body.look(tickOf(frame));
  const x = screenX(body.near(frame, X)), y = screenY(body.near(frame, Y));
  const radius = Math.max(reachOf(look) * camera.scale, DOT) + 5;
  pen.strokeStyle = pen.fillStyle = colours.ink;
  pen.lineWidth = isSelected ? 1.6 : 1;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.setLineDash(isSelected ? [] : [3, 3]);
  pen.stroke();
  pen.setLineDash([]);
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "left";
  const [left, top] = [x + Math.min(radius * 0.75 + 4, size.width), y - Math.min(radius * 0.75 + 4, size.height)];
  pen.lineWidth = 3;
  pen.strokeStyle = colours.paper;
  pen.strokeText(body.label, left, top);
  pen.fillText(body.label, left, top);
}

// The smallest body at a point of the canvas.
function bodyAt(x, y, frame) {
  const tick = tickOf(frame);
  let best = null, least = Infinity;
  for (const body of bodies) {
    if (!body.isThere(frame)) continue;
    const look = body.look(tick), radius = reachOf(look);
    const away = Math.hypot(screenX(body.near(frame, X)) - x, screenY(body.near(frame, Y)) - y);
    if (away > Math.max(radius * camera.scale, 8)) continue;
    if (away > 8) {
      const areas = new Path2D(), lines = new Path2D();
      const [left, top] = [screenX(body.near(frame, X)), screenY(body.near(frame, Y))];
      trace(run.shapes[look.shape], areas, lines, left, top, body.near(frame, ANGLE));
      // The pen counts in pixels of the device.
      const ratio = canvas.width / size.width;
      pen.save();
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.lineWidth = 12;
      const isHit = pen.isPointInPath(areas, x * ratio, y * ratio) || pen.isPointInStroke(lines, x * ratio, y * ratio);
      pen.restore();
      if (!isHit) continue;
    }
    const rank = radius + away / camera.scale * 1e-3;
    if (rank < least) [best, least] = [body, rank];
  }
  return best;
}
