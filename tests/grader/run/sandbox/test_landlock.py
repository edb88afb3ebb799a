"""Landlock: each rule at work in a child, and what kernels of before do without it."""

import errno
import fcntl
import os
import signal
import socket
import stat
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from grader.run.sandbox import landlock
from tests.children import error_of, in_child
from tests.programs import ran

EACCES, EPERM, EXDEV = errno.EACCES, errno.EPERM, errno.EXDEV
#: Of /dev/urandom: asks how good it is. Any process may.
RNDGETENTCNT = 0x80045200
#: Where programs and their libraries are.
SYSTEM = [path for path in ("/usr", "/bin", "/lib", "/lib64") if Path(path).exists()]


def needs(version: int) -> pytest.MarkDecorator:
    return pytest.mark.applies(landlock.abi() >= version, reason=f"Landlock ABI {version}")


@pytest.fixture
def places(tmp_path):
    """Folders to `read`, to `write`, and `hidden` ones, with a file in each."""
    for name in ("read", "write", "hidden"):
        (tmp_path / name / "sub").mkdir(parents=True)
        (tmp_path / name / "file").write_text(name)
    return tmp_path


def act_as(max_abi: int) -> None:
    """Have this process, a child of the test's, take its kernel for one with this ABI at most."""
    found = min(landlock.abi(), max_abi)
    landlock.abi = lambda: found


def confined(places: Path, act: Callable[[Path], Any], max_abi: int = 1 << 16) -> Any:
    """What is found by something that is done below `places`."""

    def do() -> Any:
        read = [str(places / "read"), *SYSTEM, str(places / "is not there")]
        act_as(max_abi)
        landlock.restrict(read, [str(places / "write")])
        return act(places)

    return in_child(do)


@needs(1)
def test_files_are_read_where_that_is_allowed_only(places):
    (places / "read/link").symlink_to(places / "hidden/file")

    def act(at: Path) -> list[Any]:
        (at / "write/link").symlink_to(at / "hidden/file")
        return [
            (at / "read/file").read_text(),
            (at / "write/file").read_text(),
            sorted(path.name for path in (at / "read").iterdir()),
            error_of((at / "hidden/file").read_text),
            error_of(os.listdir, at / "hidden"),
            error_of(os.listdir, at),
            error_of((at / "read/../hidden/file").read_text),
            error_of((at / "read/link").read_text),
            error_of((at / "write/link").read_text),
            error_of((at / "write/link").write_text, "x"),
            # from folder to folder it is a file that moves
            error_of(os.link, at / "hidden/file", at / "write/hard"),
        ]

    assert confined(places, act) == ["read", "write", ["file", "link", "sub"], *[EACCES] * 7, EXDEV]


@needs(1)
def test_files_are_made_and_changed_where_writing_is_allowed_only(places):
    def act(at: Path) -> dict[str, list[int]]:
        return {
            name: [
                error_of(call, *words)
                for call, *words in (
                    ((at / name / "file").write_text, "x"),
                    (os.open, at / name / "new", os.O_CREAT | os.O_WRONLY),
                    (os.mkdir, at / name / "folder"),
                    (os.rmdir, at / name / "sub"),
                    (os.symlink, "file", at / name / "link"),
                    (os.mkfifo, at / name / "fifo"),
                    (os.rename, at / name / "file", at / name / "other"),
                    (os.link, at / name / "other", at / name / "hard"),
                    (os.unlink, at / name / ("other" if name == "write" else "file")),
                    # by root either
                    (os.mknod, at / name / "device", stat.S_IFCHR | 0o600, os.makedev(1, 3)),
                    (os.mknod, at / name / "device", stat.S_IFBLK | 0o600, os.makedev(1, 3)),
                )
            ]
            for name in ("read", "write", "hidden")
        }

    found = confined(places, act)
    assert found.pop("write") == [*[0] * 9, EACCES, EACCES]
    with_a_link = [*[EACCES] * 7, errno.ENOENT, *[EACCES] * 3]  # to what could not be renamed
    assert found == {"read": with_a_link, "hidden": with_a_link}


@needs(1)
def test_programs_run_where_reading_is_allowed_only_and_sockets_are_bound_where_writing(places):
    for name in ("read", "hidden"):
        (places / name / "program").write_bytes(Path("/bin/true").read_bytes())
        (places / name / "program").chmod(0o755)

    def act(at: Path) -> list[int]:
        run = subprocess.call
        with socket.socket(socket.AF_UNIX) as one:
            bound = [error_of(one.bind, str(at / name / "socket")) for name in ("read", "write")]
        return [*bound, *(error_of(run, [at / name / "program"]) for name in ("read", "hidden"))]

    assert confined(places, act) == [EACCES, 0, 0, EACCES]


