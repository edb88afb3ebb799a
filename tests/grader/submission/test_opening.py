"""A submission is found, or refused in words that a student can act on; it is never run."""

import io
import os
import tarfile
import zipfile
from pathlib import Path

import pytest

from grader.errors import SubmissionError, UsageError
from grader.run.opening import open_submission
from grader.submission.folder import HAND_IN
from grader.submission.start import EntryPoint, Script, Submission
from tests.files import lay
from tests.grader.submission.copies import in_place

NODE = "import rclpy\n\n\ndef main(args=None):\n    rclpy.init(args=args)\n"
GUARDED = NODE + '\n\nif __name__ == "__main__":\n    main()\n'
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


def below(folder: str, files: dict[str, str]) -> dict[str, str]:
    return {f"{folder}/{name}": text for name, text in files.items()}


def pack(archive: Path, files: dict[str, str]) -> Path:
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, text in files.items():
            packed.writestr(name, text)
    return archive


def found_in(path: Path, executable: str | None = None) -> Submission:
    with open_submission(path, executable) as submission:
        return in_place(submission)


def refused(path: Path, executable: str | None = None) -> str:
    with pytest.raises((SubmissionError, UsageError)) as error, open_submission(path, executable):
        pass
    assert "Traceback" not in str(error.value)
    return str(error.value)


# one file


def test_a_file_with_a_guard_runs_as_a_script(tmp_path: Path) -> None:
    file = lay(tmp_path, {"turtle_controller.py": GUARDED}) / "turtle_controller.py"
    found = found_in(file)
    assert (found.name, found.root, found.start, str(found.found)) == (
        *("turtle_controller.py", tmp_path, Script(file)),
        "file turtle_controller.py",
    )


def test_a_file_that_only_defines_main_is_imported_and_called(tmp_path: Path) -> None:
    submission = found_in(lay(tmp_path, {"controller.py": NODE}) / "controller.py")
    assert submission.start == EntryPoint("controller", "main")
    assert str(submission.found) == "function main of controller.py"


@pytest.mark.parametrize("name", ["my-controller.py", "1_ctrl.py", "controller (1).py"])
def test_a_name_that_no_import_statement_could_use_is_imported_all_the_same(
    tmp_path: Path, name: str
) -> None:
    assert found_in(lay(tmp_path, {name: NODE}) / name).start == EntryPoint(name[:-3], "main")


@pytest.mark.parametrize("name", ["controller.v2.py", "random.py"])
def test_a_file_that_an_import_would_not_find_is_loaded_by_its_path(
    tmp_path: Path, name: str
) -> None:
    assert found_in(lay(tmp_path, {name: NODE}) / name).start == Script(tmp_path / name, "main")


def test_a_file_that_calls_main_itself_runs_as_a_script(tmp_path: Path) -> None:
    file = lay(tmp_path, {"a.py": NODE + "\nimport sys\nsys.exit(main())\n"}) / "a.py"
    assert found_in(file).start == Script(file)


def test_a_file_without_main_runs_as_a_script(tmp_path: Path) -> None:
    file = lay(tmp_path, {"a.py": "import rospy\nrospy.init_node('x')\n"}) / "a.py"
    assert found_in(file).start == Script(file)


@pytest.mark.parametrize(
    "data", [b"def main(:\n", b"\0def main(): pass\n", b"# coding: klingon\n", b"x = '\xff'\n"]
)
def test_a_file_that_does_not_parse_is_left_to_the_interpreter(tmp_path: Path, data: bytes) -> None:
    file = tmp_path / "a.py"
    file.write_bytes(data)
    assert found_in(file).start == Script(file)


def test_the_root_is_absolute_where_the_path_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lay(tmp_path, PACKAGE)
    monkeypatch.chdir(tmp_path)
    assert found_in(Path("spiral/node.py")).root == tmp_path / "spiral"
    assert found_in(Path()).root == tmp_path
    assert found_in(Path()).name == tmp_path.name


# folders without set-up files


def test_nothing_of_a_submission_is_executed(tmp_path: Path) -> None:
    files = dict(PACKAGE)
    trap = f"open({str(tmp_path / 'executed')!r}, 'w').close()\n"
    for name in ("setup.py", "spiral/__init__.py", "spiral/node.py"):
        files[name] = trap + files[name]
    found_in(lay(tmp_path / "ws", files))
    found_in(tmp_path / "ws/spiral/node.py")
    found_in(pack(tmp_path / "ws.zip", files))
    assert not (tmp_path / "executed").exists()


def test_the_only_file_that_starts_itself_is_taken_from_a_folder(tmp_path: Path) -> None:
    lay(tmp_path, {"scripts/spiral.py": GUARDED, "scripts/geometry.py": "PI = 3\n"})
    submission = found_in(tmp_path)
    assert submission.start == Script(tmp_path / "scripts/spiral.py")
    assert submission.root == tmp_path / "scripts"
    assert str(submission.found) == "file scripts/spiral.py"


