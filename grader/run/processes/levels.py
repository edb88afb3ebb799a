"""Finds the best level at which submissions can be confined here: once per grader process.

A refusal that may pass (see `.refusal`) is tried again, lowers no level, and is not cached.

`namespaces`: a root of its own, and processes, network, shared memory of its own; a user of its own
without any capability; a filter of system calls; limits.
`landlock`: Landlock for files, TCP, signals and abstract sockets; no capabilities, the filter,
limits; for root a user of its own, where that can read what it needs.
`limits`: limits and process groups, and no program gets more rights.

A trial does what runs do later: a process is confined as a submission's is, and must be able to
start Python, to read rclpy and to write a file. Elsewhere than on Linux there is no level.
"""

from __future__ import annotations

import errno
import importlib.util
import os
import random
import stat
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from grader.errors import GraderError, GraderFailure, NotNow, NotOffered, UsageError
from grader.run.limits import rlimits
from grader.run.processes import network
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.network import Isolation
from grader.run.processes.refusal import TRIES, Refusal, insist
from grader.run.processes.started_process import NotConfined, SubmissionProcess
from grader.run.sandbox import filesystem, landlock, view
from grader.run.sandbox.confinement import LANDLOCK, LIMITS, MAPPED, NAMESPACES, SAME, SEPARATE
from grader.system import scratch
from grader.text.message import Text, msg

#: The best comes first.
LEVELS = (NAMESPACES, LANDLOCK, LIMITS)
#: Users without an account: a range that systemd has for transient ones.
USERS = range(61184, 65520)
#: What a submission's process must be able to do; it prints a line of `Refusal` otherwise.
TRIAL = """
import importlib.machinery, sys
try:
    paths = sys.argv[2].split(":")
    if sys.argv[2] and not importlib.machinery.PathFinder.find_spec("rclpy", paths):
        sys.exit("rclpy is not found")
    open(sys.argv[1] + "/tried", "w").close()
    for path in sys.argv[3:]:
        open(path).close()
except OSError as error:
    sys.exit(f"{error.errno} {error.filename}: {error.strerror}")
except MemoryError:
    sys.exit("12 trial: no memory")
"""
TRIAL_STEP = "trial"
PATIENCE_S = 20.0
#: What programs write to that is no file.
DEVICES = ("/dev/null", "/dev/zero", "/dev/full")
ADVICE = {
    NAMESPACES: msg(
        "Ubuntu 24.04 or later: sudo sysctl "
        "kernel.apparmor_restrict_unprivileged_userns=0, or an AppArmor profile"
        " with `userns,` for this Python. Docker: run the container with "
        "--security-opt seccomp=unconfined --security-opt apparmor=unconfined "
        "--security-opt systempaths=unconfined --cap-add SYS_ADMIN. Debian: "
        "sudo sysctl kernel.unprivileged_userns_clone=1. Elsewhere than on "
        "Linux there is none"
    ),
    LANDLOCK: msg(
        "Linux 5.13 or later with `landlock` in its list of security modules "
        "(/sys/kernel/security/lsm), and a container runtime whose seccomp "
        "profile allows it, as those of Docker and podman since 2021 do"
    ),
    LIMITS: msg("Linux with /proc"),
}


@dataclass(frozen=True)
class Level:
    """A way to confine, or none.

    Attributes:
        level: of `LEVELS`; '' for none.
        user: how the user is changed; see `grader.run.sandbox.confinement`.
        refused: the better levels that were refused: level -> why.
    """

    level: str
    user: str = SAME
    refused: Mapping[str, Text] = field(default_factory=dict)

    def name(self) -> str:
        """Return the name for the result; '' for none."""
        if self.level == LANDLOCK:
            user = ", own user" if self.user == SEPARATE else ""
            return f"{LANDLOCK} (ABI {landlock.abi()}{user})"
        return self.level

    def is_at_least(self, level: str) -> bool:
        """Whether it is this level or a better one."""
        return self.level in LEVELS[: LEVELS.index(level) + 1]


@dataclass(frozen=True)
class Confinement:
    """The confinement of one process of a submission.

    Attributes:
        order: for `grader.run.sandbox.confinement`; None for none.
        env: environment variables that depend on it.
        copy: the path of the submission, which the process may write into.
    """

    order: Mapping[str, Any] | None
    env: Mapping[str, str]
    copy: Path


