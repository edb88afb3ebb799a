// The page of a run that goes on: the timeline grows, and the newest is in view.

import { offerLanguages, speakAsAsked } from "./choice.js";
import { headingOf, tellGrading } from "./grading.js";
import { number, t } from "./language.js";
import { LIVE, Rosbridge } from "./rosbridge.js";
import { Timeline } from "./timeline.js";

/** So near to the end the newest is looked at [s]. */
const END_S = 0.1;
const element = (id) => document.getElementById(id);

await speakAsAsked();
const items = new Map();
let lanes = [], labels = {};
let now = 0;
let looksAt = null;
let grading = null;
let isLost = false;
let isDue = false;
const timeline = new Timeline(element, look);
element("hold").addEventListener("change", showSoon);
element("slider").addEventListener("input", () => look(element("slider").valueAsNumber));

/** Look at a moment; at the end it follows what comes. */
function look(time) {
  looksAt = time < now - END_S ? time : null;
  showSoon();
}

/** Draw once for each picture of the screen; nothing while it is held. */
function showSoon() {
  if (isDue || element("hold").checked) return;
  isDue = true;
  requestAnimationFrame(() => {
    isDue = false;
    timeline.set(lanes, labels, [...items.values()].sort((a, b) => a.t - b.t), now);
    timeline.show(looksAt ?? now);
    element("slider").max = now;
    element("slider").value = looksAt ?? now;
    element("slider").setAttribute("aria-valuetext", `${number(looksAt ?? now, 2)} s`);
    document.documentElement.dataset.time = now;
  });
}

function take(news) {
  if (news.begins) { items.clear(); looksAt = null; }
  for (const item of news.items) items.set(item.id, item);
  [lanes, labels, now] = [news.lanes, news.labels, news.t];
  if (news.grading?.heading) {
    grading = news.grading;
    tellGrading(element, grading);
  }
  state(false);
  showSoon();
}

function state(lost) {
  isLost = lost;
  let text = grading ? headingOf(grading) : t("Connecting …");
  if (lost && grading?.is_over) text = t("{what}. The grading is over; what is here stays.", { what: text });
  else if (lost) text = t("No connection: the grader has ended, or cannot be reached. Trying again …");
  if (element("state").textContent !== text) element("state").textContent = text;
  document.documentElement.dataset.state = lost ? "lost" : "live";
}

const bridge = new Rosbridge({ closed: () => state(true), status: () => {} });
bridge.subscribe(LIVE, undefined, take);
offerLanguages(element("language"), () => { state(isLost); showSoon(); });
