// What the page says in words: where the turtles are, and what was just called.

import { language, number, t } from "./language.js";
import { SIZE_M } from "./window.js";

export const MOST_CALLS = 60;
const cells = (row, texts) => row.replaceChildren(...texts.map((text) => {
  const cell = document.createElement("td");
  if (text instanceof Node) cell.append(text); else cell.textContent = text;
  return cell;
}));
const shown = (value) => (typeof value === "number" ? number(value, 3) : value);

/** The quadrant of a place [m], as in the course: counted from the top right, against the clock. */
export function quadrantOf(x, y) {
  if (!Number.isFinite(x) || !Number.isFinite(y)) return t("none");
  const isRight = x >= SIZE_M / 2;
  if (y >= SIZE_M / 2) return isRight ? t("I, top right") : t("II, top left");
  return isRight ? t("IV, bottom right") : t("III, bottom left");
}

function penOf({ r, g, b, width, off }) {
  const part = document.createElement("span");
  const swatch = document.createElement("span");
  swatch.className = "swatch";
  swatch.style.background = `rgb(${r}, ${g}, ${b})`;
  part.append(swatch, off ? t("lifted") : t("{r}, {g}, {b}; {width} px", { r, g, b, width }));
  return part;
}

export function tellTurtles(body, turtles) {
  while (body.rows.length > turtles.length) body.deleteRow(-1);
  turtles.forEach((turtle, index) => {
    const row = body.rows[index] || body.insertRow();
    const key = `${language()} ${JSON.stringify(turtle)}`;
    if (row.dataset.key === key) return;
    row.dataset.key = key;
    const pose = turtle.pose || [];
    cells(row, [turtle.name, ...pose.map(shown), quadrantOf(pose[0], pose[1]), penOf(turtle.pen)]);
  });
}

/** A place [m, rad] as it is written. */
const place = ({ turtle, x, y, theta }) => ({ turtle, x: shown(x), y: shown(y), theta: shown(theta) });
const WORDS = {
  cmd_vel: ({ turtle, linear, angular }) => t("cmd_vel of {turtle}: ahead {speed} m/s, turning {turning} rad/s", {
    turtle, speed: shown(linear[0]), turning: shown(angular[2]),
  }),
  set_pen: ({ turtle, r, g, b, width, off }) => (
    off ? t("set_pen of {turtle}: lifted", { turtle })
      : t("set_pen of {turtle}: {r}, {g}, {b}; {width} px", { turtle, r, g, b, width })
  ),
  teleport_absolute: (call) => t("teleport_absolute of {turtle}: {x}, {y}, {theta}", place(call)),
  teleport_relative: ({ turtle, linear, angular }) => t("teleport_relative of {turtle}: {ahead}, {turn}", {
    turtle, ahead: shown(linear), turn: shown(angular),
  }),
  rotate_absolute: (call) => t("rotate_absolute of {turtle}: to {theta} rad", place(call)),
  cancel: () => t("rotate_absolute: cancelled"),
  spawn: (call) => t("spawn: {name} at {x}, {y}, {theta}", { ...place(call), name: call.name || t("a turtle") }),
  kill: ({ name }) => `kill: ${name}`,
  clear: () => "clear",
  reset: () => "reset",
  param: ({ name, value }) => t("parameter {name}: {value}", { name, value }),
  log: ({ severity, text }) => `${severity}: ${text}`,
};

/** What was called, in words. */
export function callText(call) {
  return (WORDS[call.op] || ((c) => c.op))(call);
}

/** Of a line of the list: the call, and when it was. */
const calledIn = new WeakMap();

function tellLine(item) {
  const { call, time } = calledIn.get(item);
  item.textContent = t("{time} s: {what}", { time: number(time, 2), what: callText(call) });
}

/** The lines that are there, in another language. */
export function tellCallsAgain(list) { for (const item of list.children) tellLine(item); }

/** Put the newest on top; a stream of commands of one kind keeps one line. */
export function tellCalls(list, calls, tick) {
  for (const call of calls) {
    const kind = JSON.stringify([call.op, call.turtle, call.linear, call.angular]);
    const newest = list.firstElementChild;
    const item = newest && call.op === "cmd_vel" && newest.dataset.kind === kind
      ? newest : list.insertBefore(document.createElement("li"), newest);
    item.dataset.kind = kind;
    calledIn.set(item, { call, time: (call.tick ?? tick) * 0.016 });
    tellLine(item);
    while (list.children.length > MOST_CALLS) list.lastElementChild.remove();
  }
}
