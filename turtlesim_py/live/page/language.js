// What the page says in the reader's language, and its numbers.
//
// English stands in the HTML and in the scripts and is the key: a catalogue (fr.json, zh.json) has what
// is said instead. What it has not stays English.

/** Code -> how the language calls itself. */
export const LANGUAGES = { en: "English", fr: "français", zh: "中文" };
export const ENGLISH = "en";
const ATTRIBUTES = ["aria-label", "placeholder", "title"];
/** Names and code are the same in all languages. */
const SAME = "script, style, noscript, code, kbd, [translate=no]";

let spoken = ENGLISH;
let sentences = new Map();
const formats = new Map();
/** What stands in the HTML: {node, attribute, english, said}. */
let standing = null;

/** The language that is spoken now. */
export function language() { return spoken; }

/** A sentence, with values in the places of their names: t("{name}: done", { name }). */
export function t(english, values = {}) {
  const said = sentences.get(english) || english;
  return said.replace(/\{(\w+)\}/g, (place, name) => (name in values ? values[name] : place));
}

/** Marks a sentence that `t` says later. */
export const key = (english) => english;

/** A number for people, with so many digits behind the point; what is none as it is. */
export function number(value, digits) {
  if (!Number.isFinite(value)) return String(value);
  const kind = `${spoken} ${digits}`;
  if (!formats.has(kind)) {
    formats.set(kind, new Intl.NumberFormat(spoken, {
      minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false,
    }));
  }
  return formats.get(kind).format(Number(value.toFixed(digits)) + 0);  // no zero with a minus
}

/** Speak a language: all that stands in the HTML, and from now on all that `t` is asked for. */
export function speak(code, catalogue) {
  spoken = code;
  sentences = new Map(Object.entries(catalogue));
  document.documentElement.lang = code;
  standing = standing || found();
  for (const place of standing) {
    if (read(place) !== place.said) continue;  // a script says something else there now
    const words = place.english.trim();
    place.said = place.english.replace(words, () => t(words.replace(/\s+/g, " ")));
    if (place.attribute) place.node.setAttribute(place.attribute, place.said); else place.node.data = place.said;
  }
}

function read({ node, attribute }) { return attribute ? node.getAttribute(attribute) : node.data; }

function found() {
  const places = [];
  const walker = document.createTreeWalker(document.documentElement, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode;
    if (node.data.trim() && !node.parentElement.closest(SAME)) places.push({ node, attribute: "" });
  }
  for (const attribute of ATTRIBUTES) {
    for (const node of document.querySelectorAll(`[${attribute}]`)) {
      if (!node.closest(SAME)) places.push({ node, attribute });
    }
  }
  return places.map((place) => ({ ...place, english: read(place), said: read(place) }));
}
