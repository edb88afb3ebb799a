"""What a look at a student's source shows, and what it is silent about."""

import ast
import re
from pathlib import Path

import pytest
import yaml

from grader.recording.observations import LintFinding, SourceLine
from grader.run.opening import open_submission
from grader_diagnosis.lint import lint
from tests.hand_ins import SUBMISSIONS

TUTORIALS = SUBMISSIONS / "tutorials"
SETUP = """from setuptools import setup
setup(name="spiral", entry_points={"console_scripts": ["draw = spiral.draw:main"]})
"""
CASES = yaml.safe_load(Path(__file__).with_name("lint.yaml").read_text(encoding="utf-8"))
PAGE = Path(__file__).parents[3] / "docs" / "lint-findings.md"
KINDS = set(re.findall(r"^\| `(\w+)` \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
#: What only gives a place to something that a run has shown.
PLACES = {
    *("sets", "constant", "never_read", "never_set", "no_super", "imports", "at_wall", "at_middle"),
    *("argument", "stays", "waits", "same_colour", "cancels", "grows", "holds", "zero", "ends"),
    "no_return",
}


def found_in(sources):
    found = lint.find(lint.parsed_of(sources), sources, lambda _: False)
    assert {finding[0] for _, finding in found} <= KINDS
    return [LintFinding(*each[:3], SourceLine(file, each[3])) for file, each in found]


def reported(sources):
    return [each for each in found_in(sources) if each.kind not in PLACES]


@pytest.mark.parametrize("name", CASES["found"])
def test_a_slip_is_found_with_its_line(name):
    case = CASES["found"][name]
    found = [[s.kind, s.name, s.near, s.place.line] for s in reported({"a.py": case["source"]})]
    assert found == [case["finding"]]


@pytest.mark.parametrize("case", CASES["placed"], ids=lambda case: case["finding"][0])
def test_what_is_wrong_only_where_a_run_shows_it_is_found_with_its_line(case):
    found = [[s.kind, s.name, s.place.line] for s in found_in({"a.py": case["source"]})]
    assert case["finding"] in found


@pytest.mark.parametrize("name", CASES["nothing"])
def test_what_may_be_meant_is_no_slip(name):
    assert reported({"a.py": CASES["nothing"][name]}) == []


def test_in_the_right_programs_of_tutorials_nothing_is_blamed():
    blamed = {"uncalled", "unused", "local", "unread", "no_effect", "unspun", "unanswered", "quiet"}
    programs = [*TUTORIALS.glob("*/right/*.py"), *TUTORIALS.glob("*/with_form/*.py")]
    assert len(programs) > 60
    for path in programs:
        assert not blamed & {each.kind for each in lint.lint(path.parent, [path])}, path


def test_what_one_file_sets_another_may_read():
    base = "class Base:\n    def go(self):\n        return self.stoped\n"
    source = "class Controller(Base):\n    def on_pose(self, pose):\n        self.stoped = True\n"
    assert reported({"a.py": source, "b.py": base}) == []


COLOURS = "from .node import Node\nRED = (255, 0, 0)\ndef red(): print(RED)\n"
TOLD = {
    "a name that a module of one's own lacks": (
        {"s/node.py": "from s.colours import GREEN, RED\nclass Node: pass\n"},
        [
            ("circular", "s/node.py", "unused", "s/colours.py", 1),
            ("not_defined", "GREEN", "RED, red", "s/node.py", 1),
            ("circular", "s/colours.py", "unused", "s/node.py", 1),
        ],
    ),
    "a name that is spelt otherwise": (
        {"s/draw.py": "from .colours import REDS\n", "s/node.py": "Node = 1\n"},
        [("not_defined", "REDS", "RED", "s/draw.py", 1)],
    ),
    "a function of another file that returns nothing": (
        {"s/draw.py": "from s.colours import red\nr = red()\n", "s/node.py": "Node = 1\n"},
        [("no_return", "r", "red", "s/colours.py", 3)],
    ),
    "what is there": (
        {"s/node.py": "from s import colours, walls\nNode = 1\n", "s/walls/a.py": "", "s/b.py": ""},
        [],
    ),
}


@pytest.mark.parametrize("name", TOLD)
def test_what_the_files_of_a_package_show_together_is_found(name):
    files, wanted = TOLD[name]
    found = found_in({"s/__init__.py": "", "s/colours.py": COLOURS, **files})
    kinds = ("not_defined", "circular", "no_return")
    told = [(s.kind, s.name, s.near, s.place.file, s.place.line) for s in found if s.kind in kinds]
    assert told == wanted


def test_what_a_package_shows_is_found_where_it_is_read(tmp_path):
    package = tmp_path / "spiral"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "pens.py").touch()
    (tmp_path / "setup.py").write_text(SETUP)
    source = "import math\nimport pens\n\ndef main():\n    print(pens)\n    main\n"
    (package / "draw.py").write_text(source)
    with open_submission(tmp_path) as submission:
        assert submission.lint_findings == (
            LintFinding("uncalled", "main", "", SourceLine("spiral/draw.py", 6, "", "main")),
            LintFinding(
                "beside", "pens", "spiral.pens", SourceLine("spiral/draw.py", 2, "", "import pens")
            ),
        )


LONG = f"0x{'f' * 6000}"  # Python reads it, and does not write it in decimals


@pytest.mark.parametrize(
    "source",
    [
        *("draw({[5]: 1})\n", "pen.r = {[5]: 1}\n", "pen(1e999, 2, 3)\npen(1e999, 2, 3)\n"),
        *(f"pen({LONG}, 0, 0)\npen({LONG}, 0, 0)\n", f"pen.r = {LONG}\n", f"speed == {LONG}\n"),
        *(f"{LONG}\n", f"pen({LONG}).r = 1\n", f"pen({'9' * 400}, 0, 0)\n"),
    ],
    ids=lambda source: source[:12],
)
def test_a_value_that_python_refuses_or_does_not_write_is_no_failure_of_ours(tmp_path, source):
    file = tmp_path / "draw.py"
    file.write_text(source)
    with open_submission(file) as submission:
        assert submission.found


def test_twice_the_source_takes_about_twice_the_steps(monkeypatch):
    steps = 0
    children = ast.iter_child_nodes

    def counted(node):
        nonlocal steps
        steps += 1
        return children(node)

    monkeypatch.setattr(ast, "iter_child_nodes", counted)
    taken = []
    for functions in (40, 80):
        steps = 0
        bodies = (f"def f{i}():\n    a = P()\n    m = Twist()\n" for i in range(functions))
        head = "from geometry_msgs.msg import Twist\nclass P(Node):\n    pass\n"
        found_in({"a.py": head + "".join(bodies)})
        taken.append(steps)
    assert taken[1] < 2.5 * taken[0]


def test_a_file_that_nobody_looks_through_is_started_all_the_same(tmp_path):
    deep = tmp_path / "draw.py"
    deep.write_text("main\n" * (lint.MOST_SOURCE // 5 + 1))
    with open_submission(deep) as submission:
        assert submission.lint_findings == ()
