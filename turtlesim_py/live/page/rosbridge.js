// A connection to the simulator, as rosbridge has it: topics in, commands and calls out. It comes
// back by itself when the server does.

import { t } from "./language.js";

/** The topic that only this server has: what becomes of the arena. */
export const LIVE = "/turtlesim_live";
const FIRST_PAUSE_MS = 300;
const LONGEST_PAUSE_MS = 1000;

/** Why something was refused, in the reader's language; in English where it is not the page's own server. */
function text(sentence, english) { return sentence ? t(sentence.key, sentence.values) : String(english); }

export class Rosbridge {
  /** @param {{closed: function(), status: function(string)}} told */
  constructor(told) {
    this.told = told;
    this.listeners = new Map();
    this.waiting = new Map();
    this.advertised = new Map();
    this.number = 0;
    this.pause = FIRST_PAUSE_MS;
    this.connect();
  }

  connect() {
    // beside the page, whatever stands before it: a forwarded port, a prefix, https
    const address = new URL("socket", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    address.search = location.search;
    this.socket = new WebSocket(address);
    this.socket.addEventListener("open", () => {
      this.pause = FIRST_PAUSE_MS;
      for (const [topic, { type }] of this.listeners) this.askFor(topic, type);
      for (const [topic, type] of this.advertised) this.send({ op: "advertise", topic, type });
    });
    this.socket.addEventListener("message", (event) => this.hear(JSON.parse(event.data)));
    this.socket.addEventListener("close", () => {
      for (const { fail } of this.waiting.values()) fail(new Error(t("the connection has ended")));
      this.waiting.clear();
      this.told.closed();
      setTimeout(() => this.connect(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE_MS);
    });
  }

  get isOpen() { return this.socket.readyState === WebSocket.OPEN; }

  send(frame) { if (this.isOpen) this.socket.send(JSON.stringify(frame)); }

  hear(frame) {
    if (frame.op === "publish") {
      this.listeners.get(frame.topic)?.hear(frame.msg);
    } else if (frame.op === "service_response" || frame.op === "action_result") {
      const call = this.waiting.get(frame.id);
      this.waiting.delete(frame.id);
      if (frame.result) call?.done(frame.values); else call?.fail(new Error(text(frame.sentence, frame.values)));
    } else if (frame.op === "status") {
      const why = text(frame.sentence, frame.msg);
      this.waiting.get(frame.id)?.fail(new Error(why));
      this.waiting.delete(frame.id);
      this.told.status(why);
    }
  }

  subscribe(topic, type, hear) {
    this.listeners.set(topic, { type, hear });
    this.askFor(topic, type);
  }

  askFor(topic, type) {
    this.send({ op: "subscribe", topic, type, throttle_rate: topic === LIVE ? 0 : 100 });
  }

  unsubscribe(topic) {
    if (this.listeners.delete(topic)) this.send({ op: "unsubscribe", topic });
  }

  advertise(topic, type) {
    if (this.advertised.has(topic)) return;
    this.advertised.set(topic, type);
    this.send({ op: "advertise", topic, type });
  }

  unadvertise(topic) {
    if (this.advertised.delete(topic)) this.send({ op: "unadvertise", topic });
  }

  publish(topic, type, msg) {
    this.advertise(topic, type);
    this.send({ op: "publish", topic, type, msg });
  }

  /** What a service answers; rejected where it does not. */
  call(service, args = {}, type = undefined) {
    return this.ask({ op: "call_service", service, args, type });
  }

  /** What an action ends with; `cancel` ends it. */
  goal(action, action_type, args) {
    const id = this.nextId();
    const done = this.ask({ op: "send_action_goal", action, action_type, args, feedback: false }, id);
    return { done, cancel: () => this.send({ op: "cancel_action_goal", action, id }) };
  }

  nextId() {
    this.number += 1;
    return `call ${this.number}`;
  }

  ask(frame, id = this.nextId()) {
    if (!this.isOpen) return Promise.reject(new Error(t("there is no connection")));
    return new Promise((done, fail) => {
      this.waiting.set(id, { done, fail });
      this.send({ ...frame, id });
    });
  }
}
