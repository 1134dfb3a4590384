// The controls.

const scrub = $("scrub");
let frame = 0;
let selected = null, hovered = null;
let isPlaying = false;
// When playing: the time of the run, and when the browser said so.
let playedTo = 0, playedAt = null;
let isDue = false;

const plural = (count, noun) => `${count} ${count === 1 ? noun : noun === "body" ? "bodies" : noun + "s"}`;

function redraw() {
  if (isDue) return;
  isDue = true;
  requestAnimationFrame(now => {
    isDue = false;
    if (isPlaying) advance(now);
    draw();
    if (isPlaying) redraw();
  });
}

function draw() {
  const tick = tickOf(frame), ratio = canvas.width / size.width;
  if ($("follow").checked && selected?.isThere(frame)) {
    isFitted = false;
    camera.x = selected.near(frame, X);
    camera.y = selected.near(frame, Y);
  }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = colours.paper;
  pen.fillRect(0, 0, size.width, size.height);
  drawGrid();
  drawFields(frame, tick);
  if ($("trails").checked) drawTrails(frame, tick, selected);
  const counts = drawBodies(frame, tick);
  drawJoints(frame, tick);
  if ($("arrows").checked) drawArrows(frame);
  if (hasContacts) drawContacts(frame, CONTACTS.map(isOn));
  if (hovered && hovered !== selected && hovered.isThere(frame)) drawNamed(hovered, frame, false);
  if (selected?.isThere(frame)) drawNamed(selected, frame, true);
  drawScales($("arrows").checked && [fastSpeed, "m/s"], isOn("impulses") && [largeImpulse, "N·s"]);
  say(tick, counts);
}

// What is said beside the picture.
function say(tick, counts) {
  $("tick").textContent = `${tick} of ${run.last}`;
  $("time").textContent = timeText(tick);
  $("hash").textContent = hashOf(frame);
  const there = counts.map((count, look) => count && `${count} ${LOOKS[look]}`).filter(text => text);
  $("counts").textContent = there.join(", ") || "none";
  $("now").textContent = `${tick} / ${run.last} · ${secondsOf(tick).toFixed(3)} s`;
  scrub.value = frame;
  scrub.style.setProperty("--done", `${lastFrame > 0 ? 100 * frame / lastFrame : 100}%`);
  scrub.setAttribute("aria-valuetext", `tick ${tick}`);
  $("home").disabled = $("back").disabled = frame === 0;
  $("end").disabled = $("forth").disabled = frame === lastFrame;
  describe(selected ?? hovered, tick);
  for (const item of $("list").children) item.firstChild.classList.toggle("later", Number(item.dataset.tick) > tick);
}

const described = {};

function describe(body, tick) {
  $("hint").hidden = body !== null;
  if (body === null) {
    $("body").replaceChildren();
    described.rows = "";
    return;
  }
  const look = body.look(tick);
  const rows = [["id", body.id], ...(body.name ? [["name", body.name]] : []), ["key", look.key]];
  if (body.isThere(frame)) {
    const value = which => body.exact(frame, which);
    const kind = LOOKS[look.kind] + (look.index > 2 ? `, ${LOOKS[look.index]}` : "");
    rows.push(["kind", kind]);
    if (look.mass !== null) rows.push(["mass", `${look.mass} kg`]);
    rows.push(["x", `${value(X)} m`], ["y", `${value(Y)} m`], ["angle", `${value(ANGLE)} rad`]);
    rows.push(["velocity x", `${value(VX)} m/s`], ["velocity y", `${value(VY)} m/s`], ["spin", `${value(SPIN)} rad/s`]);
  } else rows.push(["there", body.to > body.from ? `from tick ${body.from} to ${body.to}` : `at tick ${body.from}`]);
  // The list stays, so that a text in it can be marked and copied.
  const names = rows.map(([name]) => name).join();
  if (described.rows !== names) {
    described.rows = names;
    $("body").replaceChildren(...rows.flatMap(([name]) => {
      const dt = document.createElement("dt"), dd = document.createElement("dd");
      dt.textContent = name;
      dd.dataset.name = name;
      return [dt, dd];
    }));
  }
  rows.forEach(([, text], i) => {
    const dd = $("body").children[2 * i + 1];
    if (dd.textContent !== text) dd.textContent = text;
  });
}

