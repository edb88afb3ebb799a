// What can be shown over the window: metres, quadrants, names of turtles.

import { METRE_PX, SIZE_M, SIZE_PX } from "./window.js";

const SVG = "http://www.w3.org/2000/svg";
const QUADRANTS = [["I", 0.75, 0.25], ["II", 0.25, 0.25], ["III", 0.25, 0.75], ["IV", 0.75, 0.75]];

export class Marks {
  constructor(svg) {
    this.svg = svg;
    this.chosen = { grid: false, quadrants: false, names: false };
  }

  /** Let the boxes choose what is shown; `showAgain` is called after each choice. */
  obey(element, showAgain) {
    for (const each of Object.keys(this.chosen)) {
      element(`show-${each}`).addEventListener("change", (event) => {
        this.chosen[each] = event.target.checked;
        showAgain();
      });
    }
  }

  show(turtles) {
    const parts = [];
    if (this.chosen.grid) parts.push(...grid());
    if (this.chosen.quadrants) parts.push(...quadrants());
    if (this.chosen.names) parts.push(...turtles.map(name));
    this.svg.replaceChildren(...parts);
  }
}

function line(x1, y1, x2, y2, kind = "") {
  const made = document.createElementNS(SVG, "line");
  for (const [key, value] of Object.entries({ x1, y1, x2, y2, class: kind })) {
    made.setAttribute(key, value);
  }
  return made;
}

function text(x, y, words, kind = "") {
  const made = document.createElementNS(SVG, "text");
  made.setAttribute("x", x);
  made.setAttribute("y", y);
  made.setAttribute("class", kind);
  made.textContent = words;
  return made;
}

function grid() {
  const parts = [];
  for (let metre = 1; metre <= 11; metre += 1) {
    const x = metre * METRE_PX;
    const y = (SIZE_M - metre) * METRE_PX;
    parts.push(line(x, 0, x, SIZE_PX), line(0, y, SIZE_PX, y));
    if (metre % 2 && metre < SIZE_M - 1) parts.push(text(x - 4, SIZE_PX - 4, metre), text(3, y + 5, metre));
  }
  return [...parts, text(SIZE_PX - 4, SIZE_PX - 24, "x [m]", "end"), text(24, 18, "y [m]")];
}

function quadrants() {
  const middle = SIZE_PX / 2;
  return [
    line(middle, 0, middle, SIZE_PX, "axis"), line(0, middle, SIZE_PX, middle, "axis"),
    ...QUADRANTS.map(([words, x, y]) => text(x * SIZE_PX - 6, y * SIZE_PX, words)),
  ];
}

function name(turtle) {
  const [x, y] = turtle.px.map((value) => (typeof value === "number" ? value : 0));
  return text(x + 16, y - 16, turtle.name);
}
