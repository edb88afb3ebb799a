"""How well a submission's process can be confined here: tried once for each grader process.

What may pass (see `.refusal`) is tried again, lowers no level, and is not remembered.

`namespaces`: a root of its own, and processes, network, shared memory of its own; a user of its own
without any capability; a filter of system calls; limits.
`landlock`: Landlock for files, TCP, signals and abstract sockets; no capabilities, the filter,
limits; for root a user of its own, where that can read what it needs.
`limits`: limits and process groups, and no program gets more rights.

What is tried is what is done later: a process is confined, as a submission's is, and has to be able
to start Python, to read rclpy and to write a file. Elsewhere than on Linux there is no level.
"""

from __future__ import annotations

import errno
import importlib.util
import os
import random
import stat
import sys
import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from grader import scratch
from grader.errors import GraderError, GraderFailure, NotNow, NotOffered, UsageError
from grader.language.phrase import say
from grader.run.processes import family, isolation, watched
from grader.run.processes.isolation import Isolation
from grader.run.processes.refusal import TRIES, Refusal, insist
from grader.run.processes.sandbox import landlock, view
from grader.run.processes.sandbox.confinement import (
    LANDLOCK,
    LIMITS,
    NAMESPACE,
    NAMESPACES,
    OWN,
    SAME,
)

#: The best comes first.
LEVELS = (NAMESPACES, LANDLOCK, LIMITS)
#: Users of a moment: a range of systemd's for such, in which nobody has an account.
USERS = range(61184, 65520)
#: What a submission's process must be able to do; it ends with a line of `Refusal`.
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
    NAMESPACES: say(
        "Ubuntu 24.04 or later: sudo sysctl "
        "kernel.apparmor_restrict_unprivileged_userns=0, or an AppArmor profile"
        " with `userns,` for this Python. Docker: run the container with "
        "--security-opt seccomp=unconfined --security-opt apparmor=unconfined "
        "--security-opt systempaths=unconfined --cap-add SYS_ADMIN. Debian: "
        "sudo sysctl kernel.unprivileged_userns_clone=1. Elsewhere than on "
        "Linux there is none"
    ),
    LANDLOCK: say(
        "Linux 5.13 or later with `landlock` in its list of security modules "
        "(/sys/kernel/security/lsm), and a container runtime whose seccomp "
        "profile allows it, as those of Docker and podman since 2021 do"
    ),
    LIMITS: say("Linux with /proc"),
}


@dataclass(frozen=True)
class Level:
    """A way to confine, or none.

    Attributes:
        level: of `LEVELS`; '' for none.
        user: how the user is changed; see `.confinement`.
        refused: what was tried before in vain: level -> why.
    """

    level: str
    user: str = SAME
    refused: Mapping[str, str] = field(default_factory=dict)

    def name(self) -> str:
        """For the result; '' for none."""
        if self.level == LANDLOCK:
            own = ", own user" if self.user == OWN else ""
            return f"{LANDLOCK} (ABI {landlock.abi()}{own})"
        return self.level

    def is_at_least(self, level: str) -> bool:
        """Whether it keeps what another level promises."""
        return self.level in LEVELS[: LEVELS.index(level) + 1]


@dataclass(frozen=True)
class Place:
    """What is prepared for one process.

    Attributes:
        order: for `.confinement`; None for none.
        env: what its environment variables have to say of it.
    """

    order: Mapping[str, Any] | None
    env: Mapping[str, str]


