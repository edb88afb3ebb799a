"""A submission is found, or refused in words that a student can act on; it is never run."""

import os
import tarfile
from pathlib import Path

import pytest

from grader.errors import UsageError
from grader.run.opening import open_submission
from grader.submission import opened
from grader.submission.folder import HAND_IN
from grader.submission.program import EntryPoint, Script
from grader.submission.safe_members import Budget
from tests.files import lay, packed
from tests.grader.submission.copies import GUARDED, NODE, below, found_in, refused

SETUP = (
    "from setuptools import setup\n"
    "setup(entry_points={'console_scripts': ['turtle_controller = spiral.node:main']})\n"
)
PACKAGE = {
    "package.xml": "",
    "setup.py": SETUP,
    "spiral/__init__.py": "",
    "spiral/node.py": GUARDED,
}


@pytest.fixture(autouse=True)
def inspection():
    """Confined, as in a run."""


def pack(archive, files):
    archive.write_bytes(packed(files))
    return archive


@pytest.mark.parametrize(
    ("name", "data", "runs"),
    [
        ("turtle_controller.py", GUARDED, "script"),
        ("a.py", NODE + "\nimport sys\nsys.exit(main())\n", "script"),
        ("a.py", "import rospy\nrospy.init_node('x')\n", "script"),
        # what does not parse is left to the interpreter
        *(("a.py", data, "script") for data in (b"def main(:\n", b"\0def main(): pass\n")),
        *(("a.py", data, "script") for data in (b"# coding: klingon\n", b"x = '\xff'\n")),
        # it only defines main; some of these names no import statement could use
        *((f"{name}.py", NODE, "import") for name in ("a", "my-a", "1_ctrl", "controller (1)")),
        # an import would find none, or another
        *((name, NODE, "by its path") for name in ("controller.v2.py", "random.py")),
    ],
)
def test_a_file_is_run_as_a_script_or_imported_and_its_main_called(tmp_path, name, data, runs):
    found = found_in(lay(tmp_path, {name: data}) / name)
    assert (found.name, found.root) == (name, tmp_path)
    said = f"file {name}" if runs == "script" else f"function main of {name}"
    assert str(found.found) == said
    if runs == "import":
        assert found.entry == EntryPoint(name.removesuffix(".py"), "main")
    else:
        assert found.entry == Script(tmp_path / name, "main" if runs == "by its path" else None)


def test_the_root_is_absolute_where_the_path_is_not(tmp_path, monkeypatch):
    lay(tmp_path, PACKAGE)
    monkeypatch.chdir(tmp_path)
    assert found_in(Path("spiral/node.py")).root == tmp_path / "spiral"
    assert found_in(Path()).root == tmp_path
    assert found_in(Path()).name == tmp_path.name


def test_nothing_of_a_submission_is_executed(tmp_path):
    files = dict(PACKAGE)
    trap = f"open({str(tmp_path / 'executed')!r}, 'w').close()\n"
    for name in ("setup.py", "spiral/__init__.py", "spiral/node.py"):
        files[name] = trap + files[name]
    found_in(lay(tmp_path / "ws", files))
    found_in(tmp_path / "ws/spiral/node.py")
    found_in(pack(tmp_path / "ws.zip", files))
    assert not (tmp_path / "executed").exists()


PASSED_OVER = [
    *(".git/a.py", ".venv/a.py", "__pycache__/a.py", "__MACOSX/a.py", "._node.py"),
    *("venv/a.py", "my_env/a.py", "build/a.py", "install/a.py", "log/a.py"),
    *("test/a.py", "tests/a.py", "pkg/__init__.py", "x.launch.py", "launch/y_launch.py"),
]


@pytest.mark.parametrize(
    "files",
    [
        {"a/node.py": GUARDED, "a/geometry.py": "PI = 3\n"},
        {"a/node.py": "import rclpy\nrclpy.init()\n", "README.md": ""},
        {"a/node.py": "x = (\n" + GUARDED, "helper.py": "X = 1\n"},
        dict.fromkeys([*PASSED_OVER, "a/node.py"], GUARDED) | {"my_env/pyvenv.cfg": ""},
    ],
)
def test_the_file_that_starts_itself_or_is_the_only_one_is_taken_from_a_folder(tmp_path, files):
    submission = found_in(lay(tmp_path, files))
    assert submission.entry == Script(tmp_path / "a/node.py")
    assert submission.root == tmp_path / "a"
    assert str(submission.found) == "file a/node.py"


def test_turtle_controller_py_wins_over_main_py_and_that_over_others(tmp_path):
    lay(tmp_path, {"a.py": GUARDED, "main.py": GUARDED})
    assert found_in(tmp_path).entry == Script(tmp_path / "main.py")
    lay(tmp_path, {"turtle_controller.py": GUARDED})
    assert found_in(tmp_path).entry == Script(tmp_path / "turtle_controller.py")
    assert found_in(tmp_path, "a").entry == Script(tmp_path / "a.py")


def test_several_files_to_start_are_listed(tmp_path):
    lay(tmp_path, {"a.py": GUARDED, "b.py": NODE, "helper.py": "X = 1\n"})
    assert "several programs to start: a.py, b.py. " in refused(tmp_path)
    assert "no program c; it has: a.py, b.py" in refused(tmp_path, "c")


def test_a_zip_is_unpacked_while_it_is_open_and_removed_also_after_an_error(tmp_path):
    archive = pack(tmp_path / "alice.zip", below("hw1/ws/src/spiral", PACKAGE))
    with pytest.raises(FileNotFoundError, match="run"), open_submission(archive) as submission:
        assert submission.name == "alice.zip"
        assert str(submission.found).endswith(" in hw1/ws/src/spiral/setup.py")
        assert (submission.root / "spiral/node.py").read_text() == GUARDED
        raise FileNotFoundError("of the run")
    assert not submission.root.exists()


