"""Whatever a stranger leaves goes, and nothing beside it."""

import os
import shutil
import socket
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

import pytest

from grader.system import removal
from grader.system.removal import remove
from tests.children import NOBODYS_UID, in_child
from tests.limited import printed_by
from tests.needs import needs

TEXT = "keep me"


def forbidden(folder: Path) -> None:
    inner = folder / "a" / "b"
    inner.mkdir(parents=True)
    (inner / "file").touch(mode=0o444)
    for path in (inner, inner.parent, folder):
        path.chmod(0o555 if path == inner else 0)


def deep(folder: Path) -> None:
    """Deeper than Python recurses, and than a process may have open files."""
    here = os.open(folder, os.O_RDONLY)
    for _ in range(sys.getrecursionlimit() + 200):
        os.mkdir("x" * 50, dir_fd=here)
        inner = os.open("x" * 50, os.O_RDONLY, dir_fd=here)
        os.close(here)
        here = inner
    os.close(here)


def strange_names(folder: Path) -> None:
    for name in (b"\xff\xfe", b"\x1b[31m\n", b"[b]", b"n" * 255, b"-rf", b"*"):
        inner = folder / os.fsdecode(name)
        inner.mkdir()
        (inner / inner.name).touch()


def specials(folder: Path) -> None:
    os.mkfifo(folder / "pipe")
    os.mkfifo(folder / "closed", 0)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(folder / "socket"))
    (folder / "zero").symlink_to("/dev/zero")
    (folder / "round").symlink_to("round")


def links_out(folder: Path) -> None:
    outside = folder.parent / "outside"
    (folder / "in").mkdir()
    for at in (folder, folder / "in"):
        (at / "folder").symlink_to(outside)
        (at / "file").symlink_to(outside / "file")
        (at / "up").symlink_to("..")
    with suppress(PermissionError):  # some systems let only the owner do so
        os.link(outside / "file", folder / "hard")


def a_link(folder: Path) -> None:
    folder.rmdir()
    folder.symlink_to(folder.parent / "outside")


def a_pipe(folder: Path) -> None:
    folder.rmdir()
    os.mkfifo(folder)


def nothing(folder: Path) -> None:
    folder.rmdir()


KINDS = [forbidden, deep, strange_names, specials, links_out, a_link, a_pipe, nothing]


@pytest.fixture
def folder():
    """An empty one, beside others, where any user may go; pytest's are for its own alone."""
    with tempfile.TemporaryDirectory() as place:
        base = Path(place).resolve()
        base.chmod(0o777)
        (base / "outside").mkdir()
        (base / "outside" / "file").write_text(TEXT)
        (base / "outside").chmod(0o755)
        (base / "folder").mkdir()
        (base / "folder").chmod(0o777)
        yield base / "folder"
        assert (base / "outside" / "file").read_text() == TEXT
        assert (base / "outside").stat().st_mode & 0o777 == 0o755
        assert [path.name for path in base.iterdir()] == ["outside"]


@pytest.mark.parametrize("leave", KINDS)
def test_whatever_was_left_is_removed_and_nothing_beside_it(folder, leave):
    leave(folder)
    assert remove(folder)


@needs("root")
def test_what_is_immutable_is_removed(folder):
    (folder / "in").mkdir()
    (folder / "in" / "file").touch()
    for path in (folder / "in" / "file", folder / "in"):
        if shutil.which("chattr") is None or subprocess.run(["chattr", "+i", path]).returncode:
            pytest.skip("nothing can be made immutable here")
    assert remove(folder)


@needs("root")
@pytest.mark.parametrize("leave", KINDS)
def test_a_user_who_may_not_do_everything_removes_it_as_well(folder, leave):
    def leave_and_remove() -> bool:
        os.setresuid(NOBODYS_UID, NOBODYS_UID, NOBODYS_UID)
        folder.mkdir()
        leave(folder)
        return remove(folder)

    folder.rmdir()
    assert in_child(leave_and_remove)


def test_a_folder_that_is_still_being_filled_is_given_up_in_the_end(folder, monkeypatch):
    empty = removal._empty

    def too_late(top: int) -> None:
        empty(top)
        (folder / "again").touch()

    monkeypatch.setattr(removal, "_empty", too_late)
    assert not remove(folder)
    monkeypatch.undo()
    assert remove(folder)


def test_a_folder_far_deeper_than_open_files_are_allowed_is_removed(folder):
    deep(folder)
    code = """
import resource
from pathlib import Path
from grader.system.removal import remove
resource.setrlimit(resource.RLIMIT_NOFILE, (24, 24))
print(remove(Path(sys.argv[1])))
"""
    assert printed_by(code, folder) == "True\n"
