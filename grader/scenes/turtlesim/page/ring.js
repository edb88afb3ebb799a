// A ring round the place of a piece of evidence.

import { METRE_PX, SIZE_M } from "./window.js";
import { svg } from "./plots.js";

export class Ring {
  constructor(place) { this.place = place; }

  show(moment) {
    if (!moment || moment.x === null || moment.y === null) {
      this.place.replaceChildren();
      return;
    }
    const [x, y] = [moment.x * METRE_PX, (SIZE_M - moment.y) * METRE_PX];
    const number = svg("text", { x: x + 20, y: y - 20 });
    number.textContent = moment.number;
    this.place.replaceChildren(
      svg("circle", { cx: x, cy: y, r: 22, class: "outer" }), svg("circle", { cx: x, cy: y, r: 22 }),
      number,
    );
  }
}