@needs(1)
def test_a_single_file_can_be_allowed(places):
    def act() -> list[Any]:
        landlock.restrict([str(places / "read/file")], ["/dev/null", str(places / "write/file")])
        (places / "write/file").write_text("changed")
        Path("/dev/null").write_text("nothing")
        return [
            (places / "read/file").read_text(),
            error_of((places / "read/file").write_text, "x"),
            error_of(os.listdir, places / "read"),
        ]

    assert in_child(act) == ["read", EACCES, EACCES]
    assert (places / "write/file").read_text() == "changed"


@needs(1)
def test_what_is_open_stays_open_and_what_is_started_is_confined_too(places):
    file = os.open(places / "hidden/file", os.O_RDONLY)

    def act(at: Path) -> list[Any]:
        command = f"cat {at}/hidden/file || cat {at}/read/file"
        told = ran(["/bin/sh", "-c", command])
        return [os.read(file, 10).decode(), told.stdout]

    assert confined(places, act) == ["hidden", "read"]
    os.close(file)


@needs(1)
def test_it_can_only_become_stricter(places):
    def act(at: Path) -> list[int]:
        landlock.restrict([str(at)], [str(at)])
        return [error_of((at / "hidden/file").read_text), error_of((at / "read/file").read_text)]

    assert confined(places, act) == [EACCES, 0]


@needs(2)
def test_files_move_between_folders_that_may_be_written(places):
    def act(at: Path) -> int:
        return error_of(os.rename, at / "write/file", at / "write/sub/file")

    assert confined(places, act, max_abi=1) == EXDEV
    assert confined(places, act) == 0


@needs(3)
def test_no_file_is_truncated_from_afar(places):
    def act(at: Path) -> list[int]:
        found = [error_of(os.truncate, at / name / "file", 0) for name in ("hidden", "read")]
        return [*found, error_of(os.truncate, at / "write/file", 0)]

    assert confined(places, act) == [EACCES, EACCES, 0]
    assert (places / "hidden/file").read_text() == "hidden"
    assert confined(places, act, max_abi=2) == [0, 0, 0]


@needs(4)
def test_tcp_is_neither_called_nor_listened_to_and_udp_goes_on_for_dds(places):
    def act(_: Path) -> list[int]:
        with socket.socket() as caller, socket.socket() as listener:
            found = [error_of(caller.connect, address), error_of(listener.bind, ("127.0.0.1", 0))]
        with socket.socket(type=socket.SOCK_DGRAM) as one:
            one.bind(("127.0.0.1", 0))
            return [*found, one.sendto(b"x", one.getsockname())]

    with socket.create_server(("127.0.0.1", 0)) as server:
        address = server.getsockname()
        assert confined(places, act) == [EACCES, EACCES, 1]
        assert confined(places, act, max_abi=3) == [0, 0, 1]


@needs(5)
def test_devices_take_no_commands(places):
    def act(max_abi: int) -> int:
        act_as(max_abi)
        landlock.restrict(["/dev/urandom"], [])
        with Path("/dev/urandom").open("rb") as device:
            return error_of(fcntl.ioctl, device, RNDGETENTCNT, bytes(4))

    assert [in_child(act, 1 << 16), in_child(act, 4)] == [EACCES, 0]


@needs(6)
def test_signals_stay_inside(places):
    def act(_: Path) -> list[int]:
        own = subprocess.Popen(["/bin/sleep", "60"])
        os.kill(own.pid, signal.SIGKILL)
        return [error_of(os.kill, os.getppid(), 0), own.wait()]

    assert confined(places, act) == [EPERM, -signal.SIGKILL]
    assert confined(places, act, max_abi=5) == [0, -signal.SIGKILL]


@needs(6)
def test_abstract_sockets_of_others_are_out_of_reach(places):
    name = f"\0turtlesim-{os.getpid()}"

    def act(_: Path) -> int:
        with socket.socket(socket.AF_UNIX) as caller:
            return error_of(caller.connect, name)

    with socket.socket(socket.AF_UNIX) as server:
        server.bind(name)
        server.listen()
        assert confined(places, act) == EPERM
        assert confined(places, act, max_abi=5) == 0


def test_where_there_is_none_it_is_told(monkeypatch):
    monkeypatch.setattr(landlock, "abi", lambda: 0)
    assert error_of(lambda: landlock.restrict([], [])) == errno.ENOSYS
