"""Runs see a copy of what was handed in, that and no more, and people see what they know."""

import os
import socket
import stat
from pathlib import Path

import pytest

from grader import grading
from grader.exercise.loading import load_exercise
from grader.run.opening import open_submission
from grader.submission import private_copy
from grader.submission.answer import SetUp
from grader.submission.private_copy import PrivateCopy, install
from grader.system import scratch
from tests.files import lay
from tests.grader.submission.copies import GUARDED as NODE
from tests.grader.submission.copies import refused
from tests.grader.submission.test_opening import PACKAGE, pack


@pytest.fixture
def home(tmp_path):
    """Where a teacher keeps what was handed in."""
    folder = tmp_path / "home"
    folder.mkdir()
    return folder


def held(submission):
    """All that was handed in; without what its packages install."""
    copy = submission.copy
    found = (str(path.relative_to(copy.folder)) for path in copy.folder.rglob("*"))
    return sorted(name for name in found if not name.startswith(".installed"))


def flags(submission):
    flags = grading.plan(submission, load_exercise("turtlesim_challenge"))[0].flags
    return tuple(map(str, flags))


def test_a_single_file_comes_alone(home):
    lay(home, {"alice.py": NODE, "bob.py": NODE, "turtlesim.py": "", "data.json": "{}"})
    with open_submission(home / "alice.py") as submission:
        assert held(submission) == ["alice.py"]
        assert submission.root.name == "home"
        assert not submission.root.is_relative_to(home)
        assert submission.root.is_relative_to(scratch.home().resolve())
        assert flags(submission) == ()
    assert not submission.root.exists()


def test_a_module_beside_a_single_file_is_missed_by_its_name(home):
    imports = "import helper, json, os\nfrom shapes.round import Spiral\n"
    imports += "try:\n    import perhaps\nexcept ImportError: pass\n"
    imports += "import numpy, rclpy, gone, data\n"
    files = dict.fromkeys(("helper.py", "perhaps.py", "shapes/__init__.py", "numpy.py"), "")
    lay(home, files | {"alice.py": imports + NODE, "json.py": "", "data/x.json": "", "bob.py": ""})
    with open_submission(home / "alice.py") as submission:
        assert flags(submission) == tuple(
            f"{name} lies beside alice.py, but was not handed in: grade the folder"
            for name in ("helper.py", "shapes", "perhaps.py")
        )
    with open_submission(home, "alice") as submission:
        assert flags(submission) == ()
        assert held(submission) == sorted(
            [*files, "alice.py", "json.py", "bob.py", "data", "shapes", "data/x.json"]
        )


def test_a_package_comes_with_all_that_lies_in_it(home):
    files = {
        **PACKAGE,
        **dict.fromkeys(("resource/spiral", "config/x.yaml", "test/t.py", ".hidden", "log/l"), ""),
    }
    left = dict.fromkeys((".git/config", "__pycache__/a.pyc", "v/pyvenv.cfg", "v/lib/a.py"), "")
    lay(home, files | left)
    with open_submission(home) as submission:
        assert str(submission.found) == "console script turtle_controller in setup.py"
        folders = {str(Path(name).parent) for name in files} - {"."}
        assert held(submission) == sorted({*files, *folders})
        assert flags(submission) == tuple(map(str, submission.notes))


def test_what_an_earlier_grading_has_left_is_not_handed_in_again(home):
    """`grader run .` writes into the package itself."""
    result = '{\n  "schema": "turtlesim-grader/result/v1",\n}'
    left = {"graded/home/result.json": result, "graded/home/recording/output.txt": "x"}
    own = {"spiral/result.json": result, "data/result.json": "{}"}  # beside source; not ours
    lay(home, PACKAGE | left | own)
    with open_submission(home) as submission:
        names = {*PACKAGE, *own, "spiral", "data", "graded"}
        assert held(submission) == sorted(names)


