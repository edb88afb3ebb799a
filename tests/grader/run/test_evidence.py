"""What comes from a submission's process is believed by its form, or not at all."""

from __future__ import annotations

import json
import os
import random
import signal
from collections.abc import Iterator
from dataclasses import replace
from itertools import count

import pytest

from grader.recording.conduct import Conduct
from grader.run import evidence
from grader.run.evidence import MOST_BYTES, open_evidence
from grader.run.opening import open_submission
from grader.run.processes import usage
from grader.run.student import loops
from grader.submission.opening import Submission
from grader.submission.start import Slip

PLACE = {"file": "a.py", "line": 2, "function": "", "text": "pass"}
END = {"kind": "publisher", "name": "/a", "type": "a/msg/B", "place": PLACE}


@pytest.fixture(scope="module")
def submission(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Submission]:
    folder = tmp_path_factory.mktemp("alice")
    (folder / "a.py").write_text("while True:\n    pass\n")
    with open_submission(folder) as opened:
        yield opened


def told(submission: Submission, *lines: bytes) -> Conduct:
    with open_evidence() as pipe:
        for line in lines:
            os.write(pipe.descriptor, line + b"\n")
    return pipe.conduct(submission, 1.5, computes=True)


def say(**what: object) -> bytes:
    return json.dumps(what).encode()


def test_what_was_told_line_by_line_is_put_together(submission: Submission) -> None:
    conduct = told(submission, say(end=END), say(used=[0, 4, True]), say(spun=0.5), say(returned=1))
    assert conduct.is_told
    assert [(end.name, end.used, end.is_met) for end in conduct.ends] == [("/a", 4, True)]
    assert (conduct.spun_s, conduct.returned_s) == (0.5, 1.0)


def test_from_which_lines_was_sent_what_is_told_in_order(submission: Submission) -> None:
    other = {**PLACE, "line": 1}
    sent = [0, [PLACE, other], [[0, 104], [1, 1]]]
    conduct = told(submission, say(end=END), say(used=[0, 105, True]), say(sent=sent))
    (end,) = conduct.ends
    assert [place.line for place in end.lines] == [2, 1]
    assert [(burst.line, burst.times) for burst in end.sent] == [(0, 104), (1, 1)]


@pytest.mark.parametrize(
    "sent",
    [
        [0, [PLACE], [[1, 1]]],
        [0, [PLACE], [[0, -1]]],
        [0, [PLACE], [[0, 1.5]]],
        [0, [PLACE], [[True, 1]]],
        [0, [PLACE], [[0, 1]] * 201],
        [0, [{**PLACE, "file": "../b.py"}], [[0, 1]]],
        [1, [PLACE], [[0, 1]]],
        [0, PLACE, [[0, 1]]],
        [0, [PLACE], 7],
    ],
)
def test_lines_that_nothing_can_have_been_sent_from_are_not_believed(
    submission: Submission, sent: object
) -> None:
    assert told(submission, say(end=END), say(sent=sent)) == Conduct()


def test_what_was_seen_of_timers_and_exceptions_is_believed_by_its_form(
    submission: Submission,
) -> None:
    timer = {"place": PLACE, "period_s": 0.1, "times": 1}
    caught = {"type": "E", "text": "", "time_s": 1, "times": 2, "place": PLACE, "by": None}
    lines = [say(end=END), say(used_at=[0, PLACE]), say(timer=[0, timer])]
    lines += [say(timer=[0, {**timer, "times": 4}]), say(caught=[0, caught])]
    conduct = told(submission, *lines)
    assert [each.times for each in conduct.timers] == [4]
    assert [(each.type, each.times, each.by) for each in conduct.caught] == [("E", 2, None)]
    assert conduct.ends[0].used_at is not None
    assert Conduct.from_json(json.loads(json.dumps(conduct.to_json()))) == conduct
    for wrong in (
        say(timer=[0, {**timer, "period_s": -1}]),
        say(caught=[0, {**caught, "times": 0.5}]),
        say(used_at=[7, PLACE]),
    ):
        assert told(submission, *lines, wrong) == Conduct()


