// The contacts of a frame, if they were recorded: their points, normals and impulses. `contacts.rs` says how they are stored.

const hasContacts = run.contacts !== null, CONTACTS = hasContacts ? ["points", "normals", "impulses"] : [];
const isOn = id => $(id)?.checked ?? false;
if (hasContacts) $("points").checked = true;
else document.querySelectorAll(".contact").forEach(label => label.remove());

// Calls `visit` for each contact of a frame, with its normal, its points on the canvas and its impulses.
function eachContact(frame, visit) {
  const view = new DataView(bytes.buffer, run.contacts[frame], run.contacts[frame + 1] - run.contacts[frame]);
  for (let at = 0; at < view.byteLength;) {
    const number = () => view.getFloat32((at += 4) - 4, true);
    const word = view.getUint32(at, true);
    at += 4;
    const body = bodies[word >> 1], angle = number(), friction = number(), points = [];
    for (let i = 0; i <= (word & 1); i++) {
      const [dx, dy, impulse] = [number(), number(), number()];
      points.push([body.near(frame, X) + dx, body.near(frame, Y) + dy, impulse]);
    }
    visit(Math.cos(angle), Math.sin(angle), points, friction);
  }
}

// The impulse that an arrow as long as `FAST` stands for: few are ever larger.
const largeImpulse = (() => {
  const impulses = [], step = Math.max(1, Math.floor(run.frames / 40));
  for (let frame = 0; hasContacts && frame < run.frames; frame += step) {
    eachContact(frame, (nx, ny, points) => points.forEach(([, , impulse]) => impulse > 0 && impulses.push(impulse)));
  }
  impulses.sort((a, b) => a - b);
  return impulses[Math.floor(impulses.length * 0.98)] ?? 1;
})();

function drawContacts(frame, [hasPoints, hasNormals, hasImpulses]) {
  const dots = new Path2D(), normals = new Path2D(), impulses = new Path2D(), each = FAST / largeImpulse;
  // A longer arrow than three such ones is cut.
  const length = impulse => Math.sign(impulse) * Math.min(Math.abs(impulse) * each, 3 * FAST);
  eachContact(frame, (nx, ny, points, friction) => {
    for (const [wx, wy, impulse] of points) {
      const [x, y] = [screenX(wx), screenY(wy)];
      if (hasPoints) {
        dots.moveTo(x + 2.5, y);
        dots.arc(x, y, 2.5, 0, 2 * Math.PI);
      }
      if (hasNormals) {
        normals.moveTo(x, y);
        normals.lineTo(x + 12 * nx, y - 12 * ny);
      }
      if (hasImpulses) arrow(impulses, x, y, length(impulse) * nx, -length(impulse) * ny);
    }
    if (hasImpulses) {
      const [first, last] = [points[0], points[points.length - 1]];
      const [x, y] = [screenX((first[0] + last[0]) / 2), screenY((first[1] + last[1]) / 2)];
      // Along the tangent (ny, -nx).
      arrow(impulses, x, y, length(friction) * ny, length(friction) * nx);
    }
  });
  pen.lineWidth = 1.3;
  pen.strokeStyle = pen.fillStyle = colours.contact;
  pen.stroke(impulses);
  pen.fill(dots);
  pen.strokeStyle = colours.ink;
  pen.stroke(normals);
}
