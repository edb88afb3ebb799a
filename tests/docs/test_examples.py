"""The examples in the docs run as they stand there, one after the other, in an empty folder."""

import json
import re
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

from grader.testing import check_exercise

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"# (\S+/\S+)\n")
#: A submission for the scene of the page.
BLINKING = """
import rclpy
from std_msgs.msg import Bool

rclpy.init()
node = rclpy.create_node("blink")
publisher = node.create_publisher(Bool, "/lamp", 10)
states = [True, False] * 3
node.create_timer(0.5, lambda: states and publisher.publish(Bool(data=states.pop())))
rclpy.spin(node)
"""


def run_examples(page, folder):
    """Write what names a file, run the rest; what the code has left behind."""
    left = {}
    blocks = BLOCK.findall((ROOT / "docs" / page).read_text(encoding="utf-8"))
    for _, text in blocks:
        if named := FILE.match(text):
            path = folder / named[1]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
    for language, text in blocks:
        if language == "python" and not FILE.match(text):
            exec(compile(text, page, "exec"), left)
    return left


def test_an_exercise_can_be_written_as_the_page_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run_examples("write-an-exercise.md", tmp_path)["result"].exercise == "corner"
    shown = capsys.readouterr().out.strip()
    assert f"# {shown}\n" in (ROOT / "docs" / "write-an-exercise.md").read_text(encoding="utf-8")
    assert not list(tmp_path.rglob("*.pyc"))


@pytest.mark.more("check_exercise has tests of its own: a grading for each solution")
def test_the_exercise_of_the_page_stands_its_check(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run_examples("write-an-exercise.md", tmp_path)
    found = check_exercise("./corner")
    assert [str(problem) for problem in found.problems] == []
    assert found.catches == {"moves": ("says_nothing",), "arrives": ("stops_too_early",)}


def environment_with(package, folder):
    """The Python of an environment that has all of ours, and a package more."""
    venv.create(folder, symlinks=True)
    python = folder / "bin" / "python"
    site = next(folder.glob("lib/python*/site-packages"))
    ours = [
        f"import site; site.addsitedir({path!r})" for path in sys.path if "site-packages" in path
    ]
    (site / "ours.pth").write_text("\n".join([str(ROOT), *ours]))
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "-q", "--no-deps"]
    subprocess.run([*pip, "--no-build-isolation", str(package)], check=True)
    return python


@pytest.mark.more("test_a_scene_of_others.py has another one: an environment, and two gradings")
def test_a_scene_can_be_written_as_the_page_says(tmp_path):
    run_examples("write-a-scene.md", tmp_path)
    scene = (tmp_path / "lamp" / "lamp.py").read_text(encoding="utf-8")
    assert len(scene.splitlines()) <= 100
    (tmp_path / "node.py").write_text(BLINKING)
    python = environment_with(tmp_path / "lamp", tmp_path / "venv")
    hashes = set()
    for verb in (["run", "node.py", "--out", "out"], ["check", "out"]):
        grader_ = [str(python), "-m", "grader", *verb, "--exercise", "lamp/blink"]
        subprocess.run(grader_, cwd=tmp_path, check=True)
        result = json.loads((tmp_path / "out" / "result.json").read_text())
        assert result["verdicts"][0]["rationale"] == "It went on 3 times."
        assert (result["score"], result["run"]["outcome"]) == (7.5, "finished")
        assert result["artifacts"] == {"recording": "recording", "output": "output.txt"}
        hashes.add(result["run"]["trace_sha256"])
    assert len(hashes) == 1


@pytest.mark.more("test_grading.py calls the same functions: three gradings")
def test_the_api_can_be_used_as_the_page_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    quick = ROOT / "tests" / "submissions" / "quick_spiral.py"
    shutil.copy(quick, tmp_path / "turtle_controller.py")
    left = run_examples("python-api.md", tmp_path)
    assert left["result"].score == left["again"].score == 100
    shown = capsys.readouterr().out.splitlines()
    assert shown[0] == "turtle_controller.py: 100 of 100 points"
    assert shown[1].startswith("passed: The node starts and moves turtle1. ")
    assert shown[-1].startswith("{'turtle_controller.py': 100.0, 'no_such_file.py': ")
