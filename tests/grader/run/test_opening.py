"""What is evaluated of a package before it is started can forge nothing but its own facts."""

from pathlib import Path

import pytest
import yaml

from grader.errors import SubmissionError
from grader.exercise.building import NO_LIMITS
from grader.run import inspecting
from grader.run.handover import Plan
from grader.run.limits import CpuBudget
from grader.run.opening import open_submission
from grader.submission.answer import Inspection, decode
from grader.submission.package_trace import encode
from grader.submission.program import EntryPoint, Script
from grader.submission.request import Request
from grader.submission.start import Submission
from tests.files import lay
from tests.grader.submission.test_entry_points import SETUP, package
from tests.tiers import others_are_more

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

KILLS = "import os, signal\nos.kill(os.getppid(), signal.SIGKILL)\n"


def found_in(path: Path, executable: str | None = None) -> Submission:
    with open_submission(path, executable) as submission:
        return submission


def with_set_up(before: str, name: str = "spiral") -> dict[str, str]:
    """A package whose set-up does something else before."""
    files = package(name)
    return files | {"setup.py": f"{before}\n{files['setup.py']}"}


def two(folder: Path, before: str) -> Path:
    """An honest package, beside one whose set-up is evaluated first."""
    files = with_set_up(before, "first")
    files["setup.py"] = files["setup.py"].replace("turtle_controller =", "other =")
    for name, each in (("first", files), ("second", package("second"))):
        lay(folder / "ws" / name, each)
    return folder / "ws"


#: What it does -> what it does it by.
HOSTILE = [
    ("writes wherever it can", TEXTS["forges"]),
    ("spoils the module json", "import json\njson.loads = json.dumps = None"),
    (
        "spoils the inspection",
        "from grader.submission.examining import main, setup_call, steps\n"
        "main.inspect = setup_call.evaluate = steps.step = lambda *_, **__: None",
    ),
    ("ends without a word", "import os\nos._exit(0)"),
    ("answers twice", "import os\nos.fork()"),
]


@pytest.mark.parametrize(
    ("does", "before"),
    others_are_more("two stand for the others", HOSTILE, HOSTILE[0][0], HOSTILE[2][0]),
)
def test_a_set_up_says_nothing_of_another_one(tmp_path, does, before):
    submission = found_in(two(tmp_path, before))
    assert submission.entry == EntryPoint("second.turtle_controller", "main")
    assert str(submission.found) == "console script turtle_controller in second/setup.py"


def test_a_set_up_that_kills_who_inspects_is_found_by_its_files(tmp_path):
    submission = found_in(lay(tmp_path, with_set_up(KILLS)))
    assert submission.entry == EntryPoint("spiral.turtle_controller", "main")
    assert str(submission.notes[0]).startswith("the process that looked at the package left noth")


@pytest.mark.more("it waits as long as the inspection does")
def test_a_set_up_that_never_ends_is_ended_and_told(tmp_path):
    submission = found_in(lay(tmp_path, with_set_up("import time\ntime.sleep(1e6)")))
    assert submission.entry == EntryPoint("spiral.turtle_controller", "main")
    assert str(submission.notes[0]) == (
        "colcon would not build this: setup.py waited for what did not come"
    )


TARGETS = ("os:system", "json.tool:main", "..bob.node:main", "bob.node:main")


@pytest.mark.parametrize(
    "target", others_are_more("as these", TARGETS, "os:system", "bob.node:main")
)
def test_a_script_that_is_claimed_is_none_of_another_place(tmp_path, target):
    lay(tmp_path, {"bob/node.py": "def main():\n    pass\n"})
    entries = repr(f"turtle_controller = {target}")
    setup = SETUP.format(package="spiral", entries=entries).replace(
        "name=", "package_dir={'': '..'}, name="
    )
    with pytest.raises(SubmissionError, match=r"but there is no file|has the console script"):
        found_in(lay(tmp_path / "spiral", package("spiral") | {"setup.py": setup}))


def test_a_launch_file_says_nothing_of_set_ups(tmp_path):
    files = package("spiral") | {"launch/a.launch.py": TEXTS["forges"]}
    submission = found_in(lay(tmp_path, files))
    assert submission.entry == EntryPoint("spiral.turtle_controller", "main")
    assert "a.launch.py was not run, and what it starts cannot be read" in str(submission.notes[-1])


def test_what_a_set_up_writes_is_gone_with_the_inspection(tmp_path):
    write = "import pathlib\npathlib.Path('spiral/turtle_controller.py').write_text('1 / 0')"
    with open_submission(lay(tmp_path, with_set_up(write))) as submission:
        read = (submission.root / "spiral/turtle_controller.py").read_text()
        assert "1 / 0" not in read
    assert "1 / 0" not in (tmp_path / "spiral/turtle_controller.py").read_text()


def test_an_answer_about_other_folders_is_none(tmp_path, monkeypatch):
    with open_submission(lay(tmp_path, package("spiral"))) as found:
        whole = Submission("a", found.copy.folder, (), "", copy=found.copy)
        asked = (whole, ["."], Request(), CpuBudget())
        said, _ = inspecting.inspect(*asked)
        assert [each.told.name for each in said.set_ups] == ["spiral"]
        monkeypatch.setattr(inspecting.answer, "decode", lambda _: Inspection())
        said, _ = inspecting.inspect(*asked)
        assert [(each.folder, each.told.name) for each in said.set_ups] == [(".", "")]


def test_only_what_has_the_form_of_an_inspection_is_one():
    assert decode(encode(Inspection())) == Inspection()
    for forged in (b"{}", b"[]", b'{"set_ups": []}', encode(Inspection())[:-1]):
        with pytest.raises(ValueError, match=r"."):
            decode(forged)


def test_a_single_file_is_not_inspected(tmp_path, monkeypatch):
    def fail(*_: object, **__: object) -> None:
        raise AssertionError

    monkeypatch.setattr(inspecting, "inspect", fail)
    lay(tmp_path, {"node.py": "print(1)\n", "setup.py": "1 / 0\n"})
    start = found_in(tmp_path / "node.py").entry
    assert isinstance(start, Script)
    assert start.path.name == "node.py"


def test_one_look_serves_the_start_and_the_exercise(tmp_path):
    lay(tmp_path, package("spiral"))
    with open_submission(tmp_path, inspections=()) as submission:
        assert submission.seen is not None
        trace, remarks = inspecting.inspect_beside(
            submission, Plan(NO_LIMITS, budget=CpuBudget(0.0))
        )
        assert (trace, remarks) == (submission.seen, ())
        again, _ = inspecting.inspect_beside(
            Submission(**{**vars(submission), "seen": None}), Plan(NO_LIMITS)
        )
        assert again == trace
    with open_submission(tmp_path) as submission:
        assert submission.seen is None
