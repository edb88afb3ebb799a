// What the server answers in English, said in the reader's language.

import { key, t } from "./language.js";

/** As turtlesim_py/live/ has them: messages.py, graph.py, rosbridge.py. */
const ANSWERS = [
  key("there are no topics and services to be seen here"),
  key("nobody serves the action {action}"),
  key("nobody serves {service}"),
  key("the goal for {action} was not accepted"),
  key("there is no topic {name}"),
  key("there is no service {name}"),
  key("the type {name} is not installed here"),
  key("more than {n} frames a second: this one is not heard"),
  key("{op} is refused: this page is for looking only"),
  key("a viewer may have {n} at once"),
  key("the message: expected fields, found {found}"),
  key("the message: no field {name}; there are {fields}"),
  key("{field}: expected fields, found {found}"),
  key("{field}: no field {name}; there are {fields}"),
  key("{field}: expected a list, found {found}"),
  key("{field}: expected true or false, found {found}"),
  key("{field}: expected a text, found {found}"),
  key("{field}: expected a number, found one too large"),
  key("{field}: expected a number, found {found}"),
  key("{field}: expected a whole number from {low} to {high}, found {found}"),
];
const patterns = ANSWERS.map((english) => [
  english,
  new RegExp(`^${english.replace(/[.*+?^$()|[\]\\]/g, "\\$&").replace(/\{(\w+)\}/g, "(?<$1>.+?)")}$`, "s"),
]);

/** An answer in the reader's language; one that is not known as it is. */
export function heard(answer) {
  for (const [english, pattern] of patterns) {
    const found = pattern.exec(answer);
    if (found) return t(english, found.groups);
  }
  return answer;
}
