"""Under which name the store keeps a run: a hash of all that it depends on.

What judges it, the rubric, is not among that: a recording is judged as often as one likes.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

from grader import content, versions
from grader.exercise.exercise import Exercise
from grader.recording.recording import Clock
from grader.submission.folder import MAX_ENTRIES, is_junk
from grader.submission.private_copy import UNREADABLE


def of_run(submission: str, exercise: Exercise, time: Clock, seed: int | None) -> str:
    """The name of a run.

    Args:
        submission: the hash of what was handed in, from `of_hand_in`.
        seed: chooses where the varied runs start; None takes the exercise's own.
    """
    depends_on = {
        "submission": submission,
        "scene": exercise.scene,
        "conditions": exercise.conditions,
        "time": time,
        "seed": exercise.varied.seed if seed is None else seed,
        "grader": versions.grader(),
        "python": versions.python(),
        "rclpy": versions.rclpy(),
        "ros_distro": versions.ros_distro(),
    }
    if exercise.setting:
        depends_on["setting"] = content.of_bytes(exercise.setting.encode())
    return content.of_bytes(json.dumps(depends_on, sort_keys=True).encode())[:32]


def of_hand_in(path: Path, filename: str) -> str:
    """The hash of what was handed in, as it was called there.

    What nobody hands in by intention, as a .git or a __pycache__, does not count.

    Raises:
        OSError: it cannot be read.
    """
    if path.is_dir():
        return content.of_files(dict(_below(path)))
    return content.of_files({filename or path.name: content.of_file(path)})


def _below(top: Path) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    for at, folders, names in os.walk(top):
        folders[:] = sorted(name for name in folders if not is_junk(name))
        links = [name for name in folders if os.path.islink(os.path.join(at, name))]  # noqa: PTH114, PTH118  never fails
        for path in (Path(at, name) for name in (*sorted(names), *links) if not is_junk(name)):
            name = path.relative_to(top).as_posix()
            try:
                if path.is_symlink():
                    found.append((name, content.of_bytes(os.fsencode(path.readlink()))))
                elif path.is_file():  # no pipe, socket or device: they would be waited for
                    found.append((name, content.of_file(path)))
            except OSError as error:
                if error.errno not in UNREADABLE:
                    raise
                found.append((name, ""))  # a run leaves it out, too
            if len(found) > MAX_ENTRIES:  # refused by whoever opens it
                return found
    return found