def test_a_single_file_leaves_nothing_to_choose(tmp_path):
    lay(tmp_path, {"node.py": NODE})
    for name in ("node", "node.py"):
        assert found_in(tmp_path / "node.py", name) == found_in(tmp_path / "node.py")
    assert "there is nothing to choose" in refused(tmp_path / "node.py", "zz")


def nested(levels, data):
    for level in range(levels):
        data = packed({f"level{level}.zip": data})
    return data


def test_the_folder_of_a_courses_server_with_a_zip_in_it_is_looked_into(tmp_path):
    folder = tmp_path / "Alice Doe_123456_assignsubmission_file_"
    lay(folder, {"onlinetext.html": "<p>Hello</p>"})
    pack(folder / "spiral.zip", below("spiral", PACKAGE))
    with open_submission(folder) as submission:
        assert submission.name == folder.name
        assert submission.entry == EntryPoint("spiral.node", "main")
        said = "console script turtle_controller in spiral/setup.py, in spiral.zip"
        assert str(submission.found) == said
        assert submission.with_original_paths(str(submission.root)).startswith(str(folder))


def test_a_zip_in_a_zip_is_unpacked_and_so_is_a_tar(tmp_path):
    (tmp_path / "a.zip").write_bytes(nested(1, packed({"node.py": NODE})))
    assert str(found_in(tmp_path / "a.zip").found) == "function main of node.py, in level0.zip"
    lay(tmp_path / "a", PACKAGE)
    with tarfile.open(tmp_path / "a.tar.gz", "w:gz") as archive:
        archive.add(tmp_path / "a", "a")
    with open_submission(tmp_path / "a.tar.gz") as submission:
        assert submission.entry == EntryPoint("spiral.node", "main")
        assert (submission.root / "spiral/node.py").read_text() == GUARDED


def test_archives_are_unpacked_three_levels_deep_and_no_further(tmp_path):
    inside = packed({"node.py": NODE})
    (tmp_path / "a.zip").write_bytes(nested(2, inside))
    assert found_in(tmp_path / "a.zip").entry == EntryPoint("node", "main")
    (tmp_path / "b.zip").write_bytes(nested(3, inside))
    assert "level0.zip lies in an archive in an archive in an archive" in refused(
        tmp_path / "b.zip"
    )


def test_a_bomb_in_a_zip_is_stopped(tmp_path, monkeypatch):
    small = Budget(1_000_000)
    monkeypatch.setattr(opened, "Budget", lambda: small)
    for size, said in ((100_000, "no Python file"), (1_100_000, "b.zip holds more than 1 MB")):
        inside = packed({"zeros": bytes(size)})
        (tmp_path / "a.zip").write_bytes(packed({"b.zip": inside}))
        assert (tmp_path / "a.zip").stat().st_size < 10_000
        assert said in refused(tmp_path / "a.zip")


def test_several_archives_are_listed_and_none_beside_a_program_is_opened(tmp_path):
    for name in ("a.zip", "b.zip"):
        pack(tmp_path / name, {"node.py": NODE})
    assert "several archives, and no Python file beside them: a.zip, b.zip." in refused(tmp_path)
    lay(tmp_path, {"node.py": NODE})
    assert str(found_in(tmp_path).found) == "function main of node.py"


def test_an_archive_that_is_a_link_to_somewhere_else_is_not_opened(tmp_path):
    pack(tmp_path / "bob.zip", {"node.py": NODE})
    lay(tmp_path / "alice", {"README.md": ""})
    (tmp_path / "alice/mine.zip").symlink_to("../bob.zip")
    assert "mine.zip is a link to a place outside of alice" in refused(tmp_path / "alice")


def test_a_path_that_does_not_exist_brings_up_near_names(tmp_path):
    lay(tmp_path, {"turtle_controller.py": NODE, "notes.txt": ""})
    with pytest.raises(UsageError, match=r"exist\. Did you mean turtle_controller\.py") as error:
        found_in(tmp_path / "turtle_controler.py")
    assert str(error.value).endswith("?")
    assert refused(tmp_path / "zzz.py").endswith("Check the name and the folder.")
    assert "there is no folder" in refused(tmp_path / "no" / "a.py")


CPP = ("package.xml", "CMakeLists.txt", "src/node.cpp", "launch/a.launch.py")
HELD = "no Python file that could be the node (it holds: old.rar, report.pdf)"


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ([".git/config"], f"is an empty folder. {HAND_IN!s}"),
        (["report.pdf", "old.rar", "test/a.py"], HELD),
        (CPP, "Only Python can be graded"),
    ],
)
def test_a_folder_without_a_program_in_python_says_what_it_holds(tmp_path, names, words):
    assert words in refused(lay(tmp_path, dict.fromkeys(names, "")))


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        *(("a.tar.xz", "as a .zip"), ("a.rar", "as a .zip"), ("a.ipynb", "(.py)")),
        *(("a.PY", "call it a.py"), ("a.txt", HAND_IN), ("README", HAND_IN)),
        ("a.cpp", "Only Python can be graded"),
    ],
)
def test_another_kind_of_file_says_what_to_hand_in(tmp_path, name, advice):
    text = refused(lay(tmp_path, {name: "x"}) / name)
    assert text.startswith(f"{name} is neither a .py file, nor a folder, nor a .zip or .tar.gz.")
    assert str(advice) in text


def test_a_pipe_called_like_a_python_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.py")
    assert "not an ordinary file" in refused(tmp_path / "a.py")