def test_the_copy_is_for_reading_only_and_what_was_executable_is(home):
    lay(home, PACKAGE | {"run.sh": "#!/bin/sh\n"})
    (home / "run.sh").chmod(0o755)
    for handed_in in (home, pack(home.parent / "alice.zip", PACKAGE)):
        with open_submission(handed_in) as submission:
            for path in (submission.copy.folder, *submission.copy.folder.rglob("*")):
                mode = stat.S_IMODE(path.stat().st_mode)
                assert mode == (0o555 if path.is_dir() or path.name == "run.sh" else 0o444), path
        assert not submission.root.exists()
    (home / "run.sh").chmod(0o644)


def test_links_that_stay_inside_stay_and_others_are_left_out_and_told(home):
    base = lay(home / "alice", PACKAGE)
    lay(home, {"bob/node.py": NODE})
    (base / "inner").symlink_to("spiral")
    (base / "absolute.py").symlink_to(base / "spiral" / "node.py")
    (base / "spiral" / "up").symlink_to("..")
    (base / "out.py").symlink_to("../bob/node.py")
    (base / "spiral" / "root").symlink_to("/")
    (base / "zero").symlink_to("/dev/zero")
    with open_submission(base) as submission:
        root = submission.root
        assert (root / "inner" / "node.py").read_text() == NODE
        for path in root.rglob("*"):
            if path.is_symlink():
                assert path.resolve().is_relative_to(root)
                assert not path.readlink().is_absolute()
        assert {"inner", "absolute.py", "spiral/up"} < set(held(submission))
        assert not {"out.py", "zero", "spiral/root"} & set(held(submission))
        (flag,) = (flag for flag in flags(submission) if flag not in map(str, submission.notes))
        assert flag.startswith("not handed in, but links to somewhere else: ")
        assert all(name in flag for name in ("out.py", "zero", "spiral/root"))


def test_a_file_that_is_a_link_to_somewhere_else_is_refused(home):
    lay(home, {"alice/node.py": NODE, "bob/node.py": NODE})
    (home / "alice/link.py").symlink_to("../bob/node.py")
    (home / "alice/same.py").symlink_to("node.py")
    assert "link.py is a link to a place outside" in refused(home / "alice/link.py")
    with open_submission(home / "alice/same.py") as submission:
        assert held(submission) == ["same.py"]
        assert (submission.root / "same.py").read_text() == NODE


def test_what_is_no_file_is_left_out_and_not_waited_for(home):
    lay(home, {"node.py": NODE})
    os.mkfifo(home / "pipe.py")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(home / "socket"))
        with open_submission(home) as submission:
            assert held(submission) == ["node.py"]


def test_a_folder_300_levels_deep_is_copied_as_far_as_anybody_looks(home):
    lay(home, {"node.py": NODE})
    deep = home.joinpath(*["d"] * 300)
    deep.mkdir(parents=True)
    with open_submission(home) as submission:
        assert len(held(submission)) == 1 + private_copy.MAX_LEVELS
        assert "cannot be copied" in flags(submission)[0]


def test_names_of_all_kinds_are_copied(home):
    names = ["[b]x[b].txt", "\x1b[31m.txt", "a\nb", os.fsdecode(b"\xff\xfe.txt"), "n" * 255]
    lay(home, {"node.py": NODE} | dict.fromkeys(names, ""))
    with open_submission(home) as submission:
        assert held(submission) == sorted(["node.py", *names])


@pytest.mark.parametrize(("limit", "value"), [("MAX_ENTRIES", 3), ("MAX_BYTES", 150)])
def test_too_much_is_refused_but_for_what_needs_not_come(home, monkeypatch, limit, value):
    monkeypatch.setattr(private_copy, limit, value)
    lay(home, {"node.py": NODE, **dict.fromkeys(("env/a", "env/b", "env/c"), "x" * 200)})
    with open_submission(home) as submission:
        assert "node.py" in held(submission)
        assert flags(submission) == ("left out, since they cannot be copied: env",)
    (home / "env").rename(home / "data")
    said = refused(home)
    assert "limit" in said or "too many" in said


