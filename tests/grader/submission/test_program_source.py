"""What a submission imports is read, and told apart: in any case, or only perhaps."""

import pytest

from grader.submission.program import EntryPoint, Program, Script
from grader.submission.program_source import read_imports
from grader.submission.start import Imports
from tests.files import lay


def of_file(folder, text):
    lay(folder, {"node.py": text})
    return of_entry(folder, Script(folder / "node.py"))


def of_entry(folder, entry):
    return read_imports(folder, [Program("node-1", "", "node", entry, folder)])


@pytest.mark.parametrize(
    ("text", "is_sure"),
    [
        ("import older.msg", True),
        ("import os, older.msg as messages", True),
        ("from older.msg import *", True),
        ("class Node:\n    from older.msg import Pose", True),
        ("with open(__file__):\n    import older", True),
        ("if ready:\n    from older.msg import Pose", False),
        ("try:\n    import older\nfinally:\n    pass", False),
        ("match a:\n    case 1:\n        import older", False),
        ("class Node:\n    def drive(self):\n        import older", False),
    ],
)
def test_an_import_that_is_always_made_is_sure_and_another_is_not(tmp_path, text, is_sure):
    found = of_file(tmp_path, text)
    assert ("older" in found.surely, "older" in found.perhaps) == (is_sure, not is_sure)


def test_what_is_no_import_is_none(tmp_path):
    text = "import importlib\nimportlib.import_module('older')\n# import older\n'import older'\n"
    assert of_file(tmp_path, text) == Imports({"importlib": "node.py, line 1"})


def test_fallbacks_stand_in_their_order(tmp_path):
    text = "try:\n    from newer.msg import Pose\nexcept ImportError:\n    import older"
    found = of_file(tmp_path, text)
    assert found == Imports({}, {"newer": "node.py, line 2", "older": "node.py, line 4"})


def test_the_place_is_that_of_the_first(tmp_path):
    text = "\n\nimport older\nfrom older.msg import Pose\n"
    assert of_file(tmp_path, text).surely == {"older": "node.py, line 3"}


def test_own_modules_are_followed_and_are_not_told(tmp_path):
    lay(tmp_path, {"driving.py": "import older\n", "pens/colors.py": "import newer\n"})
    found = of_file(tmp_path, "import driving\nfrom pens.colors import RED\n")
    # a folder without __init__.py may be another package's: Python would take an installed one
    assert found.surely == {
        "pens": "node.py, line 2",
        "older": "driving.py, line 1",
        "newer": "pens/colors.py, line 1",
    }


def test_what_a_perhaps_loaded_file_imports_is_not_sure(tmp_path):
    lay(tmp_path, {"driving.py": "import newer\n"})
    found = of_file(tmp_path, "import older\n\ndef main():\n    import driving\n")
    assert found == Imports({"older": "node.py, line 1"}, {"newer": "driving.py, line 1"})


def test_modules_that_import_each_other_come_to_an_end(tmp_path):
    lay(tmp_path, {"driving.py": "import node\nimport older\n"})
    assert of_file(tmp_path, "import driving\n").surely == {"older": "driving.py, line 2"}


def test_a_package_is_followed_from_its_entry_point(tmp_path):
    files = {
        "__init__": "",
        "node": "from . import pens\nfrom .deep.way import Way\n",
        "pens": "from ..spiral import other\nimport older\n",
        "deep/__init__": "from .. import late\n",
        "deep/way": "import newer\n",
        "late": "import late_one\n",
        "unused": "import unused_one\n",
    }
    lay(tmp_path, {f"spiral/{name}.py": text for name, text in files.items()})
    assert of_entry(tmp_path, EntryPoint("spiral.node", "main")).surely == {
        "older": "spiral/pens.py, line 2",
        "late_one": "spiral/late.py, line 1",
        "newer": "spiral/deep/way.py, line 1",
    }


def test_an_own_module_of_a_known_name_is_followed_instead(tmp_path):
    lay(tmp_path, {"older/msg.py": "Pose = object", "older/__init__.py": ""})
    assert of_file(tmp_path, "from older.msg import Pose\n") == Imports()


@pytest.mark.parametrize(
    "text", ["import older\ndef main()\n", "\0", f"import {'x' * 300}", "from . import a"]
)
def test_what_cannot_be_read_or_loaded_tells_nothing_of_others(tmp_path, text):
    assert not of_file(tmp_path, text).surely.keys() & {"older", "a", "node"}


def test_thousands_of_branches_are_no_trouble(tmp_path):
    branches = "".join(f"elif a == {n}:\n    import older\n" for n in range(500))
    found = of_file(tmp_path, f"if a:\n    pass\n{branches}")
    assert found == Imports({}, {"older": "node.py, line 4"})
