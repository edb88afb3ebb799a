"""The animations of runs that a page plays: strokes, places, and where two runs differ."""

import base64
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from grader.errors import RecordingError
from grader.recording.observations import Burst, End, SourceLine
from grader.recording.subject import Start
from grader.scenes import playback
from grader.scenes.playback import JudgedCheck, Playback, PlayedRun
from grader.scenes.turtlesim import pages
from grader.scenes.turtlesim.driving import drive, pen, twist
from grader.scenes.turtlesim.pages import first_difference
from grader.scenes.turtlesim.replay import MOST_TICKS, WIPED, animate
from tests.grader.driving import Spiral
from tests.grader.scenes.turtlesim.traces import odd_traces
from turtlesim_py.world.arena import TICK_NS


def numbers(text, kind):
    return np.frombuffer(base64.b64decode(text), kind)


def painted(made, frame):
    """The canvas of a frame, as the page paints it."""
    canvas = np.zeros((500, 500, 4), np.uint8)
    canvas[..., :3] = 255
    runs = numbers(made["runs"], "<u2").reshape(-1, 3).tolist()
    ops = np.array(made["ops"]).reshape(-1, 3).tolist()
    for at, color, count in ops:
        stroke, runs = runs[:count], runs[count:]
        if at > frame:
            break
        if color == WIPED:
            canvas[...] = (255, 255, 255, 0)
        for row, first, last in stroke:
            canvas[row, first : last + 1] = (*made["colors"][color], 255)
    return canvas


def poses(made, name):
    """What a turtle published, (n, 6): tick, and the columns of the pose."""
    turtle = next(each for each in made["turtles"] if each["name"] == name)
    columns = numbers(turtle["poses"], "<f4").reshape(-1, 5)
    frames = [f for first, last in turtle["stretches"] for f in range(first, last + 1)]
    assert len(frames) == len(columns) == len(numbers(turtle["places"], "<f8")) / 3
    return np.column_stack((frames, columns))


def eventful(tick, pose, arena):
    """Something of everything that leaves or removes paint."""
    twist(arena, 2.0, 0.7)
    match tick:
        case 20:
            pen(arena, (255, 0, 0), 9)
        case 40:
            arena.spawn(2.0, 3.0, 1.0, "other")
        case 60:
            arena.teleport_absolute("turtle1", 1.0, 9.0, 0.25)  # singles, as ROS has them
        case 80:
            arena.clear()
        case 90:
            arena.set_parameter("background_r", 200)
            arena.teleport_relative("other", 3.0, 0.5)
        case 120:
            arena.kill("other")
        case 130:
            arena.reset()
        case 150:
            arena.set_pen("turtle1", 0, 0, 0, 1, 1)
            arena.spawn(9.0, 9.0, 0.0, "other")


RUNS = {
    "spiral": (Spiral(), 2500, None),
    "eventful": (eventful, 200, None),
    "elsewhere": (eventful, 200, Start(3.3, 7.1, 1.1)),
    "nothing": (lambda *_: None, 0, None),
}


@pytest.mark.parametrize("name", RUNS)
def test_the_inputs_played_again_paint_the_recorded_picture_byte_for_byte(name):
    controller, ticks, start = RUNS[name]
    trace, _ = drive(controller, ticks, start)
    made = animate(trace, start)
    assert made["exact"]
    assert made["last"] == trace.ticks
    assert (painted(made, trace.ticks) == trace.canvas).all()


def test_each_frame_is_the_picture_after_its_tick():
    made = animate(drive(eventful, 200)[0], None)
    for ticks in (0, 1, 59, 60, 79, 80, 131, 199):
        assert (painted(made, ticks) == drive(eventful, ticks)[0].canvas).all()


def test_every_pose_that_was_published_is_in_it():
    trace, _ = drive(eventful, 200)
    made = animate(trace, None)
    for name, way in trace.trajectories.items():
        shown = poses(made, name)
        assert (shown[shown[:, 0] > 0] == way.rows()[:, :6]).all()
    other = next(each for each in made["turtles"] if each["name"] == "other")
    assert other["stretches"] == [[40, 119], [150, 200]]
    assert made["backgrounds"] == [[0, [69, 86, 255]], [90, [200, 86, 255]]]


def test_before_the_first_tick_the_turtle_is_where_it_began():
    start = Start(3.0, 7.0, 1.0)
    made = animate(drive(eventful, 5, start)[0], start)
    assert poses(made, "turtle1")[0] == pytest.approx([0, 3.0, 7.0, 1.0, 0, 0], abs=1e-6)