function show(to) {
  frame = Math.min(lastFrame, Math.max(0, to));
  playedTo = secondsOf(tickOf(frame));
  redraw();
}

function play(on) {
  if (on && frame === lastFrame) show(0);
  isPlaying = on;
  playedTo = secondsOf(tickOf(frame));
  playedAt = null;
  $("play").classList.toggle("playing", on);
  $("play").setAttribute("aria-label", on ? "Pause" : "Play");
  redraw();
}

function advance(now) {
  // A page that was in the background does not catch up.
  const passed = playedAt === null ? 0 : Math.min((now - playedAt) / 1000, 0.25);
  playedAt = now;
  playedTo += passed * Number($("speed").value);
  while (frame < lastFrame && secondsOf(tickOf(frame + 1)) <= playedTo) frame++;
  if (frame < lastFrame) return;
  if ($("loop").checked && lastFrame > 0) {
    frame = 0;
    playedTo = secondsOf(run.start);
  } else play(false);
}

function step(by) {
  play(false);
  show(frame + by);
}

function select(body) {
  selected = body;
  $("who").value = body === null ? "" : String(body.index);
  $("follow").disabled = body === null;
  redraw();
}

// The canvas: drag, wheel, two fingers, click.

const fingers = new Map();
let dragged = 0;

function zoom(by, x, y) {
  const [wx, wy] = [worldX(x), worldY(y)];
  isFitted = false;
  camera.scale = Math.min(1e6, Math.max(1e-8, camera.scale * by));
  camera.x += wx - worldX(x);
  camera.y += wy - worldY(y);
  redraw();
}

