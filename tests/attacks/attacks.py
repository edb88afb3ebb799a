"""The attacks: what each is about, and which level stops it.

This is the table of the threat model, which `test_attacks.py` holds. What an attack does is the
first line of its program in `submissions/`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from tests.attacks import handed_in

ALL = ("namespaces", "landlock", "limits")
SANDBOX = ("namespaces", "landlock")
NAMESPACES = ("namespaces",)
#: Points and limits of a short grading of one run, in which moving is all that is asked for.
MOVES = """points: {moves: 100}
limits: {first_motion_s: 3, rest_s: 0.5, total_s: 5}
varied_runs: {count: 0}
"""
#: ... and of two, from two starts.
TWICE = MOVES.replace("count: 0", "count: 1, seed: 2022, nearest_m: 1.0, farthest_m: 1.5")


@dataclass(frozen=True)
class Attack:
    """One hostile submission.

    Attributes:
        about: the part of a grading that it attacks.
        stopped_by: the grader's levels at which it achieves nothing. At the others it may achieve
            what it is after, but earns no points, and the grader goes on.
        make: makes the submission.
        exercise: exercise.yaml, without its first line.
        most: the points that it may have: what it earns by what is no attack.
        lacks: checks that it must not pass.
        codes: how the grader may end.
        out: where the results go, in the submission; empty: elsewhere.
        outcome: how the run has to end, where that tells whether the attack works.
        program: which of `submissions/`, if not that of the attack's name.
        time: the clock that it is graded by.
        beside: an empty module that lies beside it.
        is_second: whether it is the second of two programs that a launch file starts.
    """

    about: str
    stopped_by: tuple[str, ...] = SANDBOX
    make: Callable[[Path], Path] | None = None
    exercise: str = MOVES
    most: float = 0
    lacks: tuple[str, ...] = ()
    codes: tuple[int, ...] = (0,)
    out: str = ""
    outcome: str = ""
    program: str = ""
    time: str = "virtual"
    beside: str = ""
    is_second: bool = False


FILES, PROCESSES, NETWORK = "files", "other processes", "network and terminal"
KERNEL, LIMITS, LINK = "the kernel", "limits", "the link and the clock"
SIMULATOR, RUBRIC, READING = "the simulator", "the rubric", "reading and reporting"
TOKENS, LEFTOVERS = "tokens", "what is left behind"
_SPIRAL = """points: {moves: 5, spiral: 30, edge_stop: 25, pen_per_quadrant: 20, picture: 20}
limits: {first_motion_s: 3, rest_s: 1.5, total_s: 40}
"""
SPIRAL = _SPIRAL + "varied_runs: {count: 0}\n"
VARIED = _SPIRAL + "varied_runs: {count: 1, seed: 2022, nearest_m: 1.0, farthest_m: 1.5}\n"
READ = (0, 2)

ATTACKS = {
    "reads_home": Attack(FILES),
    "writes_home": Attack(FILES),
    "reads_home_in_real_time": Attack(FILES, program="reads_home", time="real"),
    # a module of one's own with the name of one that is loaded beforehand: starts from nothing
    "reads_home_from_nothing": Attack(FILES, program="reads_home", beside="numpy.py"),
    "neighbours": Attack(FILES),
    "imports_a_neighbour": Attack(
        FILES, make=lambda target: handed_in.single("imports_a_neighbour", target, "")
    ),
    "forges_results": Attack(FILES),
    "changes_its_source": Attack(FILES),
    "changes_the_grader": Attack(FILES),
    "reads_the_exercise": Attack(FILES),
    "opens_devices": Attack(FILES),
    "runs_the_reference": Attack(FILES),
    "imports_the_reference": Attack(FILES),
    "changes_verdict_code": Attack(FILES),
    "reads_environment": Attack(TOKENS),
    "looks_at_processes": Attack(PROCESSES),
    "writes_memory": Attack(PROCESSES),
    "process_vm": Attack(PROCESSES),
    "ptraces": Attack(PROCESSES),
    "takes_descriptors": Attack(PROCESSES),
    "works_in_a_descriptor": Attack(PROCESSES, most=100, outcome="finished"),
    "replaces_the_recording": Attack(PROCESSES),
    "kills_all": Attack(PROCESSES),
    "kills_each": Attack(PROCESSES),
    "stops_all": Attack(PROCESSES),
    "unmounts": Attack(KERNEL),
    "mounts": Attack(KERNEL),
    "enters_namespaces": Attack(KERNEL),
    "asks_the_kernel": Attack(KERNEL),
    "watches_files": Attack(KERNEL, outcome="exited"),
    "has_privileges": Attack(KERNEL),
    "has_privileges_in_real_time": Attack(KERNEL, program="has_privileges", time="real"),
    "has_privileges_from_nothing": Attack(KERNEL, program="has_privileges", beside="numpy.py"),
    "plants_locks": Attack(LEFTOVERS),
    "replaces_the_folder_of_locks": Attack(LEFTOVERS),
    "keeps_locks": Attack(LEFTOVERS),
    "leaves_files": Attack(LEFTOVERS, NAMESPACES),
    "leaves_links": Attack(LEFTOVERS, outcome="exited"),
    "takes_folders_away": Attack(LEFTOVERS, most=100, outcome="finished"),
    "passes_on_a_message": Attack(LEFTOVERS, exercise=TWICE, outcome="exited"),
    "daemons": Attack(LEFTOVERS),
    "daemons_of_libc": Attack(LEFTOVERS),
    "outlives_main": Attack(LEFTOVERS, ALL),
    "many_processes": Attack(LIMITS, NAMESPACES),
    "many_threads_and_files": Attack(LIMITS, ALL),
    "takes_memory": Attack(LIMITS, ALL),
    "fills_disk": Attack(LIMITS, NAMESPACES),
    "endless_output": Attack(LIMITS, ALL),
    "reaches_services": Attack(NETWORK, NAMESPACES),
    "types_into_the_terminal": Attack(NETWORK),
    "misuses_the_link": Attack(LINK, ALL),
    "asks_and_never_reads": Attack(LINK, ALL),
    "lies_about_time": Attack(LINK, ALL),
    "replaces_builtins": Attack(LINK, ALL),
    "closes_descriptors": Attack(LINK, ALL),
    "exits_oddly": Attack(LINK, ALL),
    "becomes_another_program": Attack(LINK, ALL),
    "stops_itself": Attack(LINK, ALL),
    "crashes": Attack(LINK, ALL),
    "kills_the_simulator": Attack(SIMULATOR, ALL),
    "writes_by_the_simulator": Attack(SIMULATOR, ALL),
    "floods_the_simulator": Attack(SIMULATOR, ALL),
    "stops_the_clock": Attack(SIMULATOR, ALL, most=100, outcome="finished"),
    "sends_broken_packets": Attack(SIMULATOR, ALL),
    "turns_on_the_spot": Attack(RUBRIC, ALL, exercise=SPIRAL, most=50, lacks=("spiral",)),
    "goes_back_to_the_centre": Attack(
        RUBRIC, ALL, exercise=VARIED, most=60, lacks=("edge_stop", "pen_per_quadrant")
    ),
    "drives_beyond_all_numbers": Attack(RUBRIC, ALL, exercise=SPIRAL, most=40, lacks=("spiral",)),
    "draws_with_another_turtle": Attack(
        RUBRIC, ALL, exercise=SPIRAL, most=65, lacks=("picture", "pen_per_quadrant")
    ),
    "prints_escapes": Attack(READING, ALL),
    "imitates_results": Attack(READING, ALL),
    "lies_about_itself": Attack(READING, ALL),
    "fakes_a_traceback": Attack(READING, ALL),
    "does_not_parse": Attack(READING, ALL, handed_in.does_not_parse),
    "is_nested": Attack(READING, ALL, handed_in.is_nested, codes=READ),
    "has_a_long_key": Attack(READING, ALL, handed_in.has_a_long_key, codes=READ),
    "holds_no_files": Attack(READING, ALL, handed_in.holds_no_files, codes=READ),
    "is_called_by_markup": Attack(READING, ALL, handed_in.is_called_by_markup, codes=READ),
    "has_results_already": Attack(
        READING, ALL, handed_in.has_results_already, codes=READ, out="graded"
    ),
    "is_a_hostile_archive": Attack(READING, ALL, handed_in.is_a_hostile_archive, codes=READ),
}

#: What runs as a program is tried as the second of two as well, beside one that waits: its view of
#: the files is that of the first, its link is one of several.
SECOND = " as the second of two"
ATTACKS |= {
    f"{name}{SECOND}": replace(each, program=each.program or name, outcome="", is_second=True)
    for name, each in ATTACKS.items()
    if each.make is None and each.time == "virtual" and not each.beside
    if each.about not in (RUBRIC, SIMULATOR, READING)
}
ATTACKS["attacks_the_other"] = Attack(PROCESSES, is_second=True)

#: With limits only: what may get what it is after, but leaves the grader and the next one alone.
SURVIVED_AT_LIMITS = {"daemons", "daemons_of_libc", "takes_folders_away"}
#: ... and what is tried there at all: the rest is open, or the same at every level.
AT_LIMITS = {
    *SURVIVED_AT_LIMITS,
    *("outlives_main", "endless_output", "takes_memory", "stops_itself", "prints_escapes"),
}
#: As root: what root could do more than others, and one of each kind.
AS_ROOT = {
    *("reads_home", "writes_home", "changes_the_grader", "opens_devices", "forges_results"),
    *("writes_memory", "takes_descriptors", "replaces_the_recording", "kills_all", "stops_all"),
    *("unmounts", "mounts", "enters_namespaces", "has_privileges", "plants_locks"),
    *("has_privileges_in_real_time", "has_privileges_from_nothing", "reads_home_from_nothing"),
    *("daemons_of_libc", "types_into_the_terminal", "many_processes", "reads_environment"),
}
#: Where Landlock confines: of these what root is refused by it, and one of each kind.
AS_ROOT_BY_LANDLOCK = AS_ROOT - {
    *("has_privileges_in_real_time", "has_privileges_from_nothing", "reads_home_from_nothing"),
    *("forges_results", "reads_environment", "takes_descriptors", "stops_all", "unmounts"),
    "enters_namespaces",
}
#: What is the same at `landlock`: a second program that starts from nothing, as all do in real
#: time, and limits that no level sets.
TRIED_ELSEWHERE = {
    *("has_privileges_in_real_time", "has_privileges_from_nothing", "reads_home_in_real_time"),
    *("outlives_main", "takes_memory", "endless_output", "many_threads_and_files"),
}


def what_happens(name: str, level: str) -> str:
    """What becomes of an attack at a level of the grader's: `stopped`, `survived` or `open`."""
    if level in ATTACKS[name].stopped_by:
        return "stopped"
    alone = name.removesuffix(SECOND)
    return "survived" if level != "limits" or alone in SURVIVED_AT_LIMITS else "open"
