import json
import re

import numpy as np
import PIL.Image

from tests.browser import clipped, needs_browser, obstacles
from tests.grader.cli.test_live import ONE_RUN, QUICK
from tests.programs import DEADLINE_S, Program
from tests.turtlesim_py.live.test_in_a_browser import PIXELS, pixels_of

pytestmark = needs_browser
WIDTH = 375


def test_a_person_sees_the_run_to_its_last_pixel_and_what_the_checks_say(tmp_path, browser):
    (tmp_path / "one_run.yaml").write_text(ONE_RUN)
    out = tmp_path / "out"
    words = (str(QUICK), "--live", "--speed", "free", "--out", str(out))
    given = ("run", *words, "--exercise", "one_run.yaml", "--lang", "en")
    with Program("grader", *given, cwd=tmp_path) as program:
        address = re.search(r"http://\S+", program.wait_for_line("See the runs at"))[0]
        page = browser.new_page(viewport={"width": WIDTH, "height": 900}, locale="fr-FR")
        page.set_default_timeout(DEADLINE_S * 1000)
        errors = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(address)
        page.wait_for_selector("#state:has-text('nominal run, as fast as it goes')")
        page.wait_for_selector("#state:has-text('The grading is over; what is here stays.')")
        assert program.wait() == 0
        result = json.loads((out / "result.json").read_text())
        assert page.inner_text("#grading-score") == f"Score: {result['score']:g} of 100"
        titles = page.locator("#checks strong").all_inner_texts()
        assert titles == [verdict["title"] for verdict in result["verdicts"]]
        page.evaluate("new Promise(requestAnimationFrame)")  # what has come is drawn
        pixels = pixels_of(page.evaluate(f"({PIXELS})()"))
        with PIL.Image.open(out / "canvas.png") as picture:
            expected = np.asarray(picture.convert("RGB"))
        assert np.array_equal(pixels[..., :3], expected)
        for what in ("#controls", "#keys", "#graph"):  # nothing that would drive
            assert page.locator(what).is_hidden()
        assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH
        assert clipped(page) == {}
        assert obstacles(page) == []
        assert errors == []
        page.close()