def prepare(level: Level, root: Path, own: Path, folder: Path, *, is_apart: bool) -> Place:
    """What confines a submission's process in a run.

    Args:
        root: where it starts.
        own: all of the submission, without symbolic links: what it may write into.
        folder: that of the run; `tmp` is in it.
        is_apart: whether the run has a network of its own.
    """
    if not level.level:
        return Place(None, {})
    uid, user, written = random.choice(USERS), level.user, "/tmp"
    if level.level != NAMESPACES:
        written = str(folder / "tmp")
    if user == OWN and not _is_readable(own, anywhere=level.level == NAMESPACES):
        user = NAMESPACE if level.level == NAMESPACES else SAME
    order = {"level": level.level, "uid": uid, "user": user, "is_apart": is_apart}
    if level.level == NAMESPACES:
        owner = uid if user == OWN else -1
        order |= {"steps": view.steps(own, uid, owner), "folder": str(root)}
    elif level.level == LANDLOCK:
        settings = [str(path) for path in folder.glob("*.xml")]
        read, listed = view.readable(own)
        write = [written, str(own), *DEVICES]
        order |= {"read": [*read, *settings], "listed": listed, "write": write}
        if user == OWN:
            _open_ways(folder / "tmp")
            os.chown(written, uid, uid)
            for place, folders, files in os.walk(own):
                for name in (".", *folders, *files):
                    os.chown(Path(place, name), uid, uid, follow_symlinks=False)
    if level.level == LIMITS:
        return Place(order, {})
    env = {"TMPDIR": written, "HOME": written, "ROS_LOG_DIR": f"{written}/log"}
    return Place(order, env)


def _is_readable(root: Path, *, anywhere: bool) -> bool:
    """Whether other users may read all of a folder; `anywhere`: if they can get there."""
    if not anywhere:
        _open_ways(root)
        if any(not way.stat().st_mode & stat.S_IXOTH for way in root.parents):
            return False
    for place, _, files in os.walk(root):
        for path, wanted in (Path(place), 0o005), *((Path(place, name), 0o004) for name in files):
            if path.lstat().st_mode & wanted != wanted:
                return False
    return True


def _open_ways(path: Path) -> None:
    """Let other users through our folders to a place in one; they cannot list them."""
    home = scratch.home()
    for way in path.parents:
        if way == home or way.is_relative_to(home):
            way.chmod(way.stat().st_mode | stat.S_IXOTH)


_lock = threading.Lock()
#: (that of `only`, whether with a network of one's own) -> what there is
_found: dict[tuple[str, bool], Level] = {}
#: what `require` and `only` were asked for
_least = _only = ""


def best(isolated: Isolation, level: str = "") -> Level:
    """The best that there is here.

    Args:
        isolated: what keeps the run apart; if that is a network, there is more.
        level: this one, no less and no more; '': that of `only`, if any.

    Raises:
        GraderFailure: that is less than what was required.
        NotOffered: there is no such level.
        NotNow: what there is cannot be told at present.
    """
    level = level or _only
    tried = level, bool(isolated.namespaces)
    with _lock:
        if tried not in _found:
            _found[tried] = _look(isolated, level)
        found = _found[tried]
    if level and found.level != level:
        raise NotOffered(
            say(
                "isolation by {level}, at which this class is graded, is not to be had here: {why}",
                level=level,
                why=found.refused.get(level, say("this system has nothing of it")),
            )
        )
    if _least and not found.is_at_least(_least):
        raise GraderFailure(
            say("isolation by {least} was to be had before, and now is not", least=_least)
        )
    return found


def only(level: str) -> None:
    """Have every run from now on confined at one level, no less and no more; '': at the best."""
    global _only
    _only = level


def here(level: str = "") -> Level:
    """What a run would have here; see `best`.

    Raises:
        GraderFailure, NotOffered, NotNow: see `best`.
    """
    with scratch.make_folder() as folder, isolation.obtain_isolation(folder) as isolated:
        return best(isolated, level)


def require(level: str) -> None:
    """See to it that there is such a level here, and that every run from now on has it.

    Raises:
        UsageError: there is not; the text says what there is, what is missing, and how to get it.
    """
    global _least
    there = here()
    if not there.is_at_least(level):
        missing = there.refused.get(level, say("this system has nothing of it"))
        what = (
            say("the best here is {level!r}", level=there.name())
            if there.level
            else say("there is none here")
        )
        raise UsageError(
            say(
                "isolation by {level} is not to be had: {missing}; {what}. To get it: {advice}.",
                level=level,
                missing=missing,
                what=what,
                advice=ADVICE[level],
            )
        )
    _least = level


