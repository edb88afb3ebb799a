"""The attacks: what each is about, what it does, and which level stops it.

They lie in `submissions/`, a file for each part of a grading that is attacked. An entry there has,
by the attack's name, what differs from an `Attack` without anything: most of all `program`, whose
first line says what it does, or `as`, the attack that has the same one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

FOLDER = Path(__file__).with_name("submissions")
KINDS = sorted(path.stem for path in FOLDER.glob("*.yaml"))
LEVELS = {
    "all": ("namespaces", "landlock", "limits"),
    "sandbox": ("namespaces", "landlock"),
    "namespaces": ("namespaces",),
}
#: Points and limits of a short grading of one run, in which moving is all that is asked for.
MOVES = """points: {moves: 100}
limits: {first_motion_s: 3, rest_s: 0.5, total_s: 5}
varied_runs: {count: 0}
"""
ONE_MORE = "count: 1, seed: 2022, nearest_m: 1.0, farthest_m: 1.5"
SPIRAL = """points: {moves: 5, spiral: 30, edge_stop: 25, pen_per_quadrant: 20, picture: 20}
limits: {first_motion_s: 3, rest_s: 1.5, total_s: 40}
varied_runs: {count: 0}
"""
#: exercise.yaml without its first line; `twice` and `varied` have two runs, from two starts.
EXERCISES = {
    "moves": MOVES,
    "twice": MOVES.replace("count: 0", ONE_MORE),
    "spiral": SPIRAL,
    "varied": SPIRAL.replace("count: 0", ONE_MORE),
}


@dataclass(frozen=True)
class Attack:
    """One hostile submission.

    Attributes:
        kind: the part of a grading that it attacks, of `KINDS`.
        program: what it does.
        stopped_by: the grader's levels at which it achieves nothing, of `LEVELS`. At the others it
            may achieve what it is after, but earns no points, and the grader goes on.
        make: what makes the submission, of `handed_in`.
        exercise: what it is graded by, of `EXERCISES`.
        most: the points that it may have: what it earns by what is no attack.
        lacks: checks that it must not pass.
        codes: how the grader may end.
        out: where the results go, in the submission; empty: elsewhere.
        outcome: how the run has to end, where that tells whether the attack works.
        time: the clock that it is graded by.
        beside: an empty module that lies beside it.
        is_second: whether it is the second of two programs that a launch file starts.
    """

    kind: str
    program: str = ""
    stopped_by: str = "sandbox"
    make: str = "folder"
    exercise: str = "moves"
    most: float = 0
    lacks: tuple[str, ...] = ()
    codes: tuple[int, ...] = (0,)
    out: str = ""
    outcome: str = ""
    time: str = "virtual"
    beside: str = ""
    is_second: bool = False


def _read() -> dict[str, Attack]:
    rows: dict[str, dict[str, Any]] = {}
    for kind in KINDS:
        for name, row in yaml.safe_load((FOLDER / f"{kind}.yaml").read_text()).items():
            rows[name] = {"kind": kind, **row}
    for row in rows.values():
        if other := row.pop("as", ""):
            row["program"] = rows[other]["program"]
    return {name: Attack(**row) for name, row in rows.items()}


ATTACKS = _read()
#: What runs as a program is tried as the second of two as well, beside one that waits: its view of
#: the files is that of the first, its link is one of several.
SECOND = " as the second of two"
ATTACKS |= {
    f"{name}{SECOND}": replace(each, outcome="", is_second=True)
    for name, each in ATTACKS.items()
    if each.make == "folder" and each.time == "virtual" and not (each.beside or each.is_second)
    if each.kind not in ("rubric", "simulator", "reading")
}
#: With limits only: what may get what it is after, but leaves the grader and the next one alone.
SURVIVED_AT_LIMITS = {"daemons", "daemons_of_libc", "takes_folders_away"}


def what_happens(name: str, level: str) -> str:
    """What becomes of an attack at a level of the grader's: `stopped`, `survived` or `open`."""
    if level in LEVELS[ATTACKS[name].stopped_by]:
        return "stopped"
    alone = name.removesuffix(SECOND)
    return "survived" if level != "limits" or alone in SURVIVED_AT_LIMITS else "open"
