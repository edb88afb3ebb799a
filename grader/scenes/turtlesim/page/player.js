// The page that plays runs: which run is shown, and all parts of the page at the cursor.

import { Calls } from "./calls.js";
import { Checks } from "./checks.js";
import { Comparison } from "./comparison.js";
import { RunAnimation, Screen } from "./animation.js";
import { speak, t } from "./language.js";
import { Marks } from "./marks.js";
import { Plots } from "./plots.js";
import { Ring } from "./ring.js";
import { Transport } from "./transport.js";
import { tellTurtles } from "./words.js";

const BESIDE = -1;
const element = (id) => document.getElementById(id);

const data = JSON.parse(element("data").textContent);
speak(data.language, data.sentences);
const animations = data.runs.map((run) => new RunAnimation(run, data.sprite));
const screens = new Map();
const small = [];
const marks = new Marks(element("marks"));
const ring = new Ring(element("ring"));
const checks = new Checks(element("checks"), (moment) => visit(moment));
const calls = new Calls(element("calls"), data.tick_s, (frame) => jump(frame));
const plots = new Plots(element("plots"), data.tick_s, (frame) => jump(frame));
const transport = new Transport(element, data.tick_s, (frame) => showSoon(frame));
const comparison = data.other ? new Comparison(data, animations, element) : null;
let shown = 0;
let moment = null;
let isDue = false;

function jump(frame) {
  transport.pause();
  transport.go(frame);
}

/** Draw once for each picture of the screen, however fast the cursor is. */
function showSoon() {
  if (isDue) return;
  isDue = true;
  requestAnimationFrame(() => {
    isDue = false;
    show(transport.frame);
  });
}

function show(frame) {
  if (moment && (moment.run !== shown || moment.tick !== frame)) leaveMoment();
  if (shown === BESIDE) {
    for (const screen of small) screen.seek(Math.min(frame, screen.animation.last));
  } else {
    const animation = animations[shown];
    const others = comparison ? comparison.turtles(shown, frame) : [];
    screens.get(shown).seek(Math.min(frame, animation.last), others);
    const turtles = animation.turtlesAt(Math.min(frame, animation.last));
    marks.show([...turtles, ...others]);
    ring.show(moment);
    tellTurtles(element("turtles"), [...turtles, ...others]);
    calls.seek(frame);
    plots.seek(frame);
  }
  document.documentElement.dataset.frame = frame;
  document.documentElement.dataset.run = shown;
}

function leaveMoment() {
  moment = null;
  checks.mark(null);
}

function visit(next) {
  if (shown !== next.run) choose(next.run);
  moment = next;
  checks.mark(next);
  jump(next.tick);
  showSoon();
  element("window").scrollIntoView({ block: "nearest" });
}

/** Show a run, or all of them side by side. */
function choose(run) {
  shown = run;
  for (const button of element("runs").querySelectorAll("button")) {
    button.setAttribute("aria-pressed", String(Number(button.dataset.run) === run));
  }
  const isBeside = run === BESIDE;
  element("one").hidden = isBeside;
  element("beside").hidden = !isBeside;
  for (const id of ["right", "at-cursor"]) element(id).hidden = isBeside;
  element("main").classList.toggle("beside", isBeside);
  if (isBeside) showBeside(); else showOne(run);
}

function showOne(run) {
  const animation = animations[run];
  if (!screens.has(run)) {
    screens.set(run, new Screen(document.createElement("canvas"), data.sprites, animation));
  }
  const canvas = screens.get(run).view.context.canvas;
  canvas.id = "canvas";
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", t("The window in this moment of {run}; the table below says where each turtle is.", { run: animation.title }));
  element("place").replaceChildren(canvas);
  element("outcome").textContent = t("{what}: {value}.", { what: animation.title, value: animation.outcome });
  element("inexact").hidden = animation.exact;
  calls.show(animation);
  const turtle = animation.turtles[0];
  const curves = turtle ? [[animation, turtle]] : [];
  if (comparison) {
    comparison.show(run);
    plots.show([...curves, ...comparison.curves(run)], comparison.difference(run, turtle));
  } else {
    plots.show(curves);
  }
  transport.setLast(Math.max(animation.last, comparison ? comparison.last(run) : 0));
}

function showBeside() {
  if (!small.length) {
    for (const animation of animations) {
      const figure = document.createElement("figure");
      const caption = document.createElement("figcaption");
      const canvas = document.createElement("canvas");
      caption.textContent = t("{what}: {value}", { what: animation.title, value: animation.outcome });
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", t("The window of {run}", { run: animation.title }));
      figure.append(canvas, caption);
      element("beside").append(figure);
      small.push(new Screen(canvas, data.sprites, animation));
    }
  }
  transport.setLast(Math.max(...animations.map((animation) => animation.last)));
}

function offer() {
  const titles = animations.map((animation, run) => [run, animation.title]);
  if (animations.length > 1) titles.push([BESIDE, t("Side by side")]);
  element("runs").hidden = titles.length < 2;
  for (const [run, title] of titles) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.run = run;
    button.textContent = title;
    button.addEventListener("click", () => choose(run));
    element("runs").append(button);
  }
}

/** What the address asks for: #run=1&tick=200. */
function fromAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const run = Number(asked.get("run") || 0);
  choose(animations[run] ? run : 0);
  transport.go(asked.has("tick") ? Number(asked.get("tick")) || 0 : transport.last);
}

marks.obey(element, showSoon);
for (const [id, step] of [["call-before", -1], ["call-after", 1]]) {
  element(id).addEventListener("click", () => {
    const tick = calls.beside(step, transport.frame);
    if (tick !== null) jump(tick);
  });
}
element("judged").hidden = !data.judged.length;
checks.show(data.judged);
offer();
fromAddress();
window.addEventListener("hashchange", fromAddress);
