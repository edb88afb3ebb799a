"use strict";
// Makes the page move: the animation, the choice of a run, and the links between text, picture and
// plots. Without it the page is complete but still.
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const animations = JSON.parse(document.getElementById("animations").textContent);
  const words = JSON.parse(document.getElementById("words").textContent);
  document.documentElement.classList.add("script");

  /** The index of the last sample that is not after `time`. */
  function sampleAt(animation, time) {
    let low = 0, high = animation.t.length - 1;
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (animation.t[middle] <= time) low = middle; else high = middle - 1;
    }
    return low;
  }

  class Player {
    constructor(run, animation) {
      const root = document.querySelector(`.pictures .run[data-run="${run}"]`);
      this.animation = animation;
      this.end = animation.t[animation.t.length - 1];
      this.controls = root.querySelector(".player");
      this.button = root.querySelector(".play");
      this.slider = root.querySelector(".player input");
      this.output = root.querySelector("output");
      this.speed = root.querySelector("select");
      this.veil = root.querySelector(".veil");
      this.layer = root.querySelector(".ink");
      this.turtles = all(".turtle", root);
      this.cursors = all(`.area[data-run="${run}"] .now`);
      this.lines = null;
      this.last = 0;
      this.playing = false;
      this.controls.hidden = false;
      this.button.addEventListener("click", () => (this.playing ? this.pause() : this.play()));
      this.slider.addEventListener("input", () => { this.pause(); this.seek(+this.slider.value); });
      for (const area of all(`.area[data-run="${run}"]`)) this.follow(area);
    }

    /** Drag over a plot to move through time. */
    follow(area) {
      const seek = (event) => {
        const box = area.getBoundingClientRect();
        this.pause();
        this.seek((event.clientX - box.left) / box.width * this.end);
      };
      area.addEventListener("pointerdown", seek);
      area.addEventListener("pointermove", (event) => { if (event.buttons) seek(event); });
    }

    play() {
      if (+this.slider.value >= this.end) this.seek(0);
      this.playing = true;
      this.button.textContent = words.pause;
      this.last = performance.now();
      requestAnimationFrame((now) => this.frame(now));
    }

    pause() {
      this.playing = false;
      this.button.textContent = words.play;
    }

    frame(now) {
      if (!this.playing) return;
      const time = +this.slider.value + (now - this.last) / 1000 * +this.speed.value;
      this.last = now;
      this.seek(time);
      if (time >= this.end) this.pause(); else requestAnimationFrame((next) => this.frame(next));
    }

    /** Show the moment `time` [s]; the end is the finished picture. */
    seek(time) {
      time = Math.min(Math.max(time, 0), this.end);
      const atEnd = time >= this.end;
      this.slider.value = time;
      this.output.textContent = atEnd ? words.end : words.seconds.replace("#", time.toFixed(1).replace(".", words.point));
      for (const cursor of this.cursors) {
        cursor.hidden = atEnd;
        cursor.style.left = `${100 * time / this.end}%`;
      }
      this.veil?.setAttribute("visibility", atEnd ? "hidden" : "visible");
      this.layer?.setAttribute("visibility", atEnd ? "hidden" : "visible");
      const sample = sampleAt(this.animation, time);
      this.turtles.forEach((turtle, k) => this.place(turtle, this.animation.tracks[k], sample, atEnd));
      if (!atEnd) this.draw(sample);
    }

    place(turtle, track, sample, atEnd) {
      const [x, y, angle] = [track.x[sample], track.y[sample], track.a[sample]];
      const there = !atEnd && x !== null && y !== null;
      turtle.setAttribute("visibility", there ? "visible" : "hidden");
      if (there) turtle.setAttribute("transform", `translate(${x} ${y}) rotate(${angle || 0})`);
    }

    /** One line for each stretch of ink, made when it is first needed. */
    prepare() {
      this.lines = [];
      for (const track of this.animation.tracks) {
        for (const [first, last, color, width] of track.ink) {
          const element = document.createElementNS(SVG, "polyline");
          element.setAttribute("stroke", color);
          element.setAttribute("stroke-width", width || 1);
          this.layer.append(element);
          this.lines.push({ track, first, last, element, shown: -1 });
        }
      }
    }

    draw(sample) {
      if (this.lines === null) this.prepare();
      const cleared = Math.max(0, ...this.animation.cleared.filter((at) => at <= sample));
      for (const line of this.lines) {
        const until = Math.min(line.last, sample);
        const shown = until > line.first && until > cleared ? until * 100000 + cleared : 0;
        if (shown === line.shown) continue;
        line.shown = shown;
        const points = [];
        for (let k = Math.max(line.first, cleared); shown && k <= until; k += 1) {
          if (line.track.x[k] !== null && line.track.y[k] !== null) {
            points.push(`${line.track.x[k]},${line.track.y[k]}`);
          }
        }
        line.element.setAttribute("points", points.join(" "));
      }
    }
  }

  const players = {};
  for (const [run, animation] of Object.entries(animations)) {
    if (animation.t.length && document.querySelector(`.pictures .run[data-run="${run}"] .player`)) {
      players[run] = new Player(run, animation);
    }
  }

  function show(run) {
    for (const element of all(".run")) element.hidden = element.dataset.run !== run;
    for (const tab of all("[data-show]")) {
      tab.setAttribute("aria-pressed", String(tab.dataset.show === run));
    }
  }

  for (const tabs of all(".tabs")) tabs.hidden = false;
  for (const tab of all("[data-show]")) {
    tab.addEventListener("click", () => show(tab.dataset.show));
  }
  for (const element of all("[data-point]")) {
    const twins = all(`[data-point="${element.dataset.point}"]`);
    const light = (on) => twins.forEach((twin) => twin.classList.toggle("lit", on));
    element.addEventListener("pointerenter", () => light(true));
    element.addEventListener("pointerleave", () => light(false));
    element.addEventListener("focusin", () => light(true));
    element.addEventListener("focusout", () => light(false));
  }

  /** Show the moment `time` [s] of a run. */
  function goTo(run, time) {
    show(run);
    const player = players[run];
    if (player) { player.pause(); player.seek(+time); }
  }
  for (const link of all("a[data-time]")) {
    link.addEventListener("click", () => goTo(link.dataset.run, link.dataset.time));
  }

  // The page opens at the moment that its address names, else at the first fault.
  const { opensRun = "0", opensTime } = document.querySelector("main").dataset;
  const named = location.hash && document.getElementById(location.hash.slice(1));
  const moment = named && (named.matches("[data-time]") ? named : named.querySelector("[data-time]"));
  if (moment) goTo(moment.dataset.run, moment.dataset.time);
  else if (opensTime) goTo(opensRun, opensTime);
  else show(opensRun);

  // How it ended stands last.
  for (const output of all("details[open] pre")) output.scrollTop = output.scrollHeight;

  // On paper the picture is described in words: nobody can open anything there.
  const closed = all(".words");
  window.addEventListener("beforeprint", () => closed.forEach((part) => {
    part.dataset.open = part.open;
    part.open = true;
  }));
  window.addEventListener("afterprint", () => closed.forEach((part) => {
    part.open = part.dataset.open === "true";
  }));
})();
