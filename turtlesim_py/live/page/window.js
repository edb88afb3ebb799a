// The turtles' window, pixel for pixel as ~/save_canvas writes it: background, paint, turtles.
//
// Paint comes as runs of pixels (row, first column, last column), so that no rule of strokes has to
// be known here. Turtles are turned as turtlesim_py/world/picture.py turns them.

export const SIZE_PX = 500;
export const METRE_PX = 45;
/** Width and height of the arena [m]. */
export const SIZE_M = (SIZE_PX - 1) / METRE_PX;
const SPRITE_PX = 45;
/** The simulator's own value. */
const PI = 3.14159265;
/** cos and sin of whole quarter turns [deg], where a picture has to stay sharp. */
const QUARTER_TURNS = new Map([
  [90, [0, 1]], [-270, [0, 1]], [180, [-1, 0]], [270, [0, -1]], [-90, [0, -1]],
]);

const pack = (r, g, b) => (255 << 24 | b << 16 | g << 8 | r) >>> 0;
/** A coordinate: infinities and what is no number come as text. */
const number = (value) => (typeof value === "number" ? value : NaN);

export class TurtleWindow {
  /**
   * @param {HTMLCanvasElement} canvas where to draw; it gets 500 x 500 pixels.
   * @param {Object<string, string>} sprites name -> RGBA of 45 x 45 pixels, in base64.
   */
  constructor(canvas, sprites) {
    canvas.width = canvas.height = SIZE_PX;
    this.context = canvas.getContext("2d", { willReadFrequently: true });
    this.image = this.context.createImageData(SIZE_PX, SIZE_PX);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.paint = new Uint32Array(SIZE_PX * SIZE_PX);  // 0 where there is none
    this.ground = new Uint32Array(SIZE_PX * SIZE_PX);  // paint over the background
    this.background = [69, 86, 255];
    this.turtles = [];
    this.sprites = new Map(Object.entries(sprites).map(([name, text]) => [
      name, Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)),
    ]));
    this.turned = new Map();
    this.cover();
  }

  /** Take all of the paint from a picture: a PNG with transparent pixels, in base64. */
  async setPaint(png) {
    const bytes = Uint8Array.from(atob(png), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), {
      colorSpaceConversion: "none", premultiplyAlpha: "none",
    });
    const scratch = document.createElement("canvas");
    scratch.width = scratch.height = SIZE_PX;
    const context = scratch.getContext("2d", { willReadFrequently: true });
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, SIZE_PX, SIZE_PX);
    const whole = new Uint32Array(data.buffer);
    this.paint.fill(0);
    for (let i = 0; i < whole.length; i += 1) if (data[4 * i + 3] === 255) this.paint[i] = whole[i];
    this.cover();
  }

  /** Strokes since the last ones: [[r, g, b], [row, first, last, ...]], or null: all is wiped. */
  draw(drawn) {
    for (const stroke of drawn) {
      if (stroke === null) {
        this.paint.fill(0);
        this.cover();
        continue;
      }
      const [color, runs] = stroke;
      const pixel = pack(...color);
      for (let i = 0; i < runs.length; i += 3) {
        const row = runs[i] * SIZE_PX;
        this.paint.fill(pixel, row + runs[i + 1], row + runs[i + 2] + 1);
        this.ground.fill(pixel, row + runs[i + 1], row + runs[i + 2] + 1);
      }
    }
  }

  setBackground(color) {
    if (color.join() === this.background.join()) return;
    this.background = color;
    this.cover();
  }

  cover() {
    const pixel = pack(...this.background);
    for (let i = 0; i < this.paint.length; i += 1) this.ground[i] = this.paint[i] || pixel;
  }

  /** Put everything on the canvas. */
  show() {
    this.pixels.set(this.ground);
    for (const turtle of this.turtles) this.layOver(turtle);
    this.context.putImageData(this.image, 0, 0);
  }

  layOver(turtle) {
    const clockwise = -number(turtle.heading) * 180 / PI + 90;
    const upright = this.sprites.get(turtle.sprite);
    if (!Number.isFinite(clockwise) || !upright) return;
    const { pixels, width, height } = this.turn(turtle, upright, clockwise);
    const [x, y] = turtle.px.map(number);
    const left = Number.isFinite(x) ? Math.floor(x - 0.5 * width + 0.5) : 0;
    const top = Number.isFinite(y) ? Math.floor(y - 0.5 * height + 0.5) : 0;
    const below = this.image.data;
    for (let row = Math.max(0, -top); row < Math.min(height, SIZE_PX - top); row += 1) {
      for (let column = Math.max(0, -left); column < Math.min(width, SIZE_PX - left); column += 1) {
        const from = 4 * (row * width + column);
        const alpha = pixels[from + 3];
        if (!alpha) continue;
        const to = 4 * ((top + row) * SIZE_PX + left + column);
        for (let channel = 0; channel < 3; channel += 1) {
          const mixed = pixels[from + channel] * alpha + below[to + channel] * (255 - alpha) + 127;
          below[to + channel] = Math.floor(mixed / 255);
        }
      }
    }
  }

  /** The smallest box around a picture turned so far [deg]; the last of each turtle is kept. */
  turn(turtle, upright, clockwise) {
    const kept = this.turned.get(turtle.name);
    if (kept && kept.clockwise === clockwise && kept.upright === upright) return kept;
    const angle = clockwise * (Math.PI / 180);
    const [c, s] = QUARTER_TURNS.get(clockwise) || [Math.cos(angle), Math.sin(angle)];
    const size = SPRITE_PX;
    const xs = [0, c * size, -s * size, c * size - s * size];
    const ys = [0, s * size, c * size, s * size + c * size];
    const [x0, x1] = [Math.floor(Math.min(...xs)), Math.ceil(Math.max(...xs))];
    const [y0, y1] = [Math.floor(Math.min(...ys)), Math.ceil(Math.max(...ys))];
    const [width, height] = [x1 - x0, y1 - y0];
    const pixels = new Uint8Array(4 * width * height);
    for (let y = y0; y < y1; y += 1) {
      for (let x = x0; x < x1; x += 1) {
        const fromX = Math.floor(c * (x + 0.5) + s * (y + 0.5));
        const fromY = Math.floor(c * (y + 0.5) - s * (x + 0.5));
        if (fromX < 0 || fromX >= size || fromY < 0 || fromY >= size) continue;
        const from = 4 * (fromY * size + fromX);
        pixels.set(upright.subarray(from, from + 4), 4 * ((y - y0) * width + (x - x0)));
      }
    }
    const made = { pixels, width, height, clockwise, upright };
    this.turned.set(turtle.name, made);
    return made;
  }
}
