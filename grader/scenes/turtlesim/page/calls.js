// The calls of a run: those round the cursor, with the one at the cursor marked.

import { number, t } from "./language.js";
import { callText } from "./words.js";
import { lastUpTo } from "./animation.js";

/** So many are shown before the cursor, and as many after it. */
const AROUND = 40;

/** Equal commands that follow each other are one entry. */
export function folded(calls) {
  const entries = [];
  let kind = "";
  for (const call of calls) {
    const { tick, ...rest } = call;
    const now = call.op === "cmd_vel" ? JSON.stringify(rest) : "";
    if (now && now === kind) {
      const entry = entries[entries.length - 1];
      entry.times += 1;
      entry.until = tick;
    } else {
      entries.push({ tick, until: tick, call, times: 1 });
    }
    kind = now;
  }
  return entries;
}

export class Calls {
  constructor(list, tickS, onFrame) {
    this.list = list;
    this.tickS = tickS;
    this.onFrame = onFrame;
    this.current = -2;
  }

  show(animation) {
    this.entries = folded(animation.calls);
    this.lines = animation.lines;
    this.current = -2;
  }

  seek(frame) {
    const current = lastUpTo(this.entries, frame, (entry) => entry.tick);
    if (current === this.current) return;
    this.current = current;
    const from = Math.max(0, current - AROUND);
    const shown = this.entries.slice(from, current + AROUND + 1);
    const keepsFocus = this.list.contains(document.activeElement);
    const items = shown.map((entry, index) => this.item(entry, from + index === current));
    if (from > 0) items.unshift(note(t("{n} earlier", { n: from })));
    const later = this.entries.length - from - shown.length;
    if (later > 0) items.push(note(t("{n} later", { n: later })));
    if (!this.entries.length) items.push(note(t("Nothing was called.")));
    this.list.replaceChildren(...items);
    const marked = this.list.querySelector("[aria-current]");
    if (!marked) return;
    this.list.scrollTop = marked.offsetTop - this.list.clientHeight / 2;
    if (keepsFocus) marked.focus({ preventScroll: true });
  }

  /** The tick of the last entry before a frame (-1), or of the first after it (1); null for none. */
  beside(step, frame) {
    const key = (entry) => entry.tick;
    const index = step < 0
      ? lastUpTo(this.entries, frame - 1, key) : lastUpTo(this.entries, frame, key) + 1;
    return this.entries[index] ? this.entries[index].tick : null;
  }

  item({ tick, until, call, times }, isCurrent) {
    const item = document.createElement("li");
    const button = document.createElement("button");
    button.type = "button";
    if (isCurrent) button.setAttribute("aria-current", "true");
    const time = document.createElement("span");
    time.className = "time";
    const seconds = (frame) => number(frame * this.tickS, 2);
    time.textContent = `${seconds(tick)} s`;
    const what = callText(call);
    const said = times > 1
      ? t("{what} ({n} times, until {time} s)", { what, n: times, time: seconds(until) }) : what;
    button.append(time, `${isCurrent ? "▶ " : ""}${said}`);
    const line = this.lines[call.line];
    if (line) button.append(place(line));
    button.addEventListener("click", () => this.onFrame(tick));
    item.append(button);
    return item;
  }
}

function place({ file, line, text }) {
  const made = document.createElement("span");
  made.className = "place";
  const code = document.createElement("code");
  code.textContent = text;
  made.append(t("from {file}, line {line}:", { file, line }), " ", code);
  return made;
}

function note(words) {
  const made = document.createElement("li");
  made.className = "small";
  made.textContent = words;
  return made;
}
