// Where the run on view is graded: which run it is, and what the checks say, as far as is known.

import { t } from "./language.js";

const MARKS = { passed: "✓", failed: "✗", not_judged: "–" };

function made(tag, kind, text) {
  const element = document.createElement(tag);
  element.className = kind;
  element.textContent = text;
  return element;
}

function check({ status, title, word, rationale, help }) {
  const item = made("li", status, "");
  item.append(
    made("span", "mark", `${MARKS[status] || ""} ${word}`), " ", made("strong", "", title),
    ...[rationale, help].filter(Boolean).map((text) => made("p", "", text)),
  );
  return item;
}

/** What is told at the top of the page: whose run, and which. */
export function headingOf({ heading, run }) {
  return run ? t("{what}: {value}", { what: heading, value: run }) : heading;
}

export function tellGrading(element, { score, first, checks }) {
  element("grading").hidden = false;
  element("grading-score").textContent = score;
  element("grading-first").textContent = first;
  element("checks").replaceChildren(...checks.map(check));
}
