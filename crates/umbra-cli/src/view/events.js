// Events: the list, and the marks over the bar.

const marks = $("marks"), tip = $("tip");

const WORDS = {
  added: "added", removed: "removed", slept: "fell asleep", woke: "woke", quarantined: "quarantined", released: "released",
  disabled: "disabled", enabled: "enabled", broke: "broke", touched: "touch", parted: "part", hit: "hit", entered: "entered a sensor",
  left: "left a sensor", input: "input", diverged: "not as recorded",
};
const events = run.events.map(([tick, until, what, text, list, count, times]) => ({ tick, until, what, text, list, count, times }));
let filtered = events, listed = 0;

function eventText({ until, tick, text, list, count, times }) {
  const parts = list.map(index => bodies[index].label);
  if (count > list.length) parts.push(`${count - list.length} more`);
  const who = parts.join(", ");
  const often = times > 1 && times !== until - tick + 1 ? `, ${times} times` : "";
  const span = until > tick ? ` (to tick ${until})` : "";
  return (who && text ? `${who}: ${text}` : who || text) + often + span;
}

function goTo(event) {
  play(false);
  if (event.list.length > 0) select(bodies[event.list[0]]);
  show(frameFrom(event.tick));
}

const PAGE = 300;

function listMore() {
  for (const event of filtered.slice(listed, listed + PAGE)) {
    const item = document.createElement("li"), button = document.createElement("button");
    item.dataset.tick = event.tick;
    const [mark, tick, text, what] = ["i", "span", "span", "b"].map(name => document.createElement(name));
    mark.style.setProperty("--mark", `var(--${event.what})`);
    tick.className = "number";
    tick.textContent = event.tick;
    what.textContent = WORDS[event.what];
    text.append(what, ` ${eventText(event)}`);
    button.append(mark, tick, text);
    button.addEventListener("click", () => goTo(event));
    item.append(button);
    $("list").append(item);
  }
  listed = Math.min(filtered.length, listed + PAGE);
  $("more").hidden = listed === filtered.length;
  $("more").textContent = `${filtered.length - listed} more`;
}

function filter() {
  const kind = $("kinds").value;
  filtered = kind ? events.filter(event => event.what === kind) : events;
  listed = 0;
  $("list").replaceChildren();
  listMore();
  drawMarks();
  redraw();
}

// The thumb of the range is 14 px wide, and its middle is what points.
const THUMB = 14;

function markX(tick) {
  const width = marks.clientWidth - THUMB, ticks = run.last - run.start;
  return THUMB / 2 + (ticks > 0 ? width * (tick - run.start) / ticks : 0);
}

function drawMarks() {
  const ratio = devicePixelRatio, brush = marks.getContext("2d"), style = getComputedStyle(document.documentElement);
  marks.width = Math.round(marks.clientWidth * ratio);
  marks.height = Math.round(marks.clientHeight * ratio);
  brush.scale(ratio, ratio);
  for (const event of filtered) {
    brush.fillStyle = style.getPropertyValue(`--${event.what}`);
    const left = markX(event.tick), right = markX(event.until);
    if (right > left + 2) {
      brush.globalAlpha = 0.35;
      brush.fillRect(left, 5, right - left, 5);
      brush.globalAlpha = 1;
    }
    brush.fillRect(left - 1, 1, 2, 10);
  }
}

function eventAt(x) {
  let best = null, least = 6;
  for (const event of filtered) {
    const away = Math.abs(markX(event.tick) - x);
    if (away < least) [best, least] = [event, away];
  }
  return best;
}

function showTip(text, event) {
  tip.hidden = text === "";
  tip.textContent = text;
  const box = tip.getBoundingClientRect();
  tip.style.left = `${Math.max(4, Math.min(event.clientX + 12, innerWidth - box.width - 4))}px`;
  tip.style.top = `${Math.max(4, event.clientY - box.height - 12)}px`;
}

$("line").addEventListener("pointermove", pointer => {
  const x = pointer.clientX - marks.getBoundingClientRect().left, event = eventAt(x);
  const tick = event && `tick ${event.tick}: ${WORDS[event.what]}\n${eventText(event)}`;
  showTip(pointer.buttons ? "" : tick ?? "", pointer);
});
$("line").addEventListener("pointerleave", () => tip.hidden = true);
marks.addEventListener("click", pointer => {
  const event = eventAt(pointer.clientX - marks.getBoundingClientRect().left);
  if (event) goTo(event);
});
