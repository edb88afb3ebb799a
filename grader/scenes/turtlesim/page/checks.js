// What the checks say; each piece of evidence leads to its run and its moment.

import { t } from "./language.js";

const SIGNS = { passed: "✓", failed: "✗", not_judged: "–" };

export class Checks {
  constructor(place, onMoment) {
    this.place = place;
    this.onMoment = onMoment;
    this.buttons = [];
  }

  show(judged) {
    this.place.replaceChildren(...judged.map((check) => this.card(check)));
  }

  card({ title, status, word, rationale, help, moments }) {
    const card = document.createElement("li");
    card.className = `check ${status}`;
    const heading = document.createElement("h3");
    heading.textContent = `${SIGNS[status]} ${title}`;
    card.append(heading, words("badge", word), words("", rationale));
    if (help) card.append(words("", help));
    for (const moment of moments) card.append(this.button(moment));
    return card;
  }

  button(moment) {
    const made = document.createElement("button");
    made.type = "button";
    made.dataset.moment = moment.number;
    made.textContent = t("Show {number}: {text}", moment);
    made.addEventListener("click", () => this.onMoment(moment));
    this.buttons.push(made);
    return made;
  }

  /** Which of them is looked at; null for none. */
  mark(moment) {
    for (const button of this.buttons) {
      const isIt = moment !== null && Number(button.dataset.moment) === moment.number;
      if (isIt) button.setAttribute("aria-current", "true"); else button.removeAttribute("aria-current");
    }
  }
}

function words(kind, text) {
  const made = document.createElement("p");
  if (kind) made.className = kind;
  made.textContent = text;
  return made;
}
