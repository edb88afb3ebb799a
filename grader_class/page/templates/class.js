"use strict";
// Sorts, finds, hides names, and shows one path among all. Without it the page is complete but still.
(() => {
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const by = (id) => document.getElementById(id);
  const words = JSON.parse(by("words").textContent);
  document.documentElement.classList.add("script");

  const body = by("class").tBodies[0];
  const rows = all("tr", body);
  const row = new Map(rows.map((each) => [each.dataset.of, each]));
  const thumbs = new Map(all(".thumbs li").map((each) => [each.dataset.of, each]));
  const paths = new Map(all(".paths .all path").map((each) => [each.dataset.of, each]));

  // Finding: what is seen of a row is what is searched, so hidden names cannot be found.
  const folded = (text) => text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase();
  let texts = new Map();
  let matching = new Set(row.keys());

  function find() {
    const wanted = folded(by("find").value).split(/\s+/).filter(Boolean);
    matching = new Set();
    for (const [of, element] of row) {
      if (!texts.has(of)) {
        texts.set(of, folded([...element.cells].map((cell) => cell.textContent).join(" ")));
      }
      const found = wanted.every((word) => texts.get(of).includes(word));
      if (found) matching.add(of);
      element.hidden = !found;
      const thumb = thumbs.get(of);
      if (thumb) thumb.hidden = !found;
      const path = paths.get(of);
      if (path) path.classList.toggle("out", !found);
    }
    if (chosen && !matching.has(chosen)) forget();
    by("found").textContent = words.found.replace("#", matching.size).replace("#", rows.length);
  }

  // Sorting: by what is seen, or what a cell says instead; of equals, by the name that is seen.
  const heads = all("thead th", by("class"));
  const collator = new Intl.Collator(document.documentElement.lang, { numeric: true, sensitivity: "base" });
  let sorted = { column: 0, descending: false };

  function value(element, column) {
    const cell = element.cells[column];
    if (heads[column].dataset.kind !== "number") return cell.textContent;
    const time = cell.querySelector("time");
    const number = time ? Date.parse(time.dateTime) : parseFloat(cell.dataset.sort ?? cell.textContent);
    return Number.isNaN(number) ? -Infinity : number;
  }

  function sort(column, descending) {
    sorted = { column, descending };
    const compared = (a, b) => (typeof a === "number" ? (a > b) - (a < b) : collator.compare(a, b));
    const order = rows.map((element) => [value(element, column), element.cells[0].textContent, element]);
    order.sort(([a, one], [b, other]) =>
      (descending ? -1 : 1) * compared(a, b) || compared(one, other));
    body.append(...order.map(([, , element]) => element));
    heads.forEach((head, k) => {
      if (k === column) head.setAttribute("aria-sort", descending ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
  }

  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      // first the most points, the latest, but names from A on
      const again = sorted.column === column;
      sort(column, again ? !sorted.descending : head.dataset.kind === "number");
      const how = sorted.descending ? words.descending : words.ascending;
      by("sorted").textContent = how.replace("#", button.textContent.trim());
    });
  });

  // One path among all: pointed at, stepped to, or that of the row or picture in focus.
  const say = by("chosen");
  const asked = say?.textContent;
  const lines = all(".paths .halo, .paths .chosen");
  let chosen = null;
  let lit = [];

  function forget() {
    chosen = null;
    for (const element of lit) element.classList.remove("lit");
    for (const line of lines) line.setAttribute("d", "");
    if (say) say.textContent = asked;
  }

  function choose(of) {
    forget();
    chosen = of;
    lit = [row.get(of), thumbs.get(of)].filter(Boolean);
    for (const element of lit) element.classList.add("lit");
    if (!thumbs.has(of)) return;
    const d = paths.has(of) ? paths.get(of).getAttribute("d") : "";
    for (const line of lines) line.setAttribute("d", d);
    const from = thumbs.get(of).querySelector("a");
    const name = document.createElement(from.hasAttribute("href") ? "a" : "span");
    if (from.hasAttribute("href")) name.href = from.getAttribute("href");
    name.textContent = from.querySelector("bdi").textContent;
    say.replaceChildren(name, words.points.replace("#", from.querySelector("b").textContent));
  }

  for (const kind of ["pointerover", "focusin"]) {
    document.addEventListener(kind, (event) => {
      const element = event.target.closest("tr[data-of], li[data-of]");
      if (element && element.dataset.of !== chosen) choose(element.dataset.of);
    });
  }

  for (const button of all("[data-step]")) {
    button.addEventListener("click", () => {
      const order = [...thumbs.keys()].filter((of) => matching.has(of) && paths.has(of));
      if (!order.length) return;
      const at = order.indexOf(chosen);
      const step = Number(button.dataset.step);
      choose(order[at < 0 ? (step > 0 ? 0 : order.length - 1) : (at + step + order.length) % order.length]);
    });
  }

  /** The corners of a path: its pieces, each a start and steps from corner to corner. */
  function corners(path) {
    return path.getAttribute("d").split("M").slice(1).map((piece) => {
      const numbers = piece.match(/-?\d+/g).map(Number);
      for (let k = 2; k < numbers.length; k += 1) numbers[k] += numbers[k - 2];
      return numbers;
    });
  }

  /** How far a place is from a piece, squared. */
  function distance(x, y, numbers) {
    let least = Infinity;
    for (let k = 0; k + 3 < numbers.length; k += 2) {
      const [dx, dy] = [numbers[k + 2] - numbers[k], numbers[k + 3] - numbers[k + 1]];
      const [px, py] = [x - numbers[k], y - numbers[k + 1]];
      const along = dx || dy ? Math.min(Math.max((px * dx + py * dy) / (dx * dx + dy * dy), 0), 1) : 0;
      least = Math.min(least, (px - along * dx) ** 2 + (py - along * dy) ** 2);
    }
    return least;
  }

  const picture = document.querySelector(".paths");
  let pieces = null;
  if (picture) {
    by("steps").hidden = false;
    const near = (picture.viewBox.baseVal.width / 40) ** 2;
    picture.addEventListener("pointermove", (event) => {
      pieces ??= [...paths].map(([of, path]) => [of, corners(path)]);
      const box = picture.getBoundingClientRect();
      const scale = picture.viewBox.baseVal.width / box.width;
      const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
      let [best, least] = [null, near];
      for (const [of, parts] of pieces) {
        if (!matching.has(of)) continue;
        for (const part of parts) {
          const far = distance(x, y, part);
          if (far < least) [best, least] = [of, far];
        }
      }
      if (best !== null && best !== chosen) choose(best);
    });
  }

  // Hiding: names and ids become numbers; links, which lead to pages with names, rest meanwhile.
  const told = all("[data-name], [data-id]").map((element) => [element, element.textContent]);
  const links = all("a.report").map((link) => [link, link.getAttribute("href")]);

  function rest(link) {
    link.removeAttribute("href");
    link.setAttribute("role", "link");
    link.setAttribute("aria-disabled", "true");
    link.tabIndex = 0;
  }

  function wake(link, address) {
    for (const attribute of ["role", "aria-disabled", "tabindex"]) link.removeAttribute(attribute);
    link.setAttribute("href", address);
  }

  function hideNames(hide) {
    by("hide").setAttribute("aria-pressed", String(hide));
    for (const [element, text] of told) {
      const { name, id } = element.dataset;
      element.textContent = hide ? (name ? words.student.replace("#", name) : id) : text;
    }
    for (const link of all("a.part")) link.hash = hide ? "names-hidden" : "";
    for (const [link, address] of links) if (hide) rest(link); else wake(link, address);
    for (const element of all(".named")) element.hidden = hide;
    texts = new Map();
    if (hide) by("find").value = "";
    sort(sorted.column, sorted.descending);  // an order by names would tell them
    find();
    if (chosen) choose(chosen);
    remember();
  }

  /** A page that is loaded again in front of a class hides them again. */
  function remember() {
    history.replaceState(null, "", isHidden() ? "#names-hidden" : "#");
  }

  const isHidden = () => by("hide").getAttribute("aria-pressed") === "true";
  window.addEventListener("hashchange", () => { if (isHidden()) remember(); });

  document.querySelector(".tools").hidden = false;
  by("find").addEventListener("input", find);
  by("hide").addEventListener("click", () => hideNames(!isHidden()));
  if (location.hash === "#names-hidden") hideNames(true);
})();
