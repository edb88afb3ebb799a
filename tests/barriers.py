"""What of WCAG 2.2, levels A and AA, a browser can be asked about a page.

The tests that ask it are those that docs/accessibility.md points at.
"""

from typing import Any

from tests.browser import cut_off, moving, obstacles

#: A narrow screen, as one of 1280 at 400 % is, and a desk, where it is dark [px].
SCREENS = ((320, 512, "light"), (1280, 800, "dark"))
#: 1.4.12: what a reader may set of lines, letters, words and paragraphs.
_SPACED = """
() => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(`
    * { line-height: 1.5 !important; letter-spacing: .12em !important; }
    * { word-spacing: .16em !important; }
    p { margin-bottom: 2em !important; }
  `);
  document.adoptedStyleSheets = [sheet];
}
"""
#: Texts of which a part is hidden, but for what is kept for screen readers alone.
_CUT_TEXT = """
() => [...document.querySelectorAll("body *")].filter((part) => {
  const { overflowX, overflowY } = getComputedStyle(part);
  const hides = (how) => how === "hidden" || how === "clip";
  return part.checkVisibility() && part.clientWidth > 1 && !part.closest("[aria-hidden=true], svg")
    && (hides(overflowX) && part.scrollWidth > part.clientWidth + 1
      || hides(overflowY) && part.scrollHeight > part.clientHeight + 1);
}).map((part) => part.outerHTML.slice(0, 90))
"""
_COLOURS = """
  const parts = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const light = (colour) => parts(colour).slice(0, 3).map((v) => v / 255)
    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, n) => sum + v * [0.2126, 0.7152, 0.0722][n], 0);
  const contrast = (one, other) => {
    const [high, low] = [light(one), light(other)].sort((a, b) => b - a);
    return (high + 0.05) / (low + 0.05);
  };
  const ground = (part) => {
    for (let at = part; at; at = at.parentElement) {
      const { backgroundColor } = getComputedStyle(at);
      if ((parts(backgroundColor)[3] ?? 1) === 1) return backgroundColor;
    }
    return "rgb(255, 255, 255)";
  };
"""
#: 1.4.11: fields whose edge and ground are both like what is around them.
_FAINT = f"""
() => {{
  {_COLOURS}
  const fields = "input:is([type=text], [type=number], [type=search]), select, textarea";
  return [...document.querySelectorAll(fields)].filter((field) => field.checkVisibility())
    .filter((field) => {{
      const around = ground(field.parentElement);
      const {{ borderTopColor }} = getComputedStyle(field);
      return Math.max(contrast(borderTopColor, around), contrast(ground(field), around)) < 3;
    }}).map((field) => field.outerHTML.slice(0, 90));
}}
"""
#: Marks what Tab has to come to, and tells how many these are.
_TO_REACH = """
() => [
  ...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]"),
].filter((part) => part.tabIndex >= 0 && !part.disabled && !part.closest("[inert]")
    && part.checkVisibility({ visibilityProperty: true }))
  .map((part, n) => { part.dataset.stop = n; return part.outerHTML.slice(0, 90); })
"""
#: Where the focus is: its number, and what is wrong there. A pin draws its own ring.
_STOP = f"""
() => {{
  {_COLOURS}
  const at = document.activeElement;
  if (!at || at === document.body) return null;
  const style = getComputedStyle(at), ring = at.querySelector(".ring");
  const drawn = ring ? getComputedStyle(ring).visibility === "visible"
    : style.outlineStyle === "auto"
      || style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2
        && contrast(style.outlineColor, ground(at.parentElement)) >= 3;
  const {{ left, top, width, height }} = at.getBoundingClientRect();
  const within = (value, end) => Math.max(0, Math.min(value, end - 1));
  const over = document.elementFromPoint(
    within(left + width / 2, innerWidth), within(top + height / 2, innerHeight),
  );
  const seen = over && (at.contains(over) || over.contains(at));
  const wrong = [...drawn ? [] : ["no focus seen"], ...seen ? [] : ["covered"]];
  return [Number(at.dataset.stop ?? -1), wrong];
}}
"""


def barriers(page: Any) -> list[str]:
    """What keeps somebody from using a page that is open: by rules, by reflow, by keyboard.

    The page has to be one of a browser that asks for less motion.
    """
    found = []
    for width, height, scheme in SCREENS:
        page.set_viewport_size({"width": width, "height": height})
        page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        found += [f"{scheme}: {each}" for each in obstacles(page)]
        found += [f"{scheme}, faint: {each}" for each in page.evaluate(_FAINT)]
        found += [f"{width} px, {each}" for each in (*_too_wide(page), *_stops(page))]
        if moving(page):
            found.append("it moves, where less motion is asked for")
    page.evaluate(_SPACED)
    for width, height, _ in SCREENS:
        page.set_viewport_size({"width": width, "height": height})
        found += [f"spaced, {width} px, {each}" for each in _too_wide(page)]
        found += [f"spaced, {width} px, cut: {each}" for each in page.evaluate(_CUT_TEXT)]
    page.evaluate("document.adoptedStyleSheets = []")
    return found


def _too_wide(page: Any) -> list[str]:
    width = page.evaluate("innerWidth")
    is_wide = page.evaluate("document.documentElement.scrollWidth") > width
    return [*["it scrolls sideways"] * is_wide, *(f"beyond: {each}" for each in cut_off(page))]


def _stops(page: Any) -> list[str]:
    """Go by Tab alone through all controls, and back; one that keeps the focus lacks the others."""
    controls = page.evaluate(_TO_REACH)
    found = []
    for key in ("Tab", "Shift+Tab"):
        wrong = dict[int, list[str]]()
        for _ in range(2 * len(controls) + 20):  # from wherever it is; what scrolls is a stop, too
            page.keyboard.press(key)
            number, why = page.evaluate(_STOP) or (-1, [])
            if number in wrong and len(wrong) == len(controls):
                break  # round, or out of the page and in again
            if number >= 0:
                wrong[number] = why
        found += [f"{key}, {why}: {controls[n]}" for n in wrong for why in wrong[n]]
        found += [f"{key} never comes to {c}" for n, c in enumerate(controls) if n not in wrong]
    return found
