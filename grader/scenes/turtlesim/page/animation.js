// An animated run: the paint and the turtles in every frame. Frame 0 is before the first tick.
//
// grader/scenes/turtlesim/replay.py writes the data.

import { SIZE_PX, TurtleWindow } from "./window.js";

/** So many pictures of the paint are kept, so that going back is quick. */
const KEYFRAMES = 24;
/** Between two of them are at least so many runs of pixels. */
const RUNS_BETWEEN = 2000;

const buffer = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;

/** The last of [[frame, ...], ...] that is not after a frame. */
export function lastUpTo(list, frame, key = (item) => item[0]) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (key(list[middle]) <= frame) low = middle + 1; else high = middle;
  }
  return low - 1;
}

export class RunAnimation {
  constructor(data, sprite) {
    this.last = data.last;
    this.title = data.title;
    this.outcome = data.outcome;
    this.exact = data.exact;
    this.calls = data.calls;
    this.lines = data.lines;
    this.backgrounds = data.backgrounds;
    this.sprite = sprite;
    this.readPaint(data);
    this.turtles = data.turtles.map((turtle) => {
      let rows = 0;
      const stretches = turtle.stretches.map(([first, last]) => {
        const stretch = [first, last, rows];
        rows += last - first + 1;
        return stretch;
      });
      const places = new Float64Array(buffer(turtle.places));
      const poses = new Float32Array(buffer(turtle.poses));
      return { name: turtle.name, pens: turtle.pens, stretches, places, poses };
    });
  }

  readPaint({ ops, runs, colors }) {
    const numbers = new Uint16Array(buffer(runs));
    this.ops = [];
    let at = 0;
    for (let i = 0; i < ops.length; i += 3) {
      const [frame, color, count] = ops.slice(i, i + 3);
      const stroke = color < 0 ? null : [colors[color], numbers.subarray(at, at + 3 * count)];
      at += 3 * count;
      this.ops.push([frame, stroke, count]);
    }
    this.between = Math.max(RUNS_BETWEEN, numbers.length / 3 / KEYFRAMES);
  }

  /** How many strokes there are up to a frame. */
  strokes(frame) { return lastUpTo(this.ops, frame) + 1; }

  background(frame) { return this.backgrounds[Math.max(0, lastUpTo(this.backgrounds, frame))][1]; }

  /** Which row of its columns a turtle has in a frame; -1 where it is not there. */
  row(turtle, frame) {
    const stretch = turtle.stretches[lastUpTo(turtle.stretches, frame)];
    return stretch && frame <= stretch[1] ? stretch[2] + frame - stretch[0] : -1;
  }

  pose(turtle, frame) {
    const row = this.row(turtle, frame);
    return row < 0 ? null : turtle.poses.subarray(5 * row, 5 * row + 5);
  }

  /** The turtles of a frame as the window and the table take them. */
  turtlesAt(frame) {
    const there = [];
    for (const turtle of this.turtles) {
      const row = this.row(turtle, frame);
      if (row < 0) continue;
      const [x, y, heading] = turtle.places.subarray(3 * row, 3 * row + 3);
      const [, r, g, b, width, off] = turtle.pens[Math.max(0, lastUpTo(turtle.pens, frame))];
      there.push({
        name: turtle.name, sprite: this.sprite, px: [x, y], heading,
        pen: { r, g, b, width, off: Boolean(off) }, pose: [...this.pose(turtle, frame)],
      });
    }
    return there;
  }
}

/** A canvas that shows any frame of an animation. */
export class Screen {
  constructor(canvas, sprites, animation) {
    this.animation = animation;
    this.view = new TurtleWindow(canvas, sprites);
    this.done = 0;
    this.sinceKey = 0;
    this.keys = [[0, null]];  // after so many strokes: the paint
  }

  seek(frame, others = []) {
    const target = this.animation.strokes(frame);
    const [strokes, paint] = this.keys[lastUpTo(this.keys, target)];
    if (target < this.done || strokes > this.done) this.restore(strokes, paint);
    while (this.done < target) this.step();
    this.view.setBackground(this.animation.background(frame));
    this.view.turtles = [...others, ...this.animation.turtlesAt(frame)];
    this.view.show();
  }

  restore(strokes, paint) {
    if (paint) this.view.paint.set(paint); else this.view.paint.fill(0, 0, SIZE_PX * SIZE_PX);
    this.view.cover();
    this.done = strokes;
    this.sinceKey = 0;
  }

  step() {
    const [, stroke, count] = this.animation.ops[this.done];
    this.view.draw([stroke]);
    this.done += 1;
    this.sinceKey += count;
    if (this.sinceKey < this.animation.between) return;
    this.sinceKey = 0;
    if (this.done > this.keys[this.keys.length - 1][0]) {
      this.keys.push([this.done, this.view.paint.slice()]);
    }
  }
}
