// Drives turtles and calls what the simulator serves: keys, buttons, forms.

import { t } from "./language.js";

const TWIST = "geometry_msgs/msg/Twist";
/** Button or key -> ahead [m/s] and turning [rad/s], as turtle_teleop_key has them. */
const DRIVE = { up: [2, 0], down: [-2, 0], left: [0, 2], right: [0, -2] };
const ARROWS = { ArrowUp: "up", ArrowDown: "down", ArrowLeft: "left", ArrowRight: "right" };
const HEADINGS = { g: 0, t: 0.7854, r: 1.5708, e: 2.3562, d: 3.1416, c: -2.3562, v: -1.5708, b: -0.7854 };
const HELD_MS = 250;

const number = (form, name) => form.elements[name].valueAsNumber;
const color = (form) => {
  const value = Number.parseInt(form.elements.color.value.slice(1), 16);
  return { r: value >> 16, g: value >> 8 & 255, b: value & 255 };
};

/** What needs a turtle: without one it would wait for a service, and be done to the next one. */
const OF_A_TURTLE = '.pad, [data-form]:not([data-form="spawn"]):not([data-form="background"])';

export class Controls {
  constructor(bridge, element) {
    this.bridge = bridge;
    this.element = element;
    this.namespace = "/";
    this.interfaces = "turtlesim";
    this.node = "/turtlesim";
    this.goal = null;
    this.held = 0;
    element("pad").addEventListener("keydown", (event) => this.onKey(event));
    for (const button of document.querySelectorAll("[data-drive]")) this.holdable(button);
    for (const button of document.querySelectorAll("[data-call]")) {
      button.addEventListener("click", () => this.call(button.dataset.call, "std_srvs/srv/Empty", {}));
    }
    for (const form of document.querySelectorAll("[data-form]")) {
      form.addEventListener("submit", (event) => {
        event.preventDefault();
        this[form.dataset.form](form);
      });
    }
    element("turtle").addEventListener("change", () => this.advertise());
  }

  get turtle() { return this.element("turtle").value || "turtle1"; }

  full(name) { return `${this.namespace.replace(/\/$/, "")}/${name}`; }

  know({ namespace, interfaces, node, read_only: isReadOnly }) {
    Object.assign(this, { namespace, interfaces, node });
    this.element("controls").hidden = isReadOnly;
    this.element("keys").hidden = isReadOnly;
    if (isReadOnly) {
      this.element("pad").setAttribute("aria-label", t("The turtles' window"));
      this.element("pad").removeAttribute("aria-describedby");
    }
    if (!isReadOnly) this.advertise();
  }

  /** A command is heard only when the simulator has found its publisher: long before the first. */
  advertise() {
    const topic = this.full(`${this.turtle}/cmd_vel`);
    if (this.topic === topic) return;
    if (this.topic) this.bridge.unadvertise(this.topic);
    this.topic = topic;
    this.bridge.advertise(topic, TWIST);
  }

  /** These turtles there are. */
  meet(names) {
    const select = this.element("turtle");
    if ([...select.options].map((option) => option.value).join() === names.join()) return;
    const chosen = select.value;
    select.replaceChildren(...names.map((name) => new Option(name, name, false, name === chosen)));
    for (const part of this.element("controls").querySelectorAll(OF_A_TURTLE)) part.inert = names.length === 0;
    if (!this.element("controls").hidden) this.advertise();
  }

  rest() { clearInterval(this.held); }

  // Driving ---------------------------------------------------------------------------------------

  onKey(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || this.element("controls").hidden) return;
    if (event.key in ARROWS) {
      this.drive(ARROWS[event.key]);
    } else if (event.key in HEADINGS) {
      this.turn(HEADINGS[event.key]);
    } else if (event.key === "f") {
      this.goal?.cancel();
    } else {
      return;
    }
    event.preventDefault();
  }

  drive(way) {
    const [x, z] = DRIVE[way];
    this.bridge.publish(this.topic, TWIST, { linear: { x }, angular: { z } });
  }

  holdable(button) {
    const end = () => clearInterval(this.held);
    button.addEventListener("pointerdown", () => {
      end();
      this.drive(button.dataset.drive);
      this.held = setInterval(() => this.drive(button.dataset.drive), HELD_MS);
    });
    for (const kind of ["pointerup", "pointercancel", "pointerleave"]) button.addEventListener(kind, end);
    button.addEventListener("click", (event) => {
      if (event.detail === 0) this.drive(button.dataset.drive);  // by keyboard
    });
  }

  turn(theta) {
    const action = this.full(`${this.turtle}/rotate_absolute`);
    this.goal = this.bridge.goal(action, `${this.interfaces}/action/RotateAbsolute`, { theta });
    this.answer("");
    this.goal.done.then(
      () => this.answer(t("{name}: done", { name: "rotate_absolute" })),
      (error) => this.answer(error.message, true),
    );
  }

  // Services --------------------------------------------------------------------------------------

  async call(name, type, args) {
    try {
      const values = await this.bridge.call(this.full(name), args, type);
      const isThere = name === "spawn" && !values.name;
      this.answer(isThere ? t("There is no new turtle: the name is taken, or is none that ROS allows.")
        : t("{name}: done", { name }), isThere);
    } catch (error) {
      this.fail(name, error);
    }
  }

  fail(what, error) { this.answer(t("{what}: {value}", { what, value: error.message }), true); }

  answer(text, isWrong = false) {
    const place = this.element("answer");
    place.textContent = text;
    place.className = isWrong ? "wrong" : "";
  }

  ofTurtle(name, type, args) {
    return this.call(`${this.turtle}/${name}`, `${this.interfaces}/srv/${type}`, args);
  }

  set_pen(form) {
    const [width, off] = [number(form, "width"), Number(form.elements.off.checked)];
    return this.ofTurtle("set_pen", "SetPen", { ...color(form), width, off });
  }

  teleport_absolute(form) {
    const [x, y, theta] = ["x", "y", "theta"].map((name) => number(form, name));
    return this.ofTurtle("teleport_absolute", "TeleportAbsolute", { x, y, theta });
  }

  teleport_relative(form) {
    const [linear, angular] = ["linear", "angular"].map((name) => number(form, name));
    return this.ofTurtle("teleport_relative", "TeleportRelative", { linear, angular });
  }

  rotate_absolute(form) { this.turn(number(form, "theta")); }

  spawn(form) {
    const [x, y, theta] = ["x", "y", "theta"].map((name) => number(form, name));
    const name = form.elements.name.value;
    return this.call("spawn", `${this.interfaces}/srv/Spawn`, { x, y, theta, name });
  }

  kill() { return this.call("kill", `${this.interfaces}/srv/Kill`, { name: this.turtle }); }

  async background(form) {
    const parameters = Object.entries(color(form)).map(([channel, value]) => ({
      name: `background_${channel}`, value: { type: 2, integer_value: value },
    }));
    try {
      await this.bridge.call(`${this.node}/set_parameters`, { parameters }, "rcl_interfaces/srv/SetParameters");
      this.answer(t("background: done"));
    } catch (error) {
      this.fail(t("background"), error);
    }
  }
}