def prepare(
    level: Level,
    submission: Path,
    folder: Path,
    *,
    is_apart: bool,
    more: Sequence[Path] = (),
    meeting: int = -1,
    others: int = 0,
) -> Confinement:
    """Prepare a submission's confinement in a run, with the copy that this run may write into.

    At `namespaces` the first of its programs makes that copy itself, in memory, under the same
    path, and the others join it there. Elsewhere it lies in the folder of the run.

    Args:
        submission: all of it, without symbolic links in its path; it is only read.
        folder: that of the run; `tmp` is in it.
        is_apart: whether the run has a network of its own.
        more: folders that this process may read besides.
        meeting: of the socket by which its programs share their view of the files; -1: it is alone.
        others: so many may come to the view of this one, the first; 0: it comes to that itself.
    """
    uid = random.Random(folder.name).choice(USERS)  # one for all programs of a run
    user, copy, written, is_to_copy = level.user, submission, "/tmp", False
    if level.level != NAMESPACES:
        copy, written = folder / "submission" / submission.name, str(folder / "tmp")
        is_to_copy = not copy.exists()  # else another program of the run has it
        copy.mkdir(parents=True, exist_ok=True)
        if user == SEPARATE and not all(map(_is_reachable, (copy, *more))):
            user = SAME
    owner = uid if user == SEPARATE else -1
    if is_to_copy:
        filesystem.copy_tree(str(submission), str(copy), owner)
    if not level.level:
        return Confinement(None, {}, copy)
    order = {"level": level.level, "uid": uid, "user": user, "is_apart": is_apart}
    order["rlimits"] = rlimits(is_alone=user != SAME)
    if level.level == NAMESPACES:
        is_first = others > 0 or meeting < 0
        order["steps"] = view.steps(submission, uid, owner, more) if is_first else []
        order |= {"meeting": meeting, "others": others}
    elif level.level == LANDLOCK:
        settings = [str(path) for path in folder.glob("*.xml")]
        read, listed = view.readable(copy, more)
        write = [written, str(copy), *DEVICES]
        order |= {"read": [*read, *settings], "listed": listed, "write": write}
        if user == SEPARATE:
            os.chown(written, uid, uid)
    else:
        return Confinement(order, {}, copy)
    env = {"TMPDIR": written, "HOME": written, "ROS_LOG_DIR": f"{written}/log"}
    return Confinement(order, env, copy)


def _is_reachable(path: Path) -> bool:
    """Whether other users get to a place in our folders; they cannot list those."""
    home = scratch.home()
    for way in path.parents:
        if way == home or way.is_relative_to(home):
            way.chmod(way.stat().st_mode | stat.S_IXOTH)
    return all(way.stat().st_mode & stat.S_IXOTH for way in path.parents)


_lock = threading.Lock()
#: (the level of `only`, whether with a network of its own) -> the level found
_found: dict[tuple[str, bool], Level] = {}
#: the levels of `require` and `only`
_least = _only = ""


def best(isolated: Isolation, level: str = "") -> Level:
    """Return the best level that there is here.

    Args:
        isolated: the run's isolation; with a network of its own, better levels are possible.
        level: exactly this one; '': that of `only`, if any.

    Raises:
        GraderFailure: it is less than what was required.
        NotOffered: there is no such level.
        NotNow: the level cannot be found at present.
    """
    level = level or _only
    tried = level, bool(isolated.namespaces)
    with _lock:
        if tried not in _found:
            _found[tried] = _find_level(isolated, level)
        found = _found[tried]
    if level and found.level != level:
        raise NotOffered(
            "isolation by {level}, at which this class is graded, is not to be had here: {why}",
            level=level,
            why=found.refused.get(level, msg("this system has nothing of it")),
        )
    if _least and not found.is_at_least(_least):
        raise GraderFailure(
            "isolation by {least} was to be had before, and now is not", least=_least
        )
    return found


def only(level: str) -> None:
    """Confine every run from now on at exactly this level; '': at the best."""
    global _only
    _only = level


