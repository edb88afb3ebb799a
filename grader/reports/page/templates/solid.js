"use strict";
// Draws a page's solids, so that they can be turned: a z-buffer of the triangles of boxes, cylinders
// and balls. Without it the page has words.
(() => {
  const AROUND = 28, FARTHEST = 1e6;
  const LIGHT = [0.35, 0.1, 0.93], HALF_WIDTH = 0.32, FILLED = 0.86;
  const FIRST = { azimuth: 40 * Math.PI / 180, elevation: 24 * Math.PI / 180, zoom: 1 };

  // Frames: 12 numbers, three rows of a turn and a place ---------------------------------------

  function frameOf([x, y, z, a, b, c, d]) {
    const n = 2 / (a * a + b * b + c * c + d * d);
    return [
      1 - n * (b * b + c * c), n * (a * b - c * d), n * (a * c + b * d), x,
      n * (a * b + c * d), 1 - n * (a * a + c * c), n * (b * c - a * d), y,
      n * (a * c - b * d), n * (b * c + a * d), 1 - n * (a * a + b * b), z,
    ];
  }

  function joined(p, q) {
    const made = [];
    for (let row = 0; row < 12; row += 4) {
      for (let k = 0; k < 4; k += 1) {
        made.push(p[row] * q[k] + p[row + 1] * q[k + 4] + p[row + 2] * q[k + 8]
          + (k === 3 ? p[row + 3] : 0));
      }
    }
    return made;
  }

  const STILL = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

  // Shapes as triangles: [corner, corner, corner], each [x, y, z, and where it looks] ----------

  function flat(a, b, c) {
    const u = b.map((v, k) => v - a[k]), v = c.map((w, k) => w - a[k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const size = Math.hypot(...n) || 1;
    return [a, b, c].map((p) => [...p, n[0] / size, n[1] / size, n[2] / size]);
  }

  function box([x, y, z]) {
    const at = (k) => [(k & 4 ? x : -x) / 2, (k & 2 ? y : -y) / 2, (k & 1 ? z : -z) / 2];
    const sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    return sides.flatMap(([a, b, c, d]) =>
      [flat(at(a), at(b), at(c)), flat(at(a), at(c), at(d))]);
  }

  const turn = (k) => [Math.cos(2 * Math.PI * k / AROUND), Math.sin(2 * Math.PI * k / AROUND)];

  function cylinder([radius, length]) {
    const made = [], h = length / 2;
    for (let k = 0; k < AROUND; k += 1) {
      const [a, b] = [turn(k), turn(k + 1)];
      const at = ([x, y], z) => [x * radius, y * radius, z, x, y, 0];
      made.push([at(a, -h), at(b, -h), at(b, h)], [at(a, -h), at(b, h), at(a, h)]);
      const rim = ([x, y], z) => [x * radius, y * radius, z];
      made.push(flat([0, 0, h], rim(a, h), rim(b, h)), flat([0, 0, -h], rim(b, -h), rim(a, -h)));
    }
    return made;
  }

  function ball([radius]) {
    const made = [], rows = AROUND / 2;
    const at = (k, row) => {
      const tilt = Math.PI * row / rows - Math.PI / 2, [x, y] = turn(k);
      const n = [x * Math.cos(tilt), y * Math.cos(tilt), Math.sin(tilt)];
      return [...n.map((v) => v * radius), ...n];
    };
    for (let row = 0; row < rows; row += 1) {
      for (let k = 0; k < AROUND; k += 1) {
        made.push([at(k, row), at(k + 1, row), at(k + 1, row + 1)]);
        made.push([at(k, row), at(k + 1, row + 1), at(k, row + 1)]);
      }
    }
    return made;
  }

  function triangles(numbers) {
    const made = [];
    for (let k = 0; k + 9 <= numbers.length; k += 9) {
      made.push(flat(numbers.slice(k, k + 3), numbers.slice(k + 3, k + 6), numbers.slice(k + 6, k + 9)));
    }
    return made;
  }

  const SHAPES = [box, cylinder, ball, triangles];
  const rgb = (color) => [1, 3, 5].map((k) => parseInt(color.slice(k, k + 2), 16));

  /** A round step, of which about ten go into `length`. */
  function step(length) {
    const raw = length / 10, power = 10 ** Math.floor(Math.log10(raw));
    return power * ([1, 2, 5].find((m) => m * power >= raw) || 10);
  }

  class Solid {
    constructor(figure) {
      this.data = JSON.parse(figure.querySelector("script").textContent);
      this.canvas = figure.querySelector("canvas");
      this.paper = this.canvas.getContext("2d");
      this.shapes = this.data.shapes.map(([kind, frame, placing, sizes, color, alpha]) => ({
        frame, color: rgb(color), alpha, corners: SHAPES[kind](sizes), inside: frameOf(placing),
      }));
      this.player = figure.querySelector(".player input");
      this.sample = Math.max(this.data.t.length - 1, 0);
      this.waits = false;
      this.place();
      // without a ground it stands on its lowest point
      this.data.ground ??= this.world.reduce((z, { p }) => Math.min(z, p[2], p[8], p[14]), this.world.length ? Infinity : 0);
      this.frame();
      this.back();
      figure.querySelector(".turning").hidden = false;
      figure.querySelector(".still").hidden = true;
      this.listen(figure);
    }

    // What the reader does ---------------------------------------------------------------------

    listen(figure) {
      const ways = {
        left: () => this.turn(-0.26, 0), right: () => this.turn(0.26, 0),
        up: () => this.turn(0, 0.17), down: () => this.turn(0, -0.17),
        nearer: () => this.near(1.25), farther: () => this.near(0.8), back: () => this.back(),
      };
      const keys = {
        ArrowLeft: "left", ArrowRight: "right", ArrowUp: "up", ArrowDown: "down",
        "+": "nearer", "=": "nearer", "-": "farther", Home: "back",
      };
      for (const button of figure.querySelectorAll("[data-turn]")) {
        button.addEventListener("click", () => ways[button.dataset.turn]());
      }
      this.canvas.addEventListener("keydown", (event) => {
        if (!(event.key in keys) || event.ctrlKey || event.altKey || event.metaKey) return;
        event.preventDefault();
        ways[keys[event.key]]();
      });
      this.canvas.addEventListener("pointerdown", (event) => {
        this.canvas.setPointerCapture(event.pointerId);
        this.from = [event.clientX, event.clientY];
      });
      this.canvas.addEventListener("pointermove", (event) => {
        if (!event.buttons || !this.from) return;
        const [x, y] = this.from;
        this.from = [event.clientX, event.clientY];
        const scale = 3.2 / this.canvas.clientWidth;
        this.turn((event.clientX - x) * -scale, (event.clientY - y) * scale);
      });
      for (const end of ["pointerup", "pointercancel"]) {
        this.canvas.addEventListener(end, () => { this.from = null; });
      }
      this.canvas.addEventListener("wheel", (event) => {
        if (document.activeElement !== this.canvas) return; // else the page is scrolled
        event.preventDefault();
        this.near(event.deltaY < 0 ? 1.1 : 1 / 1.1);
      }, { passive: false });
      const output = figure.querySelector(".player output");
      if (!output) return;
      // whatever moves the page through time says so there
      new MutationObserver(() => this.follow())
        .observe(output, { childList: true, characterData: true, subtree: true });
      this.follow();
    }

    follow() {
      const { t } = this.data, time = +this.player.value;
      let sample = t.length - 1;
      while (sample > 0 && t[sample] > time + 0.005) sample -= 1;
      if (sample === this.sample || sample < 0) return;
      this.sample = sample;
      this.place();
      this.ask();
    }

    turn(across, up) {
      this.view.azimuth += across;
      this.view.elevation = Math.min(Math.max(this.view.elevation + up, 0.02), 1.55);
      this.ask();
    }

    near(factor) {
      this.view.zoom = Math.min(Math.max(this.view.zoom * factor, 0.25), 12);
      this.ask();
    }

    back() {
      this.view = { ...FIRST };
      this.ask();
    }

    ask() {
      if (this.waits) return;
      this.waits = true;
      requestAnimationFrame(() => { this.waits = false; this.draw(); });
    }

    // The solid in its world -------------------------------------------------------------------

    /** Put everything where it is at the sample. */
    place() {
      const frames = [];
      for (const [parent, placings] of this.data.frames) {
        const own = placings.length > 1 ? placings[this.sample] : placings[0];
        const above = parent < 0 ? STILL : frames[parent];
        frames.push(own && above ? joined(above, frameOf(own)) : null);
      }
      const world = [];
      for (const { frame, color, alpha, corners, inside } of this.shapes) {
        const lost = !frames[frame];
        const f = joined(frames[frame] || STILL, inside);
        for (const corner of corners) {
          const made = { frame, color: lost ? [255, 255, 255] : color, alpha: lost ? 1 : alpha, p: [] };
          for (const [x, y, z, a, b, c] of corner) {
            for (let row = 0; row < 12; row += 4) {
              made.p.push(f[row] * x + f[row + 1] * y + f[row + 2] * z + f[row + 3]);
            }
            for (let row = 0; row < 12; row += 4) made.p.push(f[row] * a + f[row + 1] * b + f[row + 2] * c);
          }
          if (made.p.every((v) => Math.abs(v) < FARTHEST)) world.push(made);
        }
      }
      this.world = world;
    }

    /** Choose what is in the middle, and how far the eye is away: all is seen that there ever is. */
    frame() {
      const { ground, way } = this.data;
      const points = way.map(([x, y]) => [x, y, ground]), last = this.sample;
      const stride = Math.max(Math.floor(last / 6), 1);
      for (let sample = last % stride; sample <= last; sample += stride) {
        this.sample = sample;
        this.place();
        for (const { p } of this.world) points.push([p[0], p[1], p[2]], [p[6], p[7], p[8]], [p[12], p[13], p[14]]);
      }
      if (!points.length) points.push([-1, -1, ground], [1, 1, ground]);
      const low = [0, 1, 2].map((k) => points.reduce((m, p) => Math.min(m, p[k]), Infinity));
      const high = [0, 1, 2].map((k) => points.reduce((m, p) => Math.max(m, p[k]), -Infinity));
      this.middle = low.map((v, k) => (v + high[k]) / 2);
      const { right, up, ahead } = this.axes(FIRST);
      const along = (p, axis) => p.reduce((sum, v, k) => sum + (v - this.middle[k]) * axis[k], 0);
      for (let round = 0; round < 6; round += 1) {
        const seen = points.map((p) => [along(p, right), along(p, up), along(p, ahead)]);
        this.away = seen.reduce((most, [x, y, deep]) => Math.max(
          most, Math.max(Math.abs(x), Math.abs(y)) / HALF_WIDTH / FILLED - deep, -1.25 * deep), 0.02);
        // what is near looks larger: so the middle of the picture is not that of the things
        const centre = [0, 1].map((k) => {
          const at = seen.map((p) => p[k] / (this.away + p[2]));
          return at.reduce((m, v) => Math.min(m, v)) / 2 + at.reduce((m, v) => Math.max(m, v)) / 2;
        });
        this.middle = this.middle.map((v, k) => v + (right[k] * centre[0] + up[k] * centre[1]) * this.away);
      }
    }

    axes({ azimuth, elevation }) {
      const [s, c, h, f] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
      return { right: [-s, c, 0], up: [-c * h, -s * h, f], ahead: [-c * f, -s * f, -h] };
    }

    // Drawing ------------------------------------------------------------------------------------

    draw() {
      const size = this.canvas.width, { right, up, ahead } = this.axes(this.view);
      const away = this.away / this.view.zoom;
      const eye = this.middle.map((v, k) => v - ahead[k] * away);
      const focal = size / 2 / HALF_WIDTH;
      const near = away / 50;
      this.seen = (x, y, z) => {
        const [a, b, c] = [x - eye[0], y - eye[1], z - eye[2]];
        const depth = a * ahead[0] + b * ahead[1] + c * ahead[2];
        const scale = focal / depth;
        return [
          size / 2 + (a * right[0] + b * right[1] + c * right[2]) * scale,
          size / 2 - (a * up[0] + b * up[1] + c * up[2]) * scale,
          depth,
        ];
      };
      this.near_ = near;
      this.ground(away);
      this.shadow();
      this.layer(ahead, false);
      if (this.world.some(({ alpha }) => alpha < 0.99)) this.layer(ahead, true);
    }

    ground(away) {
      const paper = this.paper, size = this.canvas.width, z = this.data.ground;
      const sky = paper.createLinearGradient(0, 0, 0, size);
      sky.addColorStop(0, "#ced8e3");
      sky.addColorStop(0.6, "#eceff3");
      paper.fillStyle = sky;
      paper.fillRect(0, 0, size, size);
      const edge = step(this.away), reach = 12;
      const [cx, cy] = this.middle.map((v) => Math.round(v / edge) * edge);
      paper.lineWidth = 1;
      for (let k = -reach; k <= reach; k += 1) {
        paper.strokeStyle = `rgba(110,122,138,${0.75 * (1 - Math.abs(k) / (reach + 2))})`;
        this.line([[cx + k * edge, cy - reach * edge, z], [cx + k * edge, cy + reach * edge, z]]);
        this.line([[cx - reach * edge, cy + k * edge, z], [cx + reach * edge, cy + k * edge, z]]);
      }
      paper.lineWidth = 3;
      paper.strokeStyle = "#1f6feb";
      this.line(this.data.way.map(([x, y]) => [x, y, z]));
    }

    /** A line in space, as far as it is before the eye. */
    line(points) {
      const paper = this.paper, least = this.near_;
      paper.beginPath();
      for (let k = 1; k < points.length; k += 1) {
        let [a, b] = [points[k - 1], points[k]];
        const [p, q] = [this.seen(...a)[2], this.seen(...b)[2]];
        if (p < least && q < least) continue;
        const cut = (least - p) / (q - p), between = a.map((v, n) => v + (b[n] - v) * cut);
        if (p < least) a = between;
        if (q < least) b = between;
        const [c, d] = [this.seen(...a), this.seen(...b)];
        paper.moveTo(c[0], c[1]);
        paper.lineTo(d[0], d[1]);
      }
      paper.stroke();
    }

    shadow() {
      const paper = this.paper, z = this.data.ground;
      paper.beginPath();
      for (const { p } of this.world) {
        const fallen = [0, 6, 12].map((k) => {
          const above = Math.max(p[k + 2] - z, 0) / LIGHT[2];
          return this.seen(p[k] - LIGHT[0] * above, p[k + 1] - LIGHT[1] * above, Math.min(p[k + 2], z));
        });
        if (fallen.some((c) => c[2] < this.near_)) continue;
        let [a, b, c] = fallen;
        // all the same way round: where two lie over each other, it is no darker
        if ((b[0] - a[0]) * (c[1] - a[1]) < (c[0] - a[0]) * (b[1] - a[1])) [b, c] = [c, b];
        paper.moveTo(a[0], a[1]);
        paper.lineTo(b[0], b[1]);
        paper.lineTo(c[0], c[1]);
      }
      paper.fillStyle = "rgba(30,40,55,.22)";
      paper.fill();
    }

    /** The nearest triangle of each pixel, lit; over what is there, if they are of glass. */
    layer(ahead, glass) {
      const size = this.canvas.width, count = size * size;
      const nearness = new Float32Array(count), found = new Int32Array(count).fill(-1);
      const seen = this.world.map((triangle) => this.corners(triangle, ahead));
      seen.forEach((triangle, number) => {
        if (triangle) this.fill(triangle, number, size, nearness, found, glass);
      });
      if (glass) seen.forEach((t, n) => { if (t && this.world[n].alpha >= 0.99) this.hide(t, size, nearness, found); });
      const image = new ImageData(size, size), out = image.data;
      for (let at = 0; at < count; at += 1) {
        const number = found[at];
        if (number < 0) continue;
        const { color, alpha, frame } = this.world[number], t = seen[number];
        const light = this.light(t, at % size + 0.5, Math.floor(at / size) + 0.5);
        const left = at % size ? found[at - 1] : number, above = at >= size ? found[at - size] : number;
        const other = (n) => n < 0 || this.world[n].frame !== frame;
        const shade = light * (other(left) || other(above) ? 0.55 : 1);
        for (let k = 0; k < 3; k += 1) out[4 * at + k] = color[k] * shade;
        out[4 * at + 3] = 255 * alpha;
      }
      const sheet = document.createElement("canvas");
      sheet.width = sheet.height = size;
      sheet.getContext("2d").putImageData(image, 0, 0);
      this.paper.drawImage(sheet, 0, 0);
    }

    /** A triangle in the picture with the light on its corners; null behind the eye. */
    corners({ p }, ahead) {
      const made = { x: [], y: [], w: [], light: [] };
      for (let k = 0; k < 18; k += 6) {
        const [x, y, depth] = this.seen(p[k], p[k + 1], p[k + 2]);
        if (!(depth >= this.near_)) return null;
        made.x.push(x);
        made.y.push(y);
        made.w.push(1 / depth);
        const n = [p[k + 3], p[k + 4], p[k + 5]];
        let towards = -(n[0] * ahead[0] + n[1] * ahead[1] + n[2] * ahead[2]);
        const sign = towards < 0 ? -1 : 1;
        const sun = Math.max(sign * (n[0] * LIGHT[0] + n[1] * LIGHT[1] + n[2] * LIGHT[2]), 0);
        made.light.push(0.42 + 0.5 * sun + 0.16 * Math.abs(towards));
      }
      const [ax, bx, cx] = made.x, [ay, by, cy] = made.y;
      made.area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      return made.area ? made : null;
    }

    /** Call `inside(place, nearness)` for each pixel of a triangle. */
    scan({ x, y, w, area }, size, inside) {
      const [ax, bx, cx] = x, [ay, by, cy] = y;
      const left = Math.max(Math.floor(Math.min(...x)), 0), end = Math.min(Math.ceil(Math.max(...x)), size);
      const top = Math.max(Math.floor(Math.min(...y)), 0), bottom = Math.min(Math.ceil(Math.max(...y)), size);
      for (let row = top; row < bottom; row += 1) {
        for (let column = left; column < end; column += 1) {
          const u = column + 0.5 - ax, v = row + 0.5 - ay;
          const b = (u * (cy - ay) - (cx - ax) * v) / area, c = ((bx - ax) * v - u * (by - ay)) / area;
          if (b >= 0 && c >= 0 && b + c <= 1) inside(row * size + column, w[0] + b * (w[1] - w[0]) + c * (w[2] - w[0]));
        }
      }
    }

    fill(triangle, number, size, nearness, found, glass) {
      if ((this.world[number].alpha < 0.99) !== glass) return;
      this.scan(triangle, size, (at, near) => {
        if (near > nearness[at]) { nearness[at] = near; found[at] = number; }
      });
    }

    hide(triangle, size, nearness, found) {
      this.scan(triangle, size, (at, near) => { if (near >= nearness[at]) found[at] = -1; });
    }

    light({ x, y, light, area }, px, py) {
      const u = px - x[0], v = py - y[0];
      const b = (u * (y[2] - y[0]) - (x[2] - x[0]) * v) / area, c = ((x[1] - x[0]) * v - u * (y[1] - y[0])) / area;
      return light[0] + b * (light[1] - light[0]) + c * (light[2] - light[0]);
    }
  }

  for (const figure of document.querySelectorAll(".solid")) {
    if (figure.querySelector("canvas")) new Solid(figure);
  }
})();
