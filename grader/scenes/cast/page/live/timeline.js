// Lanes of nodes over time, and a list of what went from one to another.

import { number, t } from "./language.js";

const LANE_PX = 44;
/** The heading of the list stays on top of its rows. */
const HEAD_PX = 32;
const TOP_PX = 22;
/** So many rows of the list are there at once, and so many of them before the cursor. */
const ROWS = 60;
const BEFORE = 20;
/** So many names can be chosen; a program can make any number. */
const CHOICES = 200;
const KINDS = { message: "--strong", log: "--log", call: "--call", goal: "--goal", parameter: "--call" };

export class Timeline {
  /** @param {function(string): HTMLElement} element by its id; @param {function(number)} onTime */
  constructor(element, onTime) {
    this.element = element;
    this.canvas = element("lanes");
    [this.lanes, this.labels] = [[], {}];
    this.items = [];
    this.end = 1;
    this.now = 0;
    this.canvas.addEventListener("pointerdown", (event) => onTime(this.timeAt(event)));
    this.canvas.addEventListener("pointermove", (event) => { if (event.buttons) onTime(this.timeAt(event)); });
    element("about").addEventListener("change", () => this.show(this.now));
    new ResizeObserver(() => this.draw()).observe(this.canvas.parentElement);
  }

  /** Another run, or more of one. */
  set(lanes, labels, items, end) {
    [this.lanes, this.labels] = [lanes, labels];
    this.items = items;
    this.end = Math.max(end, 0.1);
    const names = [...new Set(items.map((item) => item.what))].sort().slice(0, CHOICES);
    const select = this.element("about");
    const texts = [t("everything"), ...names];
    if (JSON.stringify(texts) === JSON.stringify([...select.options].map((each) => each.text))) return;
    const chosen = select.value;
    select.replaceChildren(...texts.map((text, n) => new Option(text, n ? text : "")));
    select.value = names.includes(chosen) ? chosen : "";
  }

  get shown() {
    const about = this.element("about").value;
    return about ? this.items.filter((item) => item.what === about) : this.items;
  }

  show(now) {
    this.now = now;
    this.draw();
    const items = this.shown;
    let next = items.findIndex((item) => item.t > now + 1e-6);
    if (next < 0) next = items.length;
    const first = Math.max(0, Math.min(next - BEFORE, items.length - ROWS));
    const rows = items.slice(first, first + ROWS).map((item, n) => this.row(item, first + n === next - 1));
    this.element("hops").replaceChildren(...rows);
    this.scrollTo(this.element("hops").querySelector("[aria-current]"));
    const said = { n: next, all: items.length };
    this.element("counted").textContent = t("{n} of {all} up to here", said);
  }

  /** Bring a row into view in the list alone: the page stays where it is. */
  scrollTo(row) {
    const list = this.element("hops").closest(".list");
    if (!row) { list.scrollTop = 0; return; }
    const [box, at] = [list.getBoundingClientRect(), row.getBoundingClientRect()];
    if (at.bottom > box.bottom) list.scrollTop += at.bottom - box.bottom;
    else if (at.top < box.top + HEAD_PX) list.scrollTop += at.top - box.top - HEAD_PX;
  }

  row(item, isCurrent) {
    const row = document.createElement("tr");
    if (isCurrent) row.setAttribute("aria-current", "true");
    row.className = item.kind;
    const ended = item.end === undefined ? "" : `–${number(item.end, 2)}`;
    const to = item.to.length ? `→ ${item.to.join(", ")}` : "";
    for (const text of [`${number(item.t, 2)}${ended}`, item.from, to, item.what, item.text]) {
      const cell = document.createElement("td");
      cell.textContent = text;
      row.append(cell);
    }
    return row;
  }

  timeAt(event) {
    const box = this.canvas.getBoundingClientRect();
    return Math.max(0, Math.min(this.end, ((event.clientX - box.left) / box.width) * this.end));
  }

  draw() {
    const width = this.canvas.parentElement.clientWidth;
    const height = TOP_PX + LANE_PX * this.lanes.length;
    const scale = window.devicePixelRatio || 1;
    Object.assign(this.canvas, { width: width * scale, height: height * scale });
    this.canvas.style.height = `${height}px`;
    const pen = this.canvas.getContext("2d");
    pen.scale(scale, scale);
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const x = (time) => (time / this.end) * width;
    const places = new Map(this.lanes.map((lane, n) => [lane, TOP_PX + LANE_PX * (n + 0.65)]));
    const y = (lane) => places.get(lane) ?? places.get("…") ?? TOP_PX + LANE_PX * 0.65;
    pen.font = "12px system-ui, sans-serif";
    this.drawGrid(pen, width, height, x, color);
    for (const lane of this.lanes) {
      pen.strokeStyle = color("--line");
      line(pen, 0, y(lane), width, y(lane));
    }
    for (const item of this.shown) {
      pen.globalAlpha = item.t <= this.now + 1e-6 ? 1 : 0.25;
      pen.fillStyle = pen.strokeStyle = color(KINDS[item.kind]);
      drawItem(pen, item, x, y);
    }
    pen.globalAlpha = 1;
    pen.strokeStyle = color("--cursor");
    line(pen, x(this.now), 0, x(this.now), height);
    for (const lane of this.lanes) {  // over all that is drawn, with a rim
      Object.assign(pen, { strokeStyle: color("--paper"), fillStyle: color("--ink"), lineWidth: 4, lineJoin: "round" });
      const label = this.labels[lane] ?? lane;
      pen.strokeText(label, 4, y(lane) - 14);
      pen.fillText(label, 4, y(lane) - 14);
    }
  }

  drawGrid(pen, width, height, x, color) {
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60].find((each) => x(each) > 50) || 120;
    for (let time = 0; time <= this.end; time += step) {
      pen.strokeStyle = color("--tint");
      line(pen, x(time), TOP_PX - 6, x(time), height);
      pen.fillStyle = color("--soft");
      if (x(time) + 36 < width) pen.fillText(`${number(time, step < 1 ? 1 : 0)} s`, x(time) + 2, 12);
    }
  }
}

function line(pen, ...ends) {
  pen.beginPath();
  pen.moveTo(ends[0], ends[1]);
  pen.lineTo(ends[2], ends[3]);
  pen.stroke();
}

/** Messages are dots with arrows, log lines squares, calls and goals bars from question to answer. */
function drawItem(pen, item, x, y) {
  const [begin, from] = [x(item.t), y(item.from)];
  for (const lane of item.to) {
    line(pen, begin, from, begin, y(lane));
    const down = Math.sign(y(lane) - from);
    pen.beginPath();
    pen.moveTo(begin, y(lane));
    pen.lineTo(begin - 3, y(lane) - 6 * down);
    pen.lineTo(begin + 3, y(lane) - 6 * down);
    pen.fill();
  }
  if (item.kind === "log") pen.fillRect(begin - 2.5, from - 2.5, 5, 5);
  else if (item.kind === "message") {
    pen.beginPath();
    pen.arc(begin, from, 3, 0, 2 * Math.PI);
    pen.fill();
  }
  if (item.end === undefined && item.kind !== "call" && item.kind !== "goal") return;
  for (const lane of item.to) {
    pen.fillRect(begin, y(lane) - 3, Math.max(2, x(item.end ?? item.t) - begin), 6);
    for (const mark of item.marks || []) line(pen, x(mark), y(lane), x(mark), from);
  }
}
