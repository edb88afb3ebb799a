// What `ros2 topic` and `ros2 service` would say: names, types, fields, a message, a call.

import { key, t } from "./language.js";

/** Units, where a type has them by its meaning. */
const UNITS = {
  "geometry_msgs/Twist": { linear: "m/s", angular: "rad/s" },
  "turtlesim/Pose": { x: "m", y: "m", theta: "rad", linear_velocity: "m/s", angular_velocity: "rad/s" },
  "turtlesim/TeleportAbsolute": { x: "m", y: "m", theta: "rad" },
  "turtlesim/TeleportRelative": { linear: "m", angular: "rad" },
  "turtlesim/Spawn": { x: "m", y: "m", theta: "rad" },
  "turtlesim/SetPen": {
    r: key("0 to 255"), g: key("0 to 255"), b: key("0 to 255"), width: "px", off: key("0 or 1"),
  },
};
const unitsOf = (type) => (
  UNITS[type.replace(/\/(msg|srv)\//, "/").replace("turtlesim_msgs/", "turtlesim/")] || {}
);
const ZEROS = { string: "", boolean: false };

function made(tag, text = "", ...children) {
  const element = document.createElement(tag);
  if (text) element.textContent = text;
  element.append(...children);
  return element;
}

/** What a text of JSON says. */
function read(text) {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new Error(t("This is no JSON: {why}", { why: error.message }));
  }
}

/** A message of a type with zeros in it. */
function empty(typedefs, type) {
  const found = typedefs.find((each) => each.type === type) || { fieldnames: [] };
  return Object.fromEntries(found.fieldnames.map((name, index) => {
    const kind = found.fieldtypes[index];
    if (found.fieldarraylen[index] >= 0) return [name, []];
    return [name, kind.includes("/") ? empty(typedefs, kind) : ZEROS[kind] ?? 0];
  }));
}

export class Explorer {
  constructor(bridge, element) {
    this.bridge = bridge;
    this.element = element;
    this.heard = "";
    this.again = () => {};
  }

  async look() {
    try {
      const { topics, types } = await this.bridge.call("/rosapi/topics");
      const { services } = await this.bridge.call("/rosapi/services");
      this.list("topics", topics.map((name, index) => [name, types[index]]), (name, type) => this.topic(name, type));
      this.list("services", services.map((name) => [name, ""]), (name) => this.service(name));
    } catch (error) {
      this.fail(error);
    }
  }

  fail(error) { this.element("detail").replaceChildren(made("p", error.message)); }

  list(id, names, show) {
    this.element(id).replaceChildren(...names.map(([name, type]) => {
      const button = made("button", name);
      button.type = "button";
      const open = () => show(name, type).catch((error) => this.fail(error));
      button.addEventListener("click", async () => {
        this.again = open;
        await open();
        this.element("detail").focus();
      });
      return made("li", "", button, " ", made("span", type));
    }));
  }

  show(...parts) {
    this.forget();
    this.element("detail").replaceChildren(...parts);
  }

  forget() {
    if (this.heard) this.bridge.unsubscribe(this.heard);
    this.heard = "";
  }

  async topic(name, type) {
    const { typedefs } = await this.bridge.call("/rosapi/message_details", { type });
    const { publishers } = await this.bridge.call("/rosapi/publishers", { topic: name });
    const { subscribers } = await this.bridge.call("/rosapi/subscribers", { topic: name });
    const message = made("pre", t("Waiting for a message …"));
    const [by, to] = [publishers, subscribers].map((nodes) => nodes.join(", ") || t("nobody"));
    this.show(
      made("h3", name), made("p", type), made("p", t("published by {by}; heard by {to}", { by, to })),
      fields(typedefs, type), made("h4", t("A message")), message,
      this.form(t("Publish"), empty(typedefs, type), (said) => {
        this.bridge.publish(name, type, said);
        return Promise.resolve(t("published"));
      }),
    );
    this.heard = name;
    this.bridge.subscribe(name, type, (heard) => { message.textContent = JSON.stringify(heard, null, 1); });
  }

  async service(name) {
    const { type } = await this.bridge.call("/rosapi/service_type", { service: name });
    const { typedefs } = await this.bridge.call("/rosapi/service_request_details", { type });
    const form = this.form(t("Call"), empty(typedefs, type), (said) => this.bridge.call(name, said, type));
    this.show(made("h3", name), made("p", type), fields(typedefs, type), form);
  }

  /** A text of JSON, and a button that sends it. */
  form(verb, template, send) {
    const label = made("label", t("What to send, as JSON"));
    const text = document.createElement("textarea");
    text.value = JSON.stringify(template, null, 1);
    text.rows = Math.min(14, text.value.split("\n").length);
    label.append(text);
    const answer = made("pre");
    answer.setAttribute("role", "status");
    const form = made("form", "", label, made("button", verb), answer);
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      try {
        const said = await send(read(text.value));
        answer.textContent = typeof said === "string" ? said : JSON.stringify(said, null, 1);
      } catch (error) {
        answer.textContent = error.message;
      }
    });
    return form;
  }
}

function fields(typedefs, type) {
  const [own, ...others] = typedefs;
  const parts = [own, ...others].map((each, index) => {
    const units = index ? {} : unitsOf(type);
    const rows = each.fieldnames.map((name, at) => {
      const length = each.fieldarraylen[at];
      const array = length < 0 ? "" : `[${length || ""}]`;
      const unit = units[name] ? ` [${t(units[name])}]` : "";
      return made("li", "", made("code", `${name}: ${each.fieldtypes[at]}${array}`), unit);
    });
    return made("div", "", made("h4", index ? each.type : t("Fields")), made("ul", "", ...(rows.length ? rows : [made("li", t("none"))])));
  });
  return made("div", "", ...parts);
}
