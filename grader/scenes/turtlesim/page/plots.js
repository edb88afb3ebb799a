// Curves of one turtle over time, with a cursor that can be dragged.

import { key, number, t } from "./language.js";

const SVG = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT] = [600, 90];
/** Column of the pose, words, unit. */
const CURVES = [
  [0, "x", "m"], [1, "y", "m"], [2, key("heading"), "rad"], [3, key("speed"), "m/s"], [4, key("turning"), "rad/s"],
];
const HEADING = 2;

export function svg(name, attributes = {}) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** [[frame, value], ...] of a column, gaps as null. */
function points(animation, turtle, column) {
  const found = [];
  for (const [first, last, row] of turtle.stretches) {
    for (let frame = first; frame <= last; frame += 1) {
      const value = turtle.poses[5 * (row + frame - first) + column];
      const before = found[found.length - 1];
      if (column === HEADING && before && Math.abs(value - before[1]) > Math.PI) found.push(null);
      found.push(Number.isFinite(value) ? [frame, value] : null);
    }
    found.push(null);
  }
  return found;
}

export class Plots {
  /**
   * @param {HTMLElement} place where they go.
   * @param {number} tickS length of a tick [s].
   * @param {function(number)} onFrame called when the cursor is dragged to a frame.
   */
  constructor(place, tickS, onFrame) {
    this.place = place;
    this.tickS = tickS;
    this.onFrame = onFrame;
    this.plots = [];
  }

  /** Films with the turtle of each, the first of them ours, and curves that are ready made. */
  show(shown, more = []) {
    this.last = Math.max(1, ...shown.map(([animation]) => animation.last));
    const made = CURVES.map(([column, words, unit]) => ({
      words, unit, lines: shown.map(([animation, turtle]) => points(animation, turtle, column)),
    }));
    this.plots = [...more, ...made].map((curve) => this.plot(curve));
    this.place.replaceChildren(...this.plots.map((plot) => plot.figure));
  }

  plot({ words, unit, lines }) {
    let [low, high] = [Infinity, -Infinity];
    for (const point of lines.flat()) {
      if (!point) continue;
      low = Math.min(low, point[1]);
      high = Math.max(high, point[1]);
    }
    if (low > high) [low, high] = [0, 0];
    const [bottom, top] = high - low < 1e-9 ? [low - 1, high + 1] : [low, high];
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    const drawn = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img" });
    const ends = { low: number(low, 2), high: number(high, 2), unit };
    drawn.setAttribute("aria-label", t("{what} from {low} to {high} {unit}", { what: t(words), ...ends }));
    const x = (frame) => (frame / this.last) * WIDTH;
    const y = (value) => HEIGHT - 4 - ((value - bottom) / (top - bottom)) * (HEIGHT - 8);
    lines.forEach((line, index) => {
      // a value that jumps to and fro would fill its plot: what it jumps over is drawn faintly
      const drawnAs = index ? "curve other" : "curve";
      let [d, jumps, before] = ["", "", null];
      for (const point of line) {
        const at = point && [x(point[0]).toFixed(1), y(point[1]).toFixed(1)];
        const isJump = at && before && Math.abs(at[1] - before[1]) > HEIGHT / 30;
        if (isJump) jumps += `M${before.join(" ")}L${at.join(" ")}`;
        if (at) d += before && !isJump ? `L${at.join(" ")}` : `M${at.join(" ")}h.6`;
        before = at;
      }
      drawn.append(svg("path", { d: jumps, class: `${drawnAs} jumps` }), svg("path", { d, class: drawnAs }));
    });
    const cursor = svg("line", { y1: 0, y2: HEIGHT, class: "cursor" });
    drawn.append(cursor);
    const range = document.createElement("span");
    range.className = "range";
    range.textContent = `${ends.low} … ${ends.high} ${unit}`;
    const now = document.createElement("span");
    caption.append(now, range);
    figure.append(caption, drawn);
    this.drag(drawn);
    const values = lines.map((line) => new Map(line.filter(Boolean)));
    return { figure, now, cursor, values, words, unit };
  }

  drag(drawn) {
    const go = (event) => {
      const box = drawn.getBoundingClientRect();
      const share = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      this.onFrame(Math.round(share * this.last));
    };
    drawn.addEventListener("pointerdown", (event) => {
      drawn.setPointerCapture(event.pointerId);
      go(event);
    });
    drawn.addEventListener("pointermove", (event) => { if (event.buttons) go(event); });
  }

  seek(frame) {
    const x = (frame / this.last) * WIDTH;
    for (const { cursor, now, values, words, unit } of this.plots) {
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
      const texts = values.map((line) => (line.has(frame) ? number(line.get(frame), 3) : "–"));
      now.textContent = t("{what}: {value}", { what: t(words), value: `${texts.join(" | ")} ${unit}` });
    }
  }
}
