"""Recordings are judged, reported and played where nothing of ROS can be imported."""

import json
import subprocess
import sys

from grader.recording.reading import scene_of
from grader.scenes.subject import load_subject
from tests import archive

#: Hides ROS from a process, and has verbs do their work in it.
PROGRAM = """
import re, sys

ROS = re.compile(r"(ament|launch|rcl|rmw|ros(?!_doubles)|tf2)\\w*|\\w+_(msgs|interfaces)|turtlesim")

class Hidden:
    def find_spec(self, name, path=None, target=None):
        if ROS.fullmatch(name.partition(".")[0]):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Hidden())

import json
from grader import cli

for words in json.loads(sys.argv[1]):
    assert cli.main(words) == 0, words
"""


def test_check_report_and_view_import_nothing_of_it(tmp_path):
    orders = []
    for name in archive.EXERCISES:
        folder, result = archive.folder(name, "right"), str(tmp_path / f"{name}.json")
        orders.append(["check", str(folder), "--exercise", name, "--json", result])
        orders.append(["report", result, "--format", "html"])
        if load_subject(scene_of(folder)).player:
            page = str(tmp_path / f"{name}.html")
            orders.append(["view", str(folder), "--no-open", "--out", page])
    command = [sys.executable, "-c", PROGRAM, json.dumps(orders)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    for name in archive.EXERCISES:
        found = json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
        assert found["score"] == found["max_score"], name