canvas.addEventListener("pointerdown", event => {
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  if (fingers.size === 1) dragged = 0;
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", event => {
  const before = fingers.get(event.pointerId), now = [event.offsetX, event.offsetY];
  if (!before) {
    const over = bodyAt(...now, frame);
    canvas.classList.toggle("over", over !== null);
    if (over !== hovered) {
      hovered = over;
      redraw();
    }
    return;
  }
  const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
  dragged += Math.hypot(dx, dy);
  fingers.set(event.pointerId, now);
  if (dragged < 4) return;
  canvas.classList.add("dragged");
  // Who drags the picture no longer follows.
  $("follow").checked = isFitted = false;
  camera.x -= dx / camera.scale / fingers.size;
  camera.y += dy / camera.scale / fingers.size;
  const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
  if (other) {
    const apart = point => Math.max(10, Math.hypot(point[0] - other[0], point[1] - other[1]));
    zoom(apart(now) / apart(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
  }
  redraw();
});
const lift = event => {
  const wasDown = fingers.delete(event.pointerId);
  canvas.classList.remove("dragged");
  if (wasDown && fingers.size === 0 && dragged < 4 && event.type === "pointerup") {
    select(bodyAt(event.offsetX, event.offsetY, frame));
  }
};
canvas.addEventListener("pointerup", lift);
canvas.addEventListener("pointercancel", lift);
canvas.addEventListener("pointerleave", () => {
  hovered = null;
  redraw();
});
canvas.addEventListener("wheel", event => {
  event.preventDefault();
  const lines = event.deltaMode === 1 ? 30 : 1;
  zoom(Math.exp(-event.deltaY * lines / 500), event.offsetX, event.offsetY);
}, { passive: false });

// Buttons and keys.

const reset = () => {
  $("follow").checked = false;
  fit();
  redraw();
};
$("fit").addEventListener("click", reset);
$("play").addEventListener("click", () => play(!isPlaying));
$("back").addEventListener("click", () => step(-1));
$("forth").addEventListener("click", () => step(1));
$("home").addEventListener("click", () => step(-Infinity));
$("end").addEventListener("click", () => step(Infinity));
$("more").addEventListener("click", listMore);
$("kinds").addEventListener("change", filter);
$("who").addEventListener("change", () => select(bodies[$("who").value] ?? null));
for (const id of ["follow", "arrows", "trails", ...CONTACTS]) $(id).addEventListener("change", redraw);
scrub.addEventListener("input", () => {
  play(false);
  show(Number(scrub.value));
});

const KEYS = {
  " ": () => play(!isPlaying),
  ArrowLeft: event => step(event.shiftKey ? -10 : -1),
  ArrowRight: event => step(event.shiftKey ? 10 : 1),
  Home: () => step(-Infinity),
  End: () => step(Infinity),
  f: reset,
  v: () => $("arrows").click(),
  t: () => $("trails").click(),
  c: () => $("follow").click(),
  k: () => $("points")?.click(),
  n: () => $("normals")?.click(),
  i: () => $("impulses")?.click(),
  "+": () => zoom(1.25, size.width / 2, size.height / 2),
  "-": () => zoom(0.8, size.width / 2, size.height / 2),
  Escape: () => select(null),
};
document.addEventListener("keydown", event => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  // A control that has the keyboard keeps the keys that it knows.
  const control = event.target.closest("button, select, summary, input:not([type=range])");
  const isItsOwn = control && (event.key === " " || control.matches("select"));
  const act = KEYS[event.key];
  if (!act || isItsOwn) return;
  event.preventDefault();
  act(event);
});

// The start.

function option(value, text) {
  const option = document.createElement("option");
  option.value = value;
  option.textContent = text;
  return option;
}

function legend() {
  const used = new Set(bodies.flatMap(body => body.looks.map(([tick]) => body.look(tick).index)));
  const swatch = look => {
    const cross = look === 4 ? '<path d="M4 4l6 6M10 4l-6 6"/>' : "";
    const colour = `var(--${LOOKS[look]})`, dash = DASHES[look].join(" ");
    return `<svg viewBox="0 0 14 14" fill="${colour}" stroke="${colour}" stroke-width="1.5" fill-opacity="${FILLS[look]}"><circle cx="7" cy="7" r="5.5" stroke-dasharray="${dash}"/>${cross}</svg>`;
  };
  LOOKS.forEach((name, look) => {
    if (!used.has(look)) return;
    const item = document.createElement("li");
    item.innerHTML = swatch(look);
    item.append(name);
    $("legend").append(item);
  });
  const surfaces = new Set(run.shapes.flat().map(([letter]) => letter));
  for (const surface of SURFACES.filter(surface => surfaces.has(surface))) {
    const colour = surface === "sensor" ? "var(--field)" : "var(--ink)", dash = SURFACE_DASHES[surface].join(" ");
    const item = document.createElement("li");
    item.innerHTML = `<svg viewBox="0 0 14 14" fill="none" stroke="${colour}" stroke-width="1.5" stroke-dasharray="${dash}"><path d="M1 2h12v10H1z"/></svg>`;
    item.append(surface);
    $("legend").append(item);
  }
  $("legend").hidden = used.size === 0;
}

function resize() {
  size = { width: canvas.clientWidth || 1, height: canvas.clientHeight || 1 };
  canvas.width = Math.round(size.width * devicePixelRatio);
  canvas.height = Math.round(size.height * devicePixelRatio);
  if (isFitted) fit();
  drawMarks();
  draw();
}

function start() {
  const { num, den } = clock[0], changes = clock.length > 1 ? " at first" : "";
  const ticks = plural(run.last - run.start, "tick");
  $("facts").textContent = `${plural(bodies.length, "body")}, ${ticks} of ${num}/${den} s${changes}, ${run.integrator} · ${run.made}`;
  $("thinned").textContent = run.thinned ?? "";
  $("thinned").hidden = run.thinned === null;
  scrub.max = lastFrame;
  $("list").style.setProperty("--digits", String(run.last).length);
  $("trails").checked = run.trails && bodies.length <= 200;
  $("who").append(option("", "none selected"), ...bodies.map(body => option(body.index, body.label)));
  const kinds = Object.keys(WORDS).filter(what => events.some(event => event.what === what));
  const count = what => events.filter(event => event.what === what).length;
  $("kinds").append(option("", plural(events.length, "event")), ...kinds.map(what => option(what, `${WORDS[what]}: ${count(what)}`)));
  $("events").hidden = events.length === 0;
  readColours();
  legend();
  filter();
  select(null);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    drawMarks();
    redraw();
  });
  const linked = () => {
    const tick = /^#tick=(\d+)$/.exec(location.hash);
    if (tick) show(frameBefore(Number(tick[1])));
  };
  addEventListener("hashchange", linked);
  linked();
  new ResizeObserver(resize).observe(canvas);
}

start();
