"""What a confined process is refused, at each level, as root and as an ordinary user.

Each is a real process, confined as a submission's is. A lower level is had by refusing what the
better one needs, as a container does.
"""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.grader.run.conftest import LEVELS, at_levels
from tests.programs import ran
from tests.tiers import others_are_more

TEXTS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())

TESTS = Path(__file__).parents[3]
ROOT = TESTS.parent
OURSELVES = "root" if os.geteuid() == 0 else "user"
#: "root, open": others may read what root's Python is made of.
USERS = ["root", "root, open", "user"] if OURSELVES == "root" else ["user"]
OTHERS = "whoever runs the tests stands for the others"


@dataclass
class Tried:
    """What a confined process has tried."""

    user: str
    level: str
    found: dict[str, Any] = field(default_factory=dict)

    def assert_refused(self, *names: str) -> None:
        done = [name for name in names if not str(self.found[name]).startswith("E")]
        assert not done, {name: self.found[name] for name in done}

    def assert_done(self, *names: str) -> None:
        assert {name: self.found[name] for name in names} == dict.fromkeys(names, "done")

    def assert_begun_anew(self) -> None:
        assert self.found["fds"] == ["/dev/null", "pipe", "pipe"]
        assert self.found["status"]["NoNewPrivs"] == "1"
        assert self.found["core"] == [0, 0]
        assert self.found["group"]


@pytest.fixture(scope="module")
def run():
    """Run a program confined, and tell what it has tried; each kind of it once."""
    runs: dict[tuple[str, ...], Tried] = {}
    with ExitStack() as stack:
        outer = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        outer.chmod(0o755)
        for name in ("submission", "neighbour", "home", "scratch"):
            (outer / name).mkdir()
            (outer / name / "file.txt").write_text("x")
            (outer / name).chmod(0o755 if name == "submission" else 0o777)
        (outer / "submission" / "tries.py").write_text(TEXTS["tries"])
        (outer / "submission" / "looks.py").write_text(TEXTS["looks"])
        listener = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
        by_path, abstract = (stack.enter_context(socket.socket(socket.AF_UNIX)) for _ in range(2))
        by_path.bind(str(outer / "socket"))
        (outer / "socket").chmod(0o777)
        abstract.bind(f"\0{outer}")
        for each in (by_path, abstract):
            each.listen()
        outside = subprocess.Popen(["sleep", "1000"])
        stack.callback(outside.wait)
        stack.callback(outside.kill)
        told = {
            "paths": {
                "own": "file.txt",
                "own folder": "new.txt",
                "neighbour": str(outer / "neighbour" / "file.txt"),
                "home": str(outer / "home" / "file.txt"),
                "exercise": str(ROOT / "grader/exercises/turtlesim_challenge/exercise.yaml"),
                "judge": str(ROOT / "grader/grading.py"),
                "solution": str(ROOT / "turtlesim_challenge/__init__.py"),
                "git": str(ROOT / "pyproject.toml"),
                "passwords": "/etc/shadow",
                "kernel": "/proc/sys/kernel/core_pattern",
                "python": os.__file__,
                "usr": "/usr/bin/env",
                "host": str(ROOT / "grader/run/student/main.py"),
            },
            "outside": outside.pid,
            "port": listener.getsockname()[1],
            "socket": str(outer / "socket"),
            "abstract": f"\0{outer}",
        }

        def run(user: str, level: str, *lacking: str) -> Tried:
            if (user, level, *lacking) not in runs:
                refused = {
                    "namespaces": list(lacking),
                    "landlock": ["namespaces"],
                    "limits": ["namespaces", "landlock"],
                }[level]
                program = "looks.py" if level == "limits" else "tries.py"
                words = [TESTS / "confined.py", level, outer / "submission", program]
                words.append(json.dumps(told))
                if refused:
                    words = [TESTS / "refusing.py", ",".join(refused), sys.executable, *words]
                if user != OURSELVES:
                    more = ["--root"] if user == "root, open" else []
                    words = [TESTS / "as_user.py", *more, sys.executable, *words]
                env = {**os.environ, "TMPDIR": str(outer / "scratch"), "HOME": str(outer / "home")}
                done = ran([sys.executable, *map(str, words)], env=env)
                name, _, rest = done.stdout.partition("\n")
                if done.returncode == 0 and name.split(" ")[0] != level:
                    assert user != OURSELVES
                    pytest.skip(f"{level} is not to be had here: {name} {done.stderr[-500:]}")
                assert rest.startswith("{"), rest + done.stderr
                names = {path.name for path in (outer / "submission").iterdir()}
                assert names == {"file.txt", "looks.py", "tries.py"}  # it has written into a copy
                runs[user, level, *lacking] = Tried(user, level, json.loads(rest))
            return runs[user, level, *lacking]

        yield run