def _look(isolated: Isolation, wanted: str) -> Level:
    refused: dict[str, str] = {}
    for level in _candidates():
        if wanted in ("", level.level):
            refusal = insist(partial(_try, level, isolated))
            if refusal is None:
                return Level(level.level, level.user, refused)
            if not (refusal.is_final or _is_answer(refusal)):
                raise NotNow(
                    say(
                        "whether isolation by {level} is to be had could not be told in {times} "
                        "tries: {why}",
                        level=level.level,
                        times=TRIES,
                        why=refusal.why,
                    )
                )
            refused.setdefault(level.level, refusal.why)
    return Level("", refused=refused)


def _is_answer(refusal: Refusal) -> bool:
    """Whether a trial came to its end, each time, without something that it needs."""
    return refusal.number == errno.ENOENT and refusal.step == TRIAL_STEP


def offered(isolated: Isolation) -> list[Level]:
    """All that there is here, the best first; for tests and benchmarks."""
    return [level for level in _candidates() if _try(level, isolated) is None]


def _candidates() -> Iterator[Level]:
    """All that may be here, the best first."""
    own = [OWN] if os.geteuid() == 0 else []
    yield from (Level(NAMESPACES, user) for user in (*own, NAMESPACE))
    yield from (Level(LANDLOCK, user) for user in (*own, SAME))
    yield Level(LIMITS)


def _try(level: Level, isolated: Isolation) -> Refusal | None:
    """Confine a process so; what is refused."""
    if level.level == LANDLOCK and not landlock.abi():
        why = say("this kernel has no Landlock, or a container refuses it")
        return Refusal(errno.ENOSYS, "", why)
    is_apart = bool(isolated.namespaces)
    if level.level == NAMESPACES and not is_apart:
        return Refusal(errno.EPERM, "", say("namespaces of users and networks are refused"))
    try:
        with scratch.make_folder() as folder:
            tried = folder / "tried"
            (folder / "tmp").mkdir()
            tried.mkdir()
            place = prepare(level, tried, tried, folder, is_apart=is_apart)
            return _start(place, folder, isolated.namespaces)
    except watched.NotConfined as error:
        return error.refusal
    except GraderError as error:
        return Refusal(0, "", error.message)
    except OSError as error:
        return Refusal.of(error)


def _start(place: Place, folder: Path, namespaces: Mapping[str, int]) -> Refusal | None:
    needed = [os.__file__, str(view.ROOT / view.HOST[0])]
    rclpy, package = importlib.util.find_spec("rclpy"), ""
    if rclpy and rclpy.origin:
        needed.append(rclpy.origin)
        package = str(Path(rclpy.origin).parents[1])
    written = place.env.get("TMPDIR", str(folder / "tmp"))
    words = [sys.executable, "-I", "-S", "-c", TRIAL, written, package, *needed]
    env = {**os.environ, **place.env}
    process = family.Student(words, env, folder / "tried", (), namespaces, None, place.order)
    try:
        ended = process.wait(PATIENCE_S)
    finally:
        process.end(gently=False)
    lines = process.output().strip().splitlines()  # whole only after the end
    if ended == 0:
        return None
    if ended is None:
        return Refusal(errno.ETIMEDOUT, "", say("a trial took {s:g} s", s=PATIENCE_S))
    told = Refusal.from_line(lines[-1] if lines else say("a trial ended with {code}", code=ended))
    if ended > 0 and told.number in (0, errno.ENOENT):  # Python itself says so
        return Refusal(errno.ENOENT, TRIAL_STEP, told.why)
    return told
