// The cursor: played at some speed, stepped, dragged, moved by keys.

import { number, t } from "./language.js";

/** A frame that takes longer than this on the screen moves the cursor no further [s]. */
const LONGEST_S = 0.25;

export class Transport {
  /** @param {function(string): HTMLElement} element by its id. */
  constructor(element, tickS, onFrame) {
    this.element = element;
    this.tickS = tickS;
    this.onFrame = onFrame;
    this.frame = 0;
    this.last = 0;
    this.exactly = 0;
    this.isPlaying = false;
    element("slider").addEventListener("input", () => {
      this.pause();
      this.go(element("slider").valueAsNumber);
    });
    element("play").addEventListener("click", () => this.toggle());
    element("back").addEventListener("click", () => this.step(-1));
    element("forth").addEventListener("click", () => this.step(1));
    // not of the whole page: a key that a reader's own tools use would move the cursor
    element("transport").addEventListener("keydown", (event) => this.onKey(event));
  }

  onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const isFree = !event.target.closest("button, select, summary, a, input:not([type=range])");
    const actions = { ",": () => this.step(-1), ".": () => this.step(1) };
    if (isFree) actions[" "] = () => this.toggle();
    if (!actions[event.key] || event.target.closest("select")) return;
    event.preventDefault();
    actions[event.key]();
  }

  /** How long it is; the cursor stays where it is, if that is in it. */
  setLast(last) {
    this.last = last;
    const slider = this.element("slider");
    slider.max = last;
    this.go(Math.min(this.frame, last));
  }

  go(frame) {
    this.frame = Math.max(0, Math.min(this.last, frame));
    this.exactly = this.frame;
    this.tell();
  }

  step(ticks) {
    this.pause();
    this.go(this.frame + ticks);
  }

  toggle() { if (this.isPlaying) this.pause(); else this.play(); }

  play() {
    if (this.frame >= this.last) this.go(0);
    this.isPlaying = true;
    this.element("play").textContent = t("❚❚ Pause");
    let before = performance.now();
    const advance = (now) => {
      if (!this.isPlaying) return;
      const passed = Math.min(LONGEST_S, (now - before) / 1000);
      before = now;
      this.exactly += (passed * Number(this.element("speed").value)) / this.tickS;
      const frame = Math.min(this.last, Math.floor(this.exactly));
      if (frame !== this.frame) {
        this.frame = frame;
        this.tell();
      }
      if (frame >= this.last) this.pause(); else requestAnimationFrame(advance);
    };
    requestAnimationFrame(advance);
  }

  pause() {
    this.isPlaying = false;
    this.element("play").textContent = t("▶ Play");
  }

  tell() {
    const [tick, last] = [this.frame, this.last];
    const place = { time: number(tick * this.tickS, 3), tick, last };
    const slider = this.element("slider");
    slider.value = this.frame;
    slider.setAttribute("aria-valuetext", t("{time} seconds, tick {tick} of {last}", place));
    this.element("time").textContent = t("{time} s, tick {tick} of {last}", place);
    this.onFrame(this.frame);
  }
}
