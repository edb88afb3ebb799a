"""A mistake in a scene of somebody else's is that scene's, never the submission's."""

import json
import shutil
import subprocess
from functools import partial
from pathlib import Path

import pytest

from grader.errors import SceneFailure
from grader.recording import subject
from grader.scenes.scene import Scene, expect_reason
from tests import once
from tests.docs.test_examples import BLINKING, ROOT, environment_with, run_examples
from tests.tiers import others_are_more

pytestmark = pytest.mark.timeout(300)

#: The scene of the page, and its mistakes: an entry point each.
MISTAKES = '''
import time

import numpy as np
from grader.text.message import msg
from grader.recording.subject import Endpoint, Start
from grader.scenes.view import Curve, View
from grader.recording.subject import Pictures
from lamp import BOOL, TOPIC, Lamp, LampSimulation, LampTrace


def scene(name, **members):
    """Make a lamp whose simulation has other members."""
    simulation = type("Other", (LampSimulation,), members)
    simulate = lambda self, limits, *_: simulation(limits)
    return type("Other", (Lamp,), {"name": name, "simulate": simulate})()


def fails(self, *_):
    raise ZeroDivisionError("no lamp has this")


def tick(self, now_ns=None):
    LampSimulation.tick(self, now_ns)
    return self.returned


ticks = scene("ticks", tick=fails)
traces = scene("traces", trace=fails)
nothing = scene("nothing", tick=tick, returned=None)
reads = type("Reads", (Lamp,), {"name": "reads", "from_channels": fails})()


def leaves(self, *_):
    raise SystemExit(0)


def forgets(self, channels, duration_ns):
    return Lamp.from_channels(self, [], duration_ns)


exits = scene("exits", tick=leaves)
loses = type("Loses", (Lamp,), {"name": "loses", "from_channels": forgets})()
misnamed = scene("lamp")


def hashes(self):
    """Make the simulation of a lamp whose trace has no hash."""
    trace = LampSimulation.trace(self)
    return type("Other", (type(trace),), {"sha256": fails})(trace.ticks, trace.switched)


def sleeps(self, *_):
    time.sleep(1e6)


sleeps = scene("sleeps", tick=sleeps)
sha256 = scene("sha256", trace=hashes)


class Bright(Lamp):
    """A lamp without mistakes, and with more than a scene must have."""

    name, farthest_start_m = "bright", 2.0

    def view(self, trace):
        table = np.array(trace.switched, float).reshape(-1, 2)
        return View(curves=(Curve(msg("lamp"), "on", table[:, 0].astype(np.int64), table[:, 1]),))

    def pictures(self, trace):
        return Pictures(np.full((200, 200, 3), 255 * bool(trace.switched), np.uint8))

    def starts(self, count, seed, nearest_m, farthest_m):
        chance = np.random.default_rng(seed)
        return [Start(float(x), 0.0, 0.0) for x in chance.uniform(nearest_m, farthest_m, count)]

    def odd_traces(self, setting, start):
        return {"nothing": LampTrace(0), "never off": LampTrace(9, ((1, True), (9, True)))}

    def endpoints(self, trace, interfaces):
        return (Endpoint("subscription", TOPIC, BOOL),)


bright = Bright()
'''
RAISED = "ZeroDivisionError: no lamp has this"
SENTENCES = {
    "ticks": f"the scene ticks raised {RAISED} (mistakes.py, line ",
    "traces": f"the scene traces raised {RAISED} (mistakes.py, line ",
    "reads": f"the simulator left no recording: {RAISED}",
    "exits": "the scene exits raised SystemExit: 0 (mistakes.py, line ",
    "loses": "left no recording: ValueError: from_channels() gives back another sha256()",
    "nothing": "the scene nothing returned None, expected one of '', 'rest', ",
    "sleeps": "the scene sleeps raised Overdue: it did not return (mistakes.py, line ",
    "sha256": f"the scene sha256 raised {RAISED} (mistakes.py, line ",
}
NAMES = (*SENTENCES, "misnamed", "bright")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Give a folder with a node, the lamp of the page and, for each mistake, an exercise in it."""
    sources = (__file__, ROOT / "tests/docs/test_examples.py", ROOT / "docs/write-a-scene.md")
    made = once.folder(make, [Path(source).read_text(encoding="utf-8") for source in sources])
    return shutil.copytree(made, tmp_path_factory.mktemp("scenes") / "own", symlinks=True)


def make(folder):
    run_examples("write-a-scene.md", folder)
    lamp = folder / "lamp"
    (lamp / "mistakes.py").write_text(MISTAKES)
    project = (lamp / "pyproject.toml").read_text().replace('"lamp"]', '"lamp", "mistakes"]')
    points = "".join(f'{name} = "mistakes:{name}"\n' for name in NAMES)
    (lamp / "pyproject.toml").write_text(
        project.replace('lamp = "lamp:SCENE"\n', f'lamp = "lamp:SCENE"\n{points}')
    )
    blink = (lamp / "blink" / "exercise.yaml").read_text()
    for name in NAMES:
        exercise = folder / name
        exercise.mkdir()
        (exercise / "exercise.yaml").write_text(blink.replace("scene: lamp", f"scene: {name}"))
        (exercise / "checks.py").write_bytes((lamp / "blink" / "checks.py").read_bytes())
    (folder / "node.py").write_text(BLINKING)
    environment_with(lamp, folder / "venv")


def run(folder, name, *more):
    out = f"out_{Path(name).name}"
    words = ["-m", "grader", "run", "node.py", "--exercise", name, "--out", out, *more]
    python = str(folder / "venv" / "bin" / "python")
    done = subprocess.run(
        [python, *words], cwd=folder, check=False, stderr=subprocess.PIPE, text=True
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("hook", subject.HOOKS)
def test_what_a_hook_may_not_raise_is_told_as_the_scene_s(hook):
    def fails(_, error):
        raise error

    scene = type("Other", (Scene,), {"name": "other", hook: fails})
    call = partial(getattr(scene, hook), scene)
    said = rf"the scene other raised {RAISED} \(test_a_scene_of_others\.py, line \d+\)"
    with pytest.raises(SceneFailure, match=said):
        call(ZeroDivisionError("no lamp has this"))
    for allowed in subject.HOOKS[hook]:
        with pytest.raises(allowed):
            call(allowed("a mistake"))


@pytest.mark.parametrize(
    "name",
    others_are_more("a grading each; the hooks are called one by one, too", SENTENCES, "ticks"),
)
def test_a_mistake_of_a_scene_is_told_as_that_scene_s(folder, name):
    code, told = run(folder, name)
    assert code == 3, told
    assert "The grader failed; this is not the submission's fault: " in told
    assert SENTENCES[name] in told
    assert not (folder / f"out_{name}" / "result.json").exists()


def test_a_reason_that_there_is_not_is_told_as_the_scene_s():
    for reason in (None, "enough"):
        with pytest.raises(SceneFailure, match=f"the scene other returned {reason!r}, expected"):
            expect_reason("other", reason)
    assert expect_reason("other", "rest") == "rest"


@pytest.mark.more("in virtual time the same")
def test_a_mistake_of_a_scene_is_told_in_real_time_too(folder):
    code, told = run(folder, "nothing", "--time", "real")
    assert code == 3, told
    assert SENTENCES["nothing"] in told


def test_a_scene_has_the_name_of_its_entry_point(folder):
    code, told = run(folder, "misnamed")
    assert code == 2, told
    assert "'misnamed' is of mistakes:misnamed of lamp, whose name is 'lamp'" in told


def test_a_scene_may_have_more_than_it_must(folder):
    exercise = folder / "bright" / "exercise.yaml"
    varied = "varied_runs: {count: 1, seed: 1, nearest_m: 1, farthest_m: 2}\n"
    exercise.write_text(exercise.read_text() + varied)
    code, told = run(folder, "bright")
    out = folder / "out_bright"
    result = json.loads((out / "result.json").read_text())
    assert (code, result["score"], result["run"]["outcome"]) == (0, 7.5, "finished"), told
    assert 1 <= result["varied_runs"][0]["start"]["x"] <= 2
    assert (out / "canvas.png").exists()
    python = str(folder / "venv" / "bin" / "python")
    asks = "from grader.testing import check_scene as c; print(c('bright'), c('lamp'))"
    done = subprocess.run([python, "-c", asks], capture_output=True, text=True, check=True)
    assert done.stdout == "[] []\n"
    (out / "result.json").unlink()
    words = ["-m", "grader", "check", "out_bright", "--exercise", "bright"]
    done = subprocess.run([python, *words], cwd=folder, capture_output=True, text=True, check=True)
    assert "No result is written: no result.json of this recording lies beside it." in done.stderr
    assert not (out / "result.json").exists()


def test_a_sheet_leaves_out_what_a_scene_does_not_say(folder):
    python = str(folder / "venv" / "bin" / "python")
    words = ["-m", "grader", "new", "begin", "--exercise", "lamp/blink"]
    subprocess.run([python, *words], cwd=folder, check=True)
    (sheet,) = [p for p in (folder / "begin").rglob("*.md") if "blink" in p.read_text()]
    assert "How to try it" not in sheet.read_text()
    assert "rested" not in sheet.read_text()