def test_a_file_of_a_terabyte_is_not_read_to_its_end(home, monkeypatch):
    monkeypatch.setattr(private_copy, "MAX_BYTES", 1_000_000)
    lay(home, {"node.py": NODE})
    with (home / "big").open("wb") as file:
        file.truncate(1 << 40)
    assert "more than 1 MB" in refused(home)


def test_what_is_wrong_with_the_machine_is_not_blamed_on_the_submission(home, monkeypatch):
    really_open = os.open

    def full(path, flags, *more, dir_fd=None):
        if flags & os.O_CREAT and Path(path).name == "node.py":
            raise OSError(28, "No space left on device")
        return really_open(path, flags, *more, dir_fd=dir_fd)

    lay(home, {"node.py": NODE})
    monkeypatch.setattr(private_copy.os, "open", full)
    with pytest.raises(OSError, match="No space left"), open_submission(home):
        pass


def test_paths_are_told_as_they_were_handed_in(home):
    lay(home, PACKAGE)
    for handed_in, shown in ((home, home), (home / "spiral/node.py", home / "spiral")):
        with open_submission(handed_in) as submission:
            text = f'File "{submission.root}/node.py", line 1\n{submission.root}'
            told = submission.with_original_paths(text)
            assert told == f'File "{shown}/node.py", line 1\n{shown}'
    archive = pack(home.parent / "alice.zip", PACKAGE)
    with open_submission(archive) as submission:
        printed = submission.with_original_paths(f"{submission.root}/spiral/node.py")
        assert printed == f"{archive}/spiral/node.py"


def test_a_path_that_was_cut_through_tells_nothing_of_the_copy():
    prefix, shown = "/tmp/runs/run-0123456789ab/copy", "/home/ada"
    copy = PrivateCopy(Path(prefix) / "x", Path(shown) / "x", prefix, shown)
    note = "\n[... 7 bytes left out ...]\n"
    for at in range(1, len(prefix)):
        text = f"{prefix} {prefix[:at]}{note}{prefix[at:]}/x {prefix}"
        printed = copy.with_original_paths(text)
        begin = shown[:at] if at >= 8 else prefix[:at]  # which tells nothing yet
        assert printed.startswith(f"{shown} {begin}\n[")
        assert printed.endswith(f"/x {shown}")
        assert "0123" not in printed and "89ab" not in printed
        assert note in printed
        assert copy.with_original_paths(f"cannot read {prefix[:at]}") == f"cannot read {begin}"


def test_letters_beside_a_cut_that_are_no_path_stay_as_they_are():
    copy = PrivateCopy(Path("/tmp/a/copy/x"), Path("/home/ada/x"), "/tmp/a/copy", "/home/ada")
    text = "it is /\n[... 7 bytes left out ...]\nyes, py"
    assert copy.with_original_paths(text) == text


def test_what_a_package_claims_to_install_stays_within_the_copy(tmp_path):
    lay(tmp_path, {"home/a.py": "", "home/made/b.py": "", "other/c.py": ""})
    copy = PrivateCopy(tmp_path / "home", tmp_path, "", "")
    installed = {
        "share/a/a.py": "a.py",
        "../../outside": "a.py",
        "share/a/up": "../other/c.py",
        "share/a/root": "/etc/passwd",
        "share/a/folder": "made",
        "share/a/folder/d": "a.py",
        "share/a/" + 300 * "n": "a.py",
        "share/a/nul\0": "a.py",
        "share/a/gone": "gone.py",
    }
    copy = install(copy, [SetUp(".", installed=installed)])
    found = {str(path.relative_to(copy.installed)) for path in copy.installed.rglob("*.*")}
    assert (copy.installed / "share/a/a.py").resolve() == tmp_path / "home/a.py"
    assert found == {"share/a/a.py"}
    assert (copy.installed / "share/ament_index/resource_index/packages/a").is_file()
    assert not [path for path in (tmp_path / "home/made").iterdir() if path.name != "b.py"]
    assert not (tmp_path / "outside").exists()
    # one that has the name already is another's
    assert install(copy, ()).installed != copy.installed