def here(level: str = "") -> Level:
    """Return the level that a run would have here; see `best`."""
    with scratch.make_folder() as folder, network.obtain_isolation(folder) as isolated:
        return best(isolated, level)


def require(level: str) -> None:
    """Require at least this level, here and for every run from now on."""
    global _least
    there = here()
    if not there.is_at_least(level):
        missing = there.refused.get(level, msg("this system has nothing of it"))
        what = (
            msg("the best here is {level!r}", level=there.name())
            if there.level
            else msg("there is none here")
        )
        raise UsageError(
            "isolation by {level} is not to be had: {missing}; {what}. To get it: {advice}.",
            level=level,
            missing=missing,
            what=what,
            advice=ADVICE[level],
        )
    _least = level


def _find_level(isolated: Isolation, wanted: str) -> Level:
    refused: dict[str, Text] = {}
    for level in _candidates():
        if wanted in ("", level.level):
            refusal = insist(partial(_try, level, isolated))
            if refusal is None:
                return Level(level.level, level.user, refused)
            # the trial itself ended, each time, because something that it needs was missing
            is_answer = refusal.number == errno.ENOENT and refusal.step == TRIAL_STEP
            if not (refusal.is_final or is_answer):
                raise NotNow(
                    "whether isolation by {level} is to be had could not be told in {times} "
                    "tries: {why}",
                    level=level.level,
                    times=TRIES,
                    why=refusal.why,
                )
            refused.setdefault(level.level, refusal.why)
    return Level("", refused=refused)


def _candidates() -> Iterator[Level]:
    """Yield all possible levels, the best first."""
    separate = [SEPARATE] if os.geteuid() == 0 else []
    yield from (Level(NAMESPACES, user) for user in (*separate, MAPPED))
    yield from (Level(LANDLOCK, user) for user in (*separate, SAME))
    yield Level(LIMITS)


def _try(level: Level, isolated: Isolation) -> Refusal | None:
    """Confine a process at this level; return what was refused, None for nothing."""
    if level.level == LANDLOCK and not landlock.abi():
        why = msg("this kernel has no Landlock, or a container refuses it")
        return Refusal(errno.ENOSYS, "", why)
    is_apart = bool(isolated.namespaces)
    if level.level == NAMESPACES and not is_apart:
        return Refusal(errno.EPERM, "", msg("namespaces of users and networks are refused"))
    try:
        with scratch.make_folder() as folder:
            tried = folder / "tried"
            (folder / "tmp").mkdir()
            tried.mkdir()
            confinement = prepare(level, tried, folder, is_apart=is_apart)
            return _start(confinement, folder, isolated.namespaces)
    except NotConfined as error:
        return error.refusal
    except GraderError as error:
        return Refusal(0, "", error.message)
    except OSError as error:
        return Refusal.of(error)


def _start(confinement: Confinement, folder: Path, namespaces: Mapping[str, int]) -> Refusal | None:
    needed = [os.__file__, str(view.ROOT / view.HOST[0])]
    rclpy, package = importlib.util.find_spec("rclpy"), ""
    if rclpy and rclpy.origin:
        needed.append(rclpy.origin)
        package = str(Path(rclpy.origin).parents[1])
    written = confinement.env.get("TMPDIR", str(folder / "tmp"))
    words = [sys.executable, "-I", "-S", "-c", TRIAL, written, package, *needed]
    env = {**os.environ, **confinement.env}
    command = ProcessCommand(words, env, confinement.copy, (), namespaces, confinement.order)
    process = SubmissionProcess(command)
    with process.ended_at_exit(gently=False):
        ended = process.wait(PATIENCE_S)
    lines = process.output().strip().splitlines()  # whole only after the end
    if ended == 0:
        return None
    if ended is None:
        return Refusal(errno.ETIMEDOUT, "", msg("a trial took {s:g} s", s=PATIENCE_S))
    silent = Refusal(0, "", msg("a trial ended with {code}", code=ended))
    refusal = Refusal.from_line(lines[-1]) if lines else silent
    if ended > 0 and refusal.number in (0, errno.ENOENT):  # from Python itself
        return Refusal(errno.ENOENT, TRIAL_STEP, str(refusal.why))
    return refusal