@pytest.fixture(params=at_levels("namespaces", "landlock"))
def level(request):
    return str(request.param)


@pytest.fixture(params=others_are_more(OTHERS, USERS, OURSELVES))
def user(request):
    return str(request.param)


@pytest.fixture
def tried(run, user, level):
    found: Tried = run(user, level)
    return found


def test_it_reads_python_and_what_was_handed_in_and_writes_one_folder(tried):
    tried.assert_done(
        *("read own", "write own", "write own folder"),
        *("read python", "read usr", "read host", "tmp", "null", "udp", "stderr"),
    )
    assert {"file.txt", "looks.py", "tries.py"} <= set(tried.found["list own"])
    assert tried.found["tmp is empty"] is (tried.level == "landlock")


def test_it_reads_nothing_else(tried):
    places = ("neighbour", "home", "exercise", "judge", "solution", "git", "passwords")
    tried.assert_refused(*(f"read {place}" for place in places))
    if tried.level == "namespaces":
        assert not {"home", "sys", "run", "var", "srv", "boot"} & set(tried.found["list /"])


def test_it_writes_nothing_else(tried):
    places = ("neighbour", "home", "usr", "python", "host", "kernel", "judge")
    tried.assert_refused(*(f"write {place}" for place in places))


def test_what_it_can_write_has_an_end(tried):
    assert tried.found["fill"] == ("ENOSPC" if tried.level == "namespaces" else "EFBIG")


def test_processes_outside_are_out_of_sight_and_reach(tried):
    for who in ("grader", "parent", "outside"):
        names = ("mem", "environ", "maps", "fd", "cwd", "cmdline")
        tried.assert_refused(*(f"{name} of {who}" for name in names))
    tried.assert_refused("signal grader", "signal outside", "signal parent", "ptrace")
    tried.assert_refused("read memory")
    if tried.level == "namespaces":
        assert tried.found["pids"] == 2  # the namespace's first process, and itself
    else:
        tried.assert_refused("pids")


def test_nothing_can_be_mounted_uncovered_or_entered(tried):
    tried.assert_refused("umount /proc", "umount /tmp", "mount", "remount")
    tried.assert_refused("unshare", "setns", "chroot")


def test_no_socket_leads_out_and_there_is_no_terminal(tried):
    tried.assert_refused("packets", "crypto", "tcp outside", "unix outside", "abstract outside")
    tried.assert_refused("terminal", "ptmx")


def test_it_has_no_privileges_and_gets_none(tried):
    status = tried.found["status"]
    sets = ("CapInh", "CapPrm", "CapEff", "CapAmb")
    if tried.user != "user" or tried.level == "namespaces":
        sets += ("CapBnd",)  # who has no privileges cannot limit what programs could get
    assert {name: int(status[name], 16) for name in sets} == dict.fromkeys(sets, 0)
    assert status["Seccomp"] == "2"
    if tried.level == "namespaces" or tried.user == "root, open":
        assert 0 not in tried.found["uid"]
        tried.assert_refused("setuid")
        if tried.user != "user":
            assert status["Groups"].strip() == ""


def test_nothing_is_inherited(tried):
    tried.assert_begun_anew()
    status = tried.found["status"]
    assert int(status["SigBlk"], 16) == 0
    of_glibc = 3 << 31  # its own two, 32 and 33, which nobody else can set
    # Python ignores SIGPIPE and SIGXFSZ
    assert int(status["SigIgn"], 16) & ~of_glibc == 1 << 12 | 1 << 24
    assert int(status["SigCgt"], 16) == 1 << 1  # and handles SIGINT


@pytest.mark.applies(LEVELS["namespaces"], reason="there is that level")
def test_an_older_kernel_mounts_one_after_the_other(run, user):
    tried = run(user, "namespaces", "mount_setattr")
    test_it_reads_python_and_what_was_handed_in_and_writes_one_folder(tried)
    test_it_writes_nothing_else(tried)


def test_limits_hold_without_anything_else(run, user):
    tried = run(user, "limits")
    tried.assert_begun_anew()
