"""scripts/size.py: what it counts, and what it finds in a project of a few files."""

import subprocess
import sys
from pathlib import Path

from tests.files import lay
from tests.programs import ran

SCRIPT = Path(__file__).parents[2] / "scripts" / "size.py"
FILES = {
    "grader/__init__.py": "from grader.run.run import Run\n",
    "grader/errors.py": "class Fault:\n    pass\n",
    "grader/run/__init__.py": "",
    "grader/run/run.py": "from ..errors import Fault\n\n\nclass Run:\n    pass\n",
    "grader_class/pages.py": "from grader import errors\nfrom grader.cli.main import go\n",
    "grader/cli/main.py": (
        "def go():\n    from grader_class import pages\n    import grader_class.pages\n"
    ),
    "grader/exercises/square/reference/square.py": "class Run:\n    pass\n",
    "tf2/tf2_py/geometry.py": "class Pose:\n    pass\n",
    "world/turtle.py": (
        "import tf2_py.geometry\n\n\nclass Pose:\n    pass\n\n\nclass Run:\n    pass\n"
    ),
    "tests/test_all.py": "import grader\n\n\nclass Run:\n    pass\n",
}


def test_what_git_tracks_of_the_product_is_counted_and_class_names_that_stand_twice_are_shown(
    tmp_path,
):
    folder = lay(tmp_path, FILES)
    subprocess.run(["git", "init", "-q"], cwd=folder, check=True)
    subprocess.run(["git", "add", "."], cwd=folder, check=True)
    (folder / "untracked.py").write_text("class Run:\n    pass\n")
    command = [sys.executable, str(SCRIPT), str(folder)]
    printed = ran(command, check=True).stdout
    counts = {row.split()[0]: row.split()[1:] for row in printed.splitlines()[1:9]}
    assert counts == {
        "all": ["24", "8"],
        "core": ["11", "5"],
        "grader": ["3", "2"],
        "grader_class": ["2", "1"],
        "grader/cli": ["3", "1"],
        "grader/run": ["5", "2"],
        "tf2": ["2", "1"],
        "world": ["9", "1"],
    }
    assert "class names in several modules: 1\n" in printed
    assert "  Run: grader/run/run.py, world/turtle.py\n" in printed
    assert "doubles of ROS's API besides: Pose\n" in printed
