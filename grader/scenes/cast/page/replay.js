// Plays runs: the timeline, the cursor, and what the checks say about them.

import { Checks } from "./checks.js";
import { speak } from "./language.js";
import { Timeline } from "./timeline.js";
import { Transport } from "./transport.js";

const element = (id) => document.getElementById(id);
const data = JSON.parse(element("data").textContent);
speak(data.language, data.sentences);

let shown = 0;
const transport = new Transport(element, data.tick_s, (frame) => timeline.show(frame * data.tick_s));
const timeline = new Timeline(element, (time) => { transport.pause(); transport.go(Math.round(time / data.tick_s)); });
const checks = new Checks(element("checks"), (moment) => {
  choose(moment.run);
  transport.pause();
  transport.go(moment.tick);
  checks.mark(moment);
});
const buttons = data.runs.map((run, n) => {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = run.title;
  made.addEventListener("click", () => choose(n));
  return made;
});

function choose(n) {
  shown = n;
  const run = data.runs[n];
  buttons.forEach((button, each) => button.setAttribute("aria-pressed", String(each === n)));
  element("outcome").textContent = run.outcome;
  timeline.set(run.lanes, run.labels, run.items, run.ticks * data.tick_s);
  transport.setLast(run.ticks);
}

if (buttons.length > 1) element("runs").append(...buttons);
checks.show(data.judged);
element("judged").hidden = !data.judged.length;
choose(shown);
