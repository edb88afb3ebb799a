// Which language the live page speaks: what the address asks for, what was chosen, what the browser prefers.

import { ENGLISH, LANGUAGES, language, speak } from "./language.js";

const NAME = "lang";

/** Of each language that has come its sentences. */
const catalogues = new Map([[ENGLISH, {}]]);

/** Speak what the address asks for, was chosen before, or the browser prefers. */
export async function speakAsAsked() {
  speak(ENGLISH, {});
  await speakIfItComes(preferred());
}

/** Let it be chosen; `onChange` is called after each choice. */
export function offerLanguages(select, onChange) {
  for (const [code, name] of Object.entries(LANGUAGES)) {
    const option = new Option(name, code);
    option.lang = code;
    select.append(option);
    load(code);  // now: when it is chosen, the server may have ended
  }
  select.value = language();
  select.addEventListener("change", async () => {
    await speakIfItComes(select.value);
    select.value = language();
    keep(language());
    onChange();
  });
}

/** Speak a language; where its catalogue does not come, the one that is spoken stays. */
async function speakIfItComes(code) {
  await load(code);
  if (catalogues.has(code)) speak(code, catalogues.get(code));
}

async function load(code) {
  if (catalogues.has(code)) return;
  try {
    catalogues.set(code, await (await fetch(`${code}.json`)).json());
  } catch {  // the server has ended
  }
}

function preferred() {
  const asked = new URLSearchParams(location.search).get(NAME);
  const codes = [asked, kept(), ...navigator.languages].map((tag) => (tag || "").toLowerCase().split(/[-_]/)[0]);
  return codes.find((code) => Object.hasOwn(LANGUAGES, code)) || ENGLISH;
}

function keep(code) {
  const address = new URL(location.href);
  address.searchParams.set(NAME, code);
  history.replaceState(null, "", address);
  try {
    sessionStorage.setItem(NAME, code);
  } catch {  // not allowed, as in some frames: then the address alone has it
  }
}

function kept() {
  try {
    return sessionStorage.getItem(NAME);
  } catch {
    return null;
  }
}
