"""What the grader does not know costs nothing, and what it leaves out is told."""

import pytest

from grader.exercise.sentences import unless_unknown
from grader.exercise.verdict import Finding
from grader.exercises.talker_listener.checks import launch
from grader.recording.recording import Recording, Recordings, Run
from grader.scenes.cast.trace import CastTrace
from grader.submission.package_trace import LaunchFile, Obstacle, PackageTrace
from grader.text.message import msg
from tests.files import lay
from tests.inspecting import inspected

LAUNCH = "<launch><executable cmd='ls'/></launch>\n"


def test_the_launch_files_that_are_too_many_are_told_as_left_out(tmp_path):
    files = {f"launch/a{number:02}.launch.xml": LAUNCH for number in range(42)}
    files["package.xml"] = "<package><name>demo</name></package>"
    *others, last = inspected(lay(tmp_path, files)).trace.launches
    assert len(others) == 40
    assert last.problem is not None
    assert last.problem.kind == "unknown"
    assert "it was left out, with" in str(last.problem.text)


@pytest.mark.parametrize(("kind", "is_judged"), [("unknown", False), ("error", True)])
def test_a_check_that_takes_points_is_not_judged_where_a_launch_file_is_not_known(kind, is_judged):
    trace = PackageTrace(launches=(LaunchFile("a.launch.py", Obstacle(kind, msg("it ends"))),))
    assert unless_unknown(trace, Finding(0.5, msg("half"))).judged is is_judged
    assert unless_unknown(trace, Finding(1, msg("all"))).judged
    run = Recording(CastTrace(), Run(), package=trace)
    found = launch(Recordings(run), {})
    assert (found.judged, found.share) == (is_judged, 0)
    assert "ros2 launch." not in str(found.help)