def test_what_the_source_shows_is_said_by_who_has_read_it_and_by_no_process(
    submission: Submission,
) -> None:
    slip = Slip("unread", "stoped", "stopped", "a.py", 3, "self.stoped = True")
    read = replace(submission, slips=(slip,))
    (found,) = told(read, say(end=END)).slips
    assert (found.kind, found.name, found.near) == ("unread", "stoped", "stopped")
    assert (found.place.file, found.place.line, found.place.text) == slip[3:]
    assert told(read) == Conduct()
    forged = {"kind": "unread", "name": "a", "near": "b", "place": PLACE}
    assert told(read, say(end=END), say(slip=forged)) == Conduct()


def test_an_older_recording_without_them_is_still_read(submission: Submission) -> None:
    data = json.loads(json.dumps(told(submission, say(end=END)).to_json()))
    for name in ("timers", "caught", "slips"):
        del data[name]
    del data["ends"][0]["used_at"]
    assert Conduct.from_json(data) == told(submission, say(end=END))


@pytest.mark.parametrize(
    "line",
    [
        *(b"{", b'{"spun": NaN}', b'{"spun": 1e999}', b'{"spun": true}', b'{"spun": -1}', b"\xff"),
        *(
            b"{}",
            b'{"spun": 1, "returned": 2}',
            b'{"unheard of": 1}',
            b'{"end": {}}',
            b'{"end": 3}',
        ),
        *(say(used=[7, 1, True]), say(used=[0]), say(used=None), say(stop={"place": None})),
        *(say(end={**END, "kind": "friend"}), say(end={**END, "name": "x" * 301})),
        *(say(end={**END, "place": {**PLACE, "line": "2"}}), say(wait=[-3, {}]), say(slow=[0, 1])),
        say(blind=True),
        *(b'{"end": ' + b"[" * 5000 + b"]" * 5000 + b"}", b'{"is_told": false}'),
    ],
)
def test_of_a_process_that_tells_nonsense_nothing_is_told(
    submission: Submission, line: bytes
) -> None:
    assert told(submission, say(end=END), line) == Conduct()
    assert told(submission, line) == Conduct()


def test_texts_are_told_in_one_line_that_can_be_shown(submission: Submission) -> None:
    text = "red \x1b[31m\nand\ud800\u202e"
    raised = {"type": "Error", "text": text, "time_s": 1, "place": None}
    found = told(submission, say(raised=raised)).raised
    assert found is not None
    assert found.text == "red ?[31m and??"


def test_of_a_process_that_tells_nothing_nothing_is_told(submission: Submission) -> None:
    assert told(submission) == Conduct()


