// What the page says in words: where the turtles are, and what was just called.

import { SIZE_M } from "./window.js";

const MOST_CALLS = 60;
const cells = (row, texts) => row.replaceChildren(...texts.map((text) => {
  const cell = document.createElement("td");
  if (text instanceof Node) cell.append(text); else cell.textContent = text;
  return cell;
}));
const shown = (value) => (typeof value === "number" ? value.toFixed(3) : value);

/** The quadrant of a place [m], as in the course: counted from the top right, against the clock. */
export function quadrantOf(x, y) {
  if (!Number.isFinite(x) || !Number.isFinite(y)) return "none";
  const isRight = x >= SIZE_M / 2;
  if (y >= SIZE_M / 2) return isRight ? "I, top right" : "II, top left";
  return isRight ? "IV, bottom right" : "III, bottom left";
}

function penOf({ r, g, b, width, off }) {
  const part = document.createElement("span");
  const swatch = document.createElement("span");
  swatch.className = "swatch";
  swatch.style.background = `rgb(${r}, ${g}, ${b})`;
  part.append(swatch, off ? "lifted" : `${r}, ${g}, ${b}; ${width} px`);
  return part;
}

export function tellTurtles(body, turtles) {
  while (body.rows.length > turtles.length) body.deleteRow(-1);
  turtles.forEach((turtle, index) => {
    const row = body.rows[index] || body.insertRow();
    const key = JSON.stringify(turtle);
    if (row.dataset.key === key) return;
    row.dataset.key = key;
    const pose = turtle.pose || [];
    cells(row, [turtle.name, ...pose.map(shown), quadrantOf(pose[0], pose[1]), penOf(turtle.pen)]);
  });
}

const vector = (values) => values.map(shown).join(", ");
const WORDS = {
  cmd_vel: (c) => `cmd_vel of ${c.turtle}: ahead ${shown(c.linear[0])} m/s, turning ${shown(c.angular[2])} rad/s`,
  set_pen: (c) => `set_pen of ${c.turtle}: ${c.off ? "lifted" : `${c.r}, ${c.g}, ${c.b}; ${c.width} px`}`,
  teleport_absolute: (c) => `teleport_absolute of ${c.turtle}: ${vector([c.x, c.y, c.theta])}`,
  teleport_relative: (c) => `teleport_relative of ${c.turtle}: ${vector([c.linear, c.angular])}`,
  rotate_absolute: (c) => `rotate_absolute of ${c.turtle}: to ${shown(c.theta)} rad`,
  cancel: () => "rotate_absolute: cancelled",
  spawn: (c) => `spawn: ${c.name || "a turtle"} at ${vector([c.x, c.y, c.theta])}`,
  kill: (c) => `kill: ${c.name}`,
  clear: () => "clear",
  reset: () => "reset",
  param: (c) => `parameter ${c.name}: ${c.value}`,
  log: (c) => `${c.severity}: ${c.text}`,
};

/** What was called, in words. */
export function callText(call) {
  return (WORDS[call.op] || ((c) => c.op))(call);
}

/** Put the newest on top; a stream of commands of one kind keeps one line. */
export function tellCalls(list, calls, tick) {
  for (const call of calls) {
    const text = callText(call);
    const kind = JSON.stringify([call.op, call.turtle, call.linear, call.angular]);
    const newest = list.firstElementChild;
    const item = newest && call.op === "cmd_vel" && newest.dataset.kind === kind
      ? newest : list.insertBefore(document.createElement("li"), newest);
    item.dataset.kind = kind;
    item.textContent = `${((call.tick ?? tick) * 0.016).toFixed(2)} s: ${text}`;
    while (list.children.length > MOST_CALLS) list.lastElementChild.remove();
  }
}
