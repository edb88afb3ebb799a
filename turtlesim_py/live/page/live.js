// The page: what the simulator tells is drawn and read out; the parts beside it drive and explore.

import { offerLanguages, speakAsAsked } from "./choice.js";
import { Controls } from "./controls.js";
import { Explorer } from "./explorer.js";
import { headingOf, tellGrading } from "./grading.js";
import { t } from "./language.js";
import { Marks } from "./marks.js";
import { LIVE, Rosbridge } from "./rosbridge.js";
import { TurtleWindow } from "./window.js";
import { MOST_CALLS, tellCalls, tellCallsAgain, tellTurtles } from "./words.js";

const element = (id) => document.getElementById(id);

await speakAsAsked();
const sprites = await (await fetch("sprites.json")).json();
const view = new TurtleWindow(element("canvas"), sprites);
const marks = new Marks(element("marks"));
let about = null;
let grading = null;
let isLost = false;
let isDue = false;
let hasLooked = false;
let calls = [];
let told = Promise.resolve();

/** Draw once for each picture of the screen, however much has come; nothing while it is held. */
function showSoon() {
  if (isDue || element("hold").checked) return;
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
    // once a connection: who is slow gets all of the picture often
    if (about.has_graph && !hasLooked) explorer.look();
    hasLooked = true;
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
  calls = [...calls, ...(news.calls || [])].slice(-MOST_CALLS);
  showSoon();
}

const node = () => (about.read_only ? t("{node}, for looking only", about) : about.node);
const seen = () => (grading ? headingOf(grading) : node());

/** What is told where there is no connection. */
function missed() {
  if (grading?.is_over) return t("{what}. The grading is over; what is here stays.", { what: seen() });
  return grading
    ? t("No connection: the grader has ended, or cannot be reached. Trying again …")
    : t("No connection: the simulator has ended, or cannot be reached. Trying again …");
}

function state(lost = false) {
  isLost = lost;
  const text = lost ? missed() : seen();
  if (element("state").textContent !== text) element("state").textContent = text;
  document.documentElement.dataset.state = lost ? "lost" : "live";
}

/** Everything that has been said by script, in the language that was chosen. */
function sayAgain() {
  if (about) {
    controls.know(about);
    state(isLost);
  }
  tellCallsAgain(element("calls"));
  controls.answer("");
  explorer.again();
  showSoon();
}

const bridge = new Rosbridge({
  closed: () => { hasLooked = false; state(true); controls.rest(); },
  status: (text) => controls.answer(text, true),
});
const controls = new Controls(bridge, element);
const explorer = new Explorer(bridge, element);
bridge.subscribe(LIVE, undefined, (news) => { told = told.then(() => take(news)); });
marks.obey(element, () => marks.show(view.turtles));
element("hold").addEventListener("change", showSoon);
element("refresh").addEventListener("click", () => explorer.look());
offerLanguages(element("language"), sayAgain);
element("pad").focus({ preventScroll: true });