def test_bytes_of_any_kind_are_never_our_failure(submission: Submission) -> None:
    chance = random.Random(12)
    whole = b"\n".join((say(end=END), say(used=[0, 4, True]), say(spun=0.5), say(returned=1)))
    for _ in range(300):
        data = bytearray(whole)
        for _ in range(chance.randint(1, 6)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        told(submission, bytes(data))


def test_the_pipe_holds_so_much_and_no_more(submission: Submission) -> None:
    with open_evidence() as pipe:
        os.set_blocking(pipe.descriptor, False)
        sent = 0
        with pytest.raises(BlockingIOError):
            while True:
                sent += os.write(pipe.descriptor, b"x" * 1000)
        assert sent <= MOST_BYTES
    assert pipe.conduct(submission, 0.0, computes=True) == Conduct()


def dump(submission: Submission, *frames: tuple[str, int, str]) -> list[bytes]:
    head = b"Current thread 0x00007f (most recent call first):"
    return [head, *(f'  File "{file}", line {n} in {name}'.encode() for file, n, name in frames)]


def test_a_loop_is_shown_where_it_begins(submission: Submission) -> None:
    file = str(submission.root / "a.py")
    for line in (1, 2):
        conduct = told(submission, *dump(submission, (file, line, "<module>")))
        assert conduct.stop is not None
        assert conduct.stop.place is not None
        assert (conduct.stop.place.line, conduct.stop.place.text) == (1, "while True:")
        assert conduct.stop.time_s == 1.5


def test_a_process_that_waits_for_a_processor_is_heard_to_the_end(
    submission: Submission, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = iter(dump(submission, (str(submission.root / "a.py"), 2, "<module>")))
    with open_evidence() as pipe:
        # each look finds it where the last one did; every fifth time it has come to a line more
        looks = count(1)

        def look(pid: int) -> usage.Usage:
            number = next(looks)
            line = next(lines, None) if number % 5 == 0 else None
            if line is not None:
                os.write(pipe.descriptor, line + b"\n")
            return usage.Usage(0.0 if number < 20 else number, "R")

        monkeypatch.setattr(evidence.usage, "look", look)
        monkeypatch.setattr(evidence, "asking_signal", lambda: signal.SIGCONT)
        monkeypatch.setattr(evidence, "QUIET_S", 0.01)
        monkeypatch.setattr(evidence, "PATIENCE_S", 0.01)
        pipe.ask(os.getpid())
        said = pipe._data.splitlines()
    assert len(said) == 2


def test_what_lies_beside_a_submission_is_none_of_its_own(submission: Submission) -> None:
    file = f"{submission.root}/../secret.py"
    assert told(submission, *dump(submission, (file, 1, "f"))) == Conduct(is_told=True)
    for name in ("../secret.py", "/etc/passwd", "a/../../b.py"):
        place = {**PLACE, "file": name}
        assert told(submission, say(end={**END, "place": place})) == Conduct()


NESTED = """\
def drive():
    for turn in range(4):
        while True:
            if turn:

    # a comment
                step(turn)
    return 1

x = 2
""".splitlines()


@pytest.mark.parametrize(("line", "found"), [(7, [3, 2]), (3, [3, 2]), (2, [2]), (8, []), (10, [])])
def test_the_loops_round_a_line_are_found_by_indentation(line: int, found: list[int]) -> None:
    assert loops.around(NESTED, line) == found


SPIN = loops.Seen("/x/rclpy/executors.py", "spin_once", 9, None)
FOR_EVER = loops.Seen("/x/rclpy/__init__.py", "spin", 9, None)
CALLBACK = loops.Seen("/x/rclpy/task.py", "__call__", 9, None)
SLEEP = loops.Seen("/x/time.py", "sleep", 9, None)


def at(line: int, function: str = "drive") -> loops.Seen:
    return loops.Seen("/a/a.py", function, line, NESTED)


@pytest.mark.parametrize(
    ("frames", "found"),
    [
        ([SPIN, at(8)], None),
        ([SPIN, at(7)], None),
        ([SLEEP, at(7)], loops.Standing("going", 1, 3)),
        ([SLEEP, at(7), CALLBACK, SPIN, at(8)], loops.Standing("going", 1, 3)),
        ([SLEEP, at(8)], None),
        ([SPIN, at(8, "__init__"), at(10, "<module>")], loops.Standing("init", 1, 8)),
        ([SLEEP, at(8), at(7, "__init__")], loops.Standing("init", 2, 3)),
        ([FOR_EVER, at(7, "__init__")], loops.Standing("init", 1, 7)),
        ([FOR_EVER, at(7)], loops.Standing("spin", 1, 7)),
        ([FOR_EVER, at(8)], None),
        ([SLEEP], None),
    ],
)
def test_where_a_main_thread_is_at_the_end_is_told_unless_it_just_spins(
    frames: list[loops.Seen], found: loops.Standing | None
) -> None:
    assert loops.standing(frames) == found