def test_where_a_clock_of_its_own_ended_commands_the_animation_follows_the_poses():
    def late(tick, pose, arena):
        if tick == 1:
            twist(arena, 2.0, 0.5)
        if tick == 20:
            arena.now_ns += 60 * TICK_NS  # the watchdog strikes earlier than ticks tell

    trace, _ = drive(late, 100)
    made = animate(trace, None)
    assert not made["exact"]
    assert (painted(made, 100) == trace.canvas).all()
    shown = poses(made, "turtle1")
    assert (shown[1:] == trace.trajectory().rows()[:, :6]).all()
    assert painted(made, 15)[..., 3].any()


@given(odd_traces())
def test_whatever_a_recording_holds_becomes_an_animation_that_is_json(trace):
    made = animate(trace, None)
    json.dumps(made, allow_nan=False)
    assert len(numbers(made["runs"], "<u2")) == 3 * sum(made["ops"][2::3])


def test_a_command_that_is_no_number_is_played_too():
    def lost(tick, pose, arena):
        twist(arena, math.nan if tick == 30 else 1.0)

    trace, _ = drive(lost, 60)
    made = animate(trace, None)
    assert made["exact"]
    assert (painted(made, 60) == trace.canvas).all()
    assert np.isnan(poses(made, "turtle1")[-1, 1])


def test_what_takes_hours_is_refused():
    trace, _ = drive(eventful, 3)
    with pytest.raises(RecordingError, match=r"225001 ticks; expected 225000 at most"):
        animate(replace(trace, ticks=MOST_TICKS + 1), None)


def test_calls_and_log_stand_by_tick():
    calls = animate(drive(eventful, 200)[0], None)["calls"]
    assert [call["op"] for call in calls if call["tick"] == 80] == ["cmd_vel", "clear", "log"]
    assert [call["tick"] for call in calls] == sorted(call["tick"] for call in calls)


def test_the_first_input_that_differs_is_named():
    def later(tick, pose, arena):
        eventful(tick, pose, arena)
        if tick == 50:
            arena.clear()

    one, two = (drive(each, 100)[0] for each in (eventful, later))
    shorter = drive(eventful, 90)[0]
    found = first_difference(one, two)
    assert found["tick"] == 50
    assert [call["op"] for call in found["mine"]] == ["cmd_vel"]
    assert [call["op"] for call in found["other"]] == ["cmd_vel", "clear"]
    assert first_difference(one, one) is None
    ended = first_difference(one, shorter)
    assert (ended["tick"], ended["other"]) == (91, [])


COMMANDS = [{"op": "cmd_vel", "turtle": "turtle1", "tick": tick} for tick in (1, 2, 3)]
LINES = (SourceLine("a.py", 5, text="go"), SourceLine("a.py", 9, text="stop"))


def lines_of(name, used, lines, told):
    sent = End(
        "publisher", name, "", True, used, lines=lines, sent=tuple(Burst(*each) for each in told)
    )
    made = pages.with_lines([{"op": "clear", "tick": 1}, *COMMANDS], [sent])
    lines = [line["line"] for line in made["lines"]]
    found = [call.get("line") for call in made["calls"]]
    return [None if each is None else lines[each] for each in found]


@pytest.mark.parametrize(
    ("times", "told", "lines"),
    [
        (3, ((0, 2), (1, 1)), [5, 5, 9]),
        (3, ((0, 2),), [5, 5, None]),  # not told to the end
        *((times, ((0, 2), (1, 10**15)), [5, None, None]) for times in (2, 4)),
    ],
)
def test_what_came_has_its_line_as_far_as_as_many_were_sent(times, told, lines):
    assert lines_of("/turtle1/cmd_vel", times, LINES, told) == [None, *lines]


def test_nothing_is_known_of_what_was_sent_by_another_name():
    assert lines_of("/turtle2/cmd_vel", 3, LINES, ((0, 3),)) == [None] * 4
    assert lines_of("/clear", 1, LINES, ((1, 1),)) == [9, None, None, None]


def test_what_stands_in_a_result_ends_no_element_of_the_page():
    evil = "</script><script>alert(1)</script><!-- $data & co"
    trace = drive(eventful, 3)[0]
    judged = JudgedCheck(evil, "failed", evil, evil, evil, ())
    made = pages.render(Playback(evil, evil, (PlayedRun(evil, evil, trace),), (judged,)))
    assert made.count("<script") == 2
    assert made.count("</script>") == 2
    assert "alert(1)</" not in made


def test_a_module_that_cannot_be_joined_is_named(tmp_path):
    (tmp_path / "a.js").write_text('import { b } from "./b.js";\nb();\n')
    with pytest.raises(ValueError, match=r"no module b\.js"):
        playback.join_modules("a", [tmp_path])
    (tmp_path / "b.js").write_text("export default 3;\n")
    with pytest.raises(ValueError, match=r"b\.js: cannot be joined: export default"):
        playback.join_modules("a", [tmp_path])
