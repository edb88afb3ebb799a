// Another recording over ours: both ways, both turtles, how far apart, where the inputs part.

import { RunAnimation } from "./animation.js";
import { key, number, t } from "./language.js";
import { svg } from "./plots.js";
import { callText } from "./words.js";

export class Comparison {
  constructor(data, animations, element) {
    this.animations = animations;
    this.others = data.other.runs.map((run) => new RunAnimation(run, data.sprite));
    this.title = data.other.title;
    this.differences = data.other.differences;
    this.tickS = data.tick_s;
    this.element = element;
    element("compared").hidden = false;
    element("show-ways").addEventListener("change", (event) => {
      element("ways").style.display = event.target.checked ? "" : "none";
    });
    element("compared-with").textContent = t("{one} — with — {other}", { one: data.title, other: this.title });
  }

  /** The first turtle of the other run; nothing where there is no such run. */
  curves(run) {
    const animation = this.others[run];
    return animation && animation.turtles[0] ? [[animation, animation.turtles[0]]] : [];
  }

  last(run) { return this.others[run] ? this.others[run].last : 0; }

  turtles(run, frame) {
    const animation = this.others[run];
    if (!animation) return [];
    const there = animation.turtlesAt(Math.min(frame, animation.last));
    return there.map((turtle) => ({ ...turtle, name: t("{name} (other)", turtle) }));
  }

  /** How far apart the two are over time, as a curve. */
  difference(run, turtle) {
    const [other] = this.curves(run);
    if (!other || !turtle) return [];
    const [animation, mine] = [this.animations[run], turtle];
    const line = [];
    for (let frame = 0; frame <= Math.min(animation.last, other[0].last); frame += 1) {
      const [a, b] = [animation.pose(mine, frame), other[0].pose(other[1], frame)];
      const apart = a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : NaN;
      line.push(Number.isFinite(apart) ? [frame, apart] : null);
    }
    return [{ words: key("apart"), unit: "m", lines: [line] }];
  }

  show(run) {
    const other = this.others[run];
    const ways = this.element("ways");
    ways.replaceChildren();
    this.element("parts").textContent = this.told(run);
    if (!other) return;
    for (const [animation, kind] of [[this.animations[run], "mine"], [other, "other"]]) {
      const turtle = animation.turtles[0];
      if (!turtle) continue;
      const d = wayOf(turtle);
      ways.prepend(svg("path", { d, class: "casing" }));  // below both lines
      ways.append(svg("path", { d, class: kind }));
    }
  }

  told(run) {
    if (!this.others[run]) return t("The other recording has no such run.");
    const found = this.differences[run];
    if (!found) return t("The same came in at every tick.");
    const words = (calls) => (calls.length ? calls.map(callText).join("; ") : t("nothing"));
    return t("The inputs differ first at {time} s, tick {tick}: here {mine}; in the other {other}.", {
      time: number(found.tick * this.tickS, 3), tick: found.tick,
      mine: words(found.mine), other: words(found.other),
    });
  }
}

function wayOf(turtle) {
  let d = "";
  for (const [first, last, row] of turtle.stretches) {
    let isOn = false;
    for (let i = row; i <= row + last - first; i += 1) {
      const [x, y] = turtle.places.subarray(3 * i, 3 * i + 2);
      if (Number.isFinite(x) && Number.isFinite(y)) d += `${isOn ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`;
      isOn = Number.isFinite(x) && Number.isFinite(y);
    }
  }
  return d;
}