def test_turtle_controller_py_wins_over_main_py_and_that_over_others(tmp_path: Path) -> None:
    lay(tmp_path, {"a.py": GUARDED, "main.py": GUARDED})
    assert found_in(tmp_path).start == Script(tmp_path / "main.py")
    lay(tmp_path, {"turtle_controller.py": GUARDED})
    assert found_in(tmp_path).start == Script(tmp_path / "turtle_controller.py")
    assert found_in(tmp_path, "a").start == Script(tmp_path / "a.py")


def test_several_files_to_start_are_listed(tmp_path: Path) -> None:
    lay(tmp_path, {"a.py": GUARDED, "b.py": NODE, "helper.py": "X = 1\n"})
    assert "several Python files to start: a.py, b.py. " in refused(tmp_path)
    assert "no Python file c; it has: a.py, b.py" in refused(tmp_path, "c")


def test_a_lone_file_needs_neither_guard_nor_main(tmp_path: Path) -> None:
    lay(tmp_path, {"node.py": "import rclpy\nrclpy.init()\n", "README.md": ""})
    assert found_in(tmp_path).start == Script(tmp_path / "node.py")


def test_a_file_that_does_not_parse_still_counts_by_its_text(tmp_path: Path) -> None:
    lay(tmp_path, {"node.py": "x = (\n" + GUARDED, "helper.py": "X = 1\n"})
    assert found_in(tmp_path).start == Script(tmp_path / "node.py")


def test_what_is_not_the_students_node_is_passed_over(tmp_path: Path) -> None:
    others = [
        *(".git/a.py", ".venv/a.py", "__pycache__/a.py", "__MACOSX/a.py", "._node.py"),
        *("venv/a.py", "my_env/a.py", "build/a.py", "install/a.py", "log/a.py"),
        *("test/a.py", "tests/a.py", "pkg/__init__.py", "x.launch.py", "launch/y_launch.py"),
    ]
    lay(tmp_path, dict.fromkeys(others, GUARDED) | {"my_env/pyvenv.cfg": "", "node.py": GUARDED})
    assert found_in(tmp_path).start == Script(tmp_path / "node.py")


# zips


def test_a_zip_is_unpacked_while_it_is_open_and_removed_afterwards(tmp_path: Path) -> None:
    archive = pack(tmp_path / "alice.zip", below("hw1/ws/src/spiral", PACKAGE))
    with open_submission(archive) as submission:
        assert submission.name == "alice.zip"
        assert str(submission.found).endswith(" in hw1/ws/src/spiral/setup.py")
        assert (submission.root / "spiral/node.py").read_text() == GUARDED
    assert not submission.root.exists()


def test_a_zip_goes_away_after_an_error_in_the_run(tmp_path: Path) -> None:
    archive = pack(tmp_path / "a.zip", {"node.py": GUARDED})
    with (
        pytest.raises(FileNotFoundError, match="of the run"),
        open_submission(archive) as submission,
    ):
        raise FileNotFoundError("of the run")
    assert not submission.root.exists()


def test_a_zip_may_hold_one_file(tmp_path: Path) -> None:
    submission = found_in(pack(tmp_path / "a.zip", {"node.py": NODE}))
    assert submission.start == EntryPoint("node", "main")


def test_a_single_file_leaves_nothing_to_choose(tmp_path: Path) -> None:
    lay(tmp_path, {"node.py": NODE})
    for name in ("node", "node.py"):
        assert found_in(tmp_path / "node.py", name) == found_in(tmp_path / "node.py")
    with (
        pytest.raises(UsageError, match="there is nothing to choose"),
        open_submission(tmp_path / "node.py", "zz"),
    ):
        pass


# archives in folders and archives


