// Which language the live page speaks: what the address asks for, what was chosen, what the browser prefers.

import { ENGLISH, LANGUAGES, language, speak } from "./language.js";

const NAME = "lang";

/** Let it be chosen; `onChange` is called after each choice. */
export function offerLanguages(select, onChange) {
  for (const [code, name] of Object.entries(LANGUAGES)) {
    const option = new Option(name, code);
    option.lang = code;
    select.append(option);
  }
  select.value = language();
  select.addEventListener("change", async () => {
    keep(select.value);
    await begin(select.value);
    select.value = language();
    onChange();
  });
}

/** Speak what the address asks for, was chosen before, or the browser prefers. */
export function speakAsAsked() { return begin(preferred()); }

/** Speak a language, or English where its catalogue does not come. */
async function begin(code) {
  if (code === ENGLISH) {
    speak(ENGLISH, {});
    return;
  }
  try {
    speak(code, await (await fetch(`${code}.json`)).json());
  } catch {  // the simulator has ended
    speak(ENGLISH, {});
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
