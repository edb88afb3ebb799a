// The page: what the simulator tells is drawn and read out; the parts beside it drive and explore.

import { Controls } from "./controls.js";
import { Explorer } from "./explorer.js";
import { headingOf, tellGrading } from "./grading.js";
import { Marks } from "./marks.js";
import { LIVE, Rosbridge } from "./rosbridge.js";
import { TurtleWindow } from "./window.js";
import { tellCalls, tellTurtles } from "./words.js";

const element = (id) => document.getElementById(id);

const sprites = await (await fetch("sprites.json")).json();
const view = new TurtleWindow(element("canvas"), sprites);
const marks = new Marks(element("marks"));
let about = null;
let grading = null;
let isDue = false;
let calls = [];
let told = Promise.resolve();

/** Draw once for each picture of the screen, however much has come. */
function showSoon() {
  if (isDue) return;
  isDue = true;
  requestAnimationFrame(() => {
    isDue = false;
    view.show();
    marks.show(view.turtles);
    tellTurtles(element("turtles"), view.turtles);
    tellCalls(element("calls"), calls, view.tick);
    calls = [];
    document.documentElement.dataset.tick = view.tick;
  });
}

/** One change after another: all of the picture takes a moment to unpack. */
async function take(news) {
  if (news.whole !== undefined) {
    about = news.about;
    await view.setPaint(news.whole);
    controls.know(about);
    element("graph").hidden = !about.has_graph;
    state();
  }
  if (news.grading) {
    grading = news.grading;
    tellGrading(element, grading);
    state();
  }
  if (news.begins) {
    calls = [];
    element("calls").replaceChildren();
  }
  view.tick = news.tick;
  if (news.drawn) view.draw(news.drawn);
  if (news.background) view.setBackground(news.background);
  if (news.turtles) {
    view.turtles = news.turtles;
    controls.meet(news.turtles.map((turtle) => turtle.name));
  }
  calls.push(...(news.calls || []));
  showSoon();
}

const who = () => (grading ? "the grader" : "the simulator");
const seen = () => (
  grading ? headingOf(grading) : `${about.node}${about.read_only ? ", for looking only" : ""}`
);
const missed = () => (
  grading?.is_over
    ? `${seen()}. The grading is over; what is here stays.`
    : `No connection: ${who()} has ended, or cannot be reached. Trying again …`
);

function state(lost = false) {
  const text = lost ? missed() : seen();
  if (element("state").textContent !== text) element("state").textContent = text;
  document.documentElement.dataset.state = lost ? "lost" : "live";
}

const bridge = new Rosbridge({
  closed: () => { state(true); controls.rest(); },
  status: (text) => controls.answer(text, true),
});
const controls = new Controls(bridge, element);
const explorer = new Explorer(bridge, element);
bridge.subscribe(LIVE, undefined, (news) => { told = told.then(() => take(news)); });
for (const id of ["show-grid", "show-quadrants", "show-names"]) {
  element(id).addEventListener("change", () => {
    marks.choose({
      grid: element("show-grid").checked,
      quadrants: element("show-quadrants").checked,
      names: element("show-names").checked,
    });
    marks.show(view.turtles);
  });
}
element("refresh").addEventListener("click", () => explorer.look());
element("pad").focus({ preventScroll: true });
