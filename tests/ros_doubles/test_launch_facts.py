"""Launch files of many constructs start what ROS's own launch has started, or are refused as by it.

launch_facts.yaml is what launch 3.4.3 and launch_ros 0.26.6 (Jazzy) made of each: the names that
`ros2 launch` prints, and when [s]; the n-th program has ended 1000 n seconds after its start.
`otherwise` says where the grader differs, and why; `later` what later releases have.
"""

import re
import textwrap
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from grader.submission.answer import LaunchOrder
from grader.submission.package_trace import LaunchFile
from grader.submission.program import Program
from ros_doubles.frontend_substitutions import has_later
from ros_doubles.launch_time import NEVER
from tests.files import lay
from tests.inspecting import inspected

FACTS = yaml.safe_load(Path(__file__).with_name("launch_facts.yaml").read_text(encoding="utf-8"))
CASES = FACTS["cases"]
#: So many launch files of a package are looked at.
MOST = 30
HEAD = FACTS["head"] + "\n\ndef generate_launch_description():\n"
END_S = 1000.0


def written(case: dict[str, str]) -> tuple[str, str]:
    """How a launch file ends, and its text."""
    kind = next(each for each in ("py", "xml", "yaml") if each in case)
    body = case[kind]
    if kind == "yaml":
        return kind, f"launch:\n{textwrap.indent(body, '  ')}"
    if kind == "xml":
        return kind, body if body.startswith(("<launch", "<node>")) else f"<launch>{body}</launch>"
    if "def generate_launch_description" in body:
        return kind, body
    if not re.search("^ *return", body, re.MULTILINE):
        body = f"return LaunchDescription([{body.strip()}])"
    return kind, HEAD + textwrap.indent(body, "    ")


def file_of(name: str) -> str:
    number, (kind, _) = [*CASES].index(name), written(CASES[name])
    return CASES[name].get("file") or f"launch/c{number:03}.launch.{kind}"


@cache
def look(part: int, folder: Path) -> dict[str, tuple[LaunchFile, LaunchOrder]]:
    """All launch files of one package."""
    names = [*CASES][part * MOST : (part + 1) * MOST]
    files = {file_of(name): written(CASES[name])[1] for name in names}
    root = lay(folder / str(part), {f"demo/{f}": t for f, t in (FACTS["files"] | files).items()})
    found = inspected(root, set_ups=["demo"], inspectors=None)
    return {each.file: (each, found.orders.get(each.file)) for each in found.trace.launches}


def described(at_s: float, start: Program) -> dict[str, Any]:
    """A program, as the facts have it: what is empty is left out."""
    told: dict[str, Any] = {"name": start.name, "at": at_s}
    if not start.package:  # without the folder of the program
        return told | {"command": re.sub(r"^\S*/", "", start.executable)}
    words = start.arguments
    own = words.index("--ros-args") if "--ros-args" in words else len(words)
    entries = iter(words[own:])
    lists: dict[str, list[str]] = {"arguments": [*words[:own]], "remappings": [], "ros": []}
    files, parameters = list[str](), dict[str, Any]()
    for word in entries:
        if word == "-p":
            name, _, value = next(entries).partition(":=")
            parameters[name] = yaml.safe_load(value)
        elif word == "-r":
            lists["remappings"].append(next(entries))
        elif word == "--params-file":
            files.append(next(entries).rpartition("/")[2])
        elif word != "--ros-args":
            lists["ros"].append(word)
    respawns = {"respawns": True} if start.respawns else {}
    of = {**lists, "parameters": parameters, "files": files}
    return told | {key: value for key, value in of.items() if value} | respawns


def in_order(order: LaunchOrder) -> Iterator[dict[str, Any]]:
    """The programs of which it is known when they start."""
    at = list[float | None]()
    for start in order.programs:
        unknown = None if start.after == NEVER else 0.0
        before = at[start.after] if start.after >= 0 else unknown
        end_s = END_S * (start.after + 1)
        at.append(None if before is None else before + end_s + start.delay_s)
    known = ((s, start) for s, start in zip(at, order.programs, strict=True) if s is not None)
    for at_s, start in sorted(known, key=lambda each: each[0]):
        yield described(at_s, start)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("launched")


@pytest.mark.parametrize("name", CASES)
def test_a_construct_starts_what_the_original_starts_or_is_refused(name, folder):
    case = CASES[name]
    if case.get("later") and has_later():
        pytest.skip("this release of ROS has it")
    launch, order = look([*CASES].index(name) // MOST, folder)[file_of(name)]
    kind = None if launch.problem is None else launch.problem.kind
    found = [] if order is None else [*in_order(order)]
    is_refused = kind in ("error", "argument")
    is_like_it = is_refused if "refused" in case else (kind is None and found == case["starts"])
    if "otherwise" in case:
        assert not is_like_it, "no longer otherwise"
    elif "refused" in case:
        assert is_refused, (launch.problem, found)
    else:
        assert launch.problem is None
        assert found == case["starts"]