def packed(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return buffer.getvalue()


def nested(levels: int, data: bytes) -> bytes:
    for level in range(levels):
        data = packed({f"level{level}.zip": data})
    return data


def test_the_folder_of_a_courses_server_with_a_zip_in_it_is_looked_into(tmp_path: Path) -> None:
    folder = tmp_path / "Alice Doe_123456_assignsubmission_file_"
    lay(folder, {"onlinetext.html": "<p>Hello</p>"})
    pack(folder / "spiral.zip", below("spiral", PACKAGE))
    with open_submission(folder) as submission:
        assert submission.name == folder.name
        assert submission.start == EntryPoint("spiral.node", "main")
        assert str(
            submission.found
        ) == "console script turtle_controller in spiral/setup.py, in " + ("spiral.zip")
        assert submission.with_original_paths(str(submission.root)).startswith(str(folder))


def test_a_zip_in_a_zip_is_unpacked_and_so_is_a_tar(tmp_path: Path) -> None:
    (tmp_path / "a.zip").write_bytes(nested(1, packed({"node.py": NODE.encode()})))
    assert str(found_in(tmp_path / "a.zip").found) == "function main of node.py, in level0.zip"
    lay(tmp_path / "a", PACKAGE)
    with tarfile.open(tmp_path / "a.tar.gz", "w:gz") as archive:
        archive.add(tmp_path / "a", "a")
    with open_submission(tmp_path / "a.tar.gz") as submission:
        assert submission.start == EntryPoint("spiral.node", "main")
        assert (submission.root / "spiral/node.py").read_text() == GUARDED


def test_archives_are_unpacked_three_levels_deep_and_no_further(tmp_path: Path) -> None:
    inside = packed({"node.py": NODE.encode()})
    (tmp_path / "a.zip").write_bytes(nested(2, inside))
    assert found_in(tmp_path / "a.zip").start == EntryPoint("node", "main")
    (tmp_path / "b.zip").write_bytes(nested(3, inside))
    assert "level0.zip lies in an archive in an archive in an archive" in refused(
        tmp_path / "b.zip"
    )


def test_a_bomb_in_a_zip_is_stopped(tmp_path: Path) -> None:
    zeros = packed({"zeros": bytes(20_000_000)})
    (tmp_path / "a.zip").write_bytes(packed({"b.zip": zeros}))
    lay(tmp_path / "in", {})
    (tmp_path / "c.zip").write_bytes(packed({"b.zip": packed({"0": bytes(210_000_000)})}))
    assert (tmp_path / "c.zip").stat().st_size < 300_000
    assert "b.zip unpacks to more than 200 MB" in refused(tmp_path / "c.zip")
    assert "no Python file" in refused(tmp_path / "a.zip")


def test_several_archives_are_listed_and_none_beside_a_program_is_opened(tmp_path: Path) -> None:
    for name in ("a.zip", "b.zip"):
        pack(tmp_path / name, {"node.py": NODE})
    assert "several archives, and no Python file beside them: a.zip, b.zip." in refused(tmp_path)
    lay(tmp_path, {"node.py": NODE})
    assert str(found_in(tmp_path).found) == "function main of node.py"


def test_an_archive_that_is_a_link_to_somewhere_else_is_not_opened(tmp_path: Path) -> None:
    pack(tmp_path / "bob.zip", {"node.py": NODE})
    lay(tmp_path / "alice", {"README.md": ""})
    (tmp_path / "alice/mine.zip").symlink_to("../bob.zip")
    assert "mine.zip is a link to a place outside of alice" in refused(tmp_path / "alice")


# refusals


def test_a_path_that_does_not_exist_is_the_callers_mistake(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="does not exist"), open_submission(tmp_path / "a.py"):
        pass


def test_a_path_that_does_not_exist_brings_up_near_names(tmp_path: Path) -> None:
    lay(tmp_path, {"turtle_controller.py": NODE, "notes.txt": ""})
    text = refused(tmp_path / "turtle_controler.py")
    assert text.endswith("does not exist. Did you mean turtle_controller.py?")
    assert refused(tmp_path / "zzz.py").endswith("Check the name and the folder.")
    assert "there is no folder" in refused(tmp_path / "no" / "a.py")


def test_an_empty_folder_says_what_to_hand_in(tmp_path: Path) -> None:
    lay(tmp_path, {".git/config": ""})
    assert refused(tmp_path).endswith(f"is an empty folder. {HAND_IN!s}")


def test_a_folder_without_python_lists_what_it_holds(tmp_path: Path) -> None:
    text = refused(lay(tmp_path, {"report.pdf": "", "old.rar": "", "test/a.py": ""}))
    assert "no Python file that could be the node (it holds: old.rar, report.pdf)" in text


def test_a_cpp_package_is_told_that_only_python_is_graded(tmp_path: Path) -> None:
    files = {"package.xml": "", "CMakeLists.txt": "", "src/node.cpp": "", "launch/a.launch.py": ""}
    assert "Only Python can be graded" in refused(lay(tmp_path, files))
    assert "Only Python can be graded" in refused(tmp_path / "src/node.cpp")


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        *(("a.tar.xz", "as a .zip"), ("a.rar", "as a .zip"), ("a.ipynb", "(.py)")),
        *(("a.PY", "call it a.py"), ("a.txt", HAND_IN), ("README", HAND_IN)),
    ],
)
def test_another_kind_of_file_says_what_to_hand_in(tmp_path: Path, name: str, advice: str) -> None:
    text = refused(lay(tmp_path, {name: "x"}) / name)
    assert text.startswith(f"{name} is neither a .py file, nor a folder, nor a .zip or .tar.gz.")
    assert str(advice) in text


def test_a_pipe_called_like_a_python_file_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.py")
    assert "not an ordinary file" in refused(tmp_path / "a.py")


def test_a_message_has_no_control_characters(tmp_path: Path) -> None:
    text = refused(lay(tmp_path, {"\x1b[31mred.txt": ""}))
    assert "?[31mred.txt" in text
