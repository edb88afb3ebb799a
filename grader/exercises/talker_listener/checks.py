"""The check of the launch file; what the nodes do is expected as data."""

from __future__ import annotations

from grader.exercise.asking import OF_FILES
from grader.exercise.check import Checks, Tolerances
from grader.exercise.sentences import unless_unknown
from grader.exercise.verdict import Finding
from grader.recording.recording import Recordings
from grader.scenes.cast.trace import CastTrace
from grader.submission.error_texts import advice
from grader.submission.package_trace import PackageTrace
from grader.text.message import joined, msg

checks = Checks()


@checks(parrot=OF_FILES)
def launch(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A launch file starts both nodes.

    One of the launch files, with its default arguments, starts two programs of yours, or one with
    both nodes, and setup.py installs it. Not installed it is worth half.
    """
    if recordings.nominal.package is None:
        text = msg("There is no package that setup.py installs.")
        return Finding(0, text, msg("Hand in the folder with package.xml and setup.py."))
    trace = PackageTrace.of(recordings.nominal.package)
    setup = trace.setup
    own = {*trace.others, *((setup.name, setup.told) if setup else ())}
    by, place = (setup.file, setup.place) if setup else ("setup.py", "data_files")
    cast = CastTrace.of(recordings.nominal.trace)
    nodes = {event["node"] for event in cast.of_kind("endpoint")} - {"/"}
    worst = Finding(
        0,
        msg("The package has no launch file."),
        msg("Write launch/NAME.launch.py, with a Node for each program."),
    )
    for each in trace.launches:
        started = [node for node in each.nodes if node.package in own]
        programs = {(it.package, it.executable) for it in started}
        lacking = [f"{it.kind} {it.name}" for it in each.lacking if it.kind != "file"]
        if each.problem is not None:
            why = joined([each.problem.described, each.problem.place])
            text = msg("{file} cannot be launched: {why}", file=each.file, why=why)
            worst = Finding(0, text, advice(str(each.problem.text)))
        elif lacking:
            text = msg("{file} starts what is not there: {name}.", file=each.file, name=lacking[0])
            worst = Finding(0, text, msg("Compare the names with those in {file}.", file=by))
        elif len(programs) < 2 and not (started and len(nodes) > 1):
            text = msg("{file} starts {n} of the package's programs, expected 2.",
                       file=each.file, n=len(started))  # fmt: skip
            worst = Finding(0, text, msg("It needs a Node for each: look at their names."))
        elif setup is None or each.file in setup.left:
            text = msg("{file} starts both, and {set_up} does not install it.",
                       file=each.file, set_up=by)  # fmt: skip
            worst = Finding(0.5, text, msg("List it in {place}.", place=place))
            break
        else:
            return Finding(1, msg("{file} starts both.", file=each.file))
    return unless_unknown(trace, worst)
