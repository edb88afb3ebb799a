"""What comes from a submission's process is believed by its form, or not at all."""

import json
import os
import random
import signal
from contextlib import closing
from dataclasses import replace
from itertools import count

import pytest

from grader.recording.observations import LintFinding, Observations, SourceLine
from grader.run import evidence
from grader.run.evidence import EvidencePage
from grader.run.observe import account
from grader.run.opening import open_submission
from grader.submission.start import Submission
from grader.system import linux
from tests.children import in_child

PLACE = {"file": "a.py", "line": 2, "function": "", "text": "pass"}
END = {
    **{"kind": "publisher", "name": "/a", "type": "a/msg/B", "is_met": True, "used": 4},
    **{"place": PLACE, "used_at": None, "lines": [], "sent": []},
}
ACCOUNT = {
    **{"is_blind": False, "ends": [END], "waits": [], "slow": [], "timers": [], "caught": []},
    **{"ran": [], "spun_s": 0.5, "stop": None, "raised": None, "returned_s": 1},
}


@pytest.fixture(scope="module")
def submission(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alice")
    (folder / "a.py").write_text("while True:\n    pass\n")
    with open_submission(folder) as opened:
        yield opened


def told(submission: Submission, account: bytes = b"", dumped: bytes = b"") -> Observations:
    """What is believed of what stands in the page."""
    with closing(EvidencePage()) as evidence:
        if account:
            put(evidence.page, 1, account)
        os.write(evidence.page, dumped)
        return evidence.observations(submission, 1.5, computes=True)


def put(page: int, number: int, data: bytes, length: int | None = None) -> None:
    """Write a half of the page, as anybody may."""
    length = len(data) if length is None else length
    head = account._HEAD.pack(account._checksum(number, data), number, length, False)
    os.pwrite(page, head + data[: account.MOST_BYTES], account.HALVES[number % 2])


def say(**changes: object) -> bytes:
    return json.dumps({**ACCOUNT, **changes}).encode()


def test_what_stands_in_the_account_is_told(submission):
    observations = told(submission, say())
    assert observations.is_known
    assert [(end.name, end.used, end.is_met) for end in observations.ends] == [("/a", 4, True)]
    assert (observations.spun_s, observations.returned_s) == (0.5, 1.0)


def test_from_which_lines_was_sent_what_is_told_in_order_if_it_can_have_been_sent_from_there(
    submission,
):
    lines = [PLACE, {**PLACE, "line": 1}]
    sent = [{"line": 0, "times": 104}, {"line": 1, "times": 1}]
    (end,) = told(submission, say(ends=[{**END, "lines": lines, "sent": sent}])).ends
    assert [place.line for place in end.lines] == [2, 1]
    assert [(burst.line, burst.times) for burst in end.sent] == [(0, 104), (1, 1)]
    for lines, sent in (
        *(([PLACE], [{"line": line, "times": 1}]) for line in (1, True)),
        *(([PLACE], [{"line": 0, "times": times}]) for times in (-1, 1.5)),
        *(([PLACE], wrong) for wrong in (7, [{"line": 0, "times": 1}] * 201)),
        ([{**PLACE, "file": "../b.py"}], []),
        (PLACE, []),
    ):
        assert told(submission, say(ends=[{**END, "lines": lines, "sent": sent}])) == Observations()


def test_what_was_seen_of_timers_and_exceptions_is_believed_by_its_form(submission):
    timer = {"place": PLACE, "period_s": 0.1, "times": 4}
    caught = {"type": "E", "text": "", "time_s": 1, "times": 2, "place": PLACE}
    right = {"ends": [{**END, "used_at": PLACE}], "timers": [timer], "caught": [caught]}
    observations = told(submission, say(**right))
    assert [each.times for each in observations.timers] == [4]
    assert [(each.type, each.times) for each in observations.caught] == [("E", 2)]
    assert observations.ends[0].used_at is not None
    assert Observations.from_json(json.loads(json.dumps(observations.to_json()))) == observations
    for wrong in (
        {"timers": [{**timer, "period_s": -1}]},
        {"caught": [{**caught, "times": 0.5}]},
        {"caught": [caught] * 101},
        {"ends": [{**END, "used_at": [7, PLACE]}]},
    ):
        assert told(submission, say(**{**right, **wrong})) == Observations()


def test_what_the_source_shows_is_said_by_who_has_read_it_and_by_no_process(submission):
    place = SourceLine("a.py", 3, "", "self.stoped = True")
    read = replace(submission, lint_findings=(LintFinding("unread", "stoped", "stopped", place),))
    (found,) = told(read, say()).lint_findings
    assert (found.kind, found.name, found.near) == ("unread", "stoped", "stopped")
    assert found.place == place
    assert told(read) == Observations()
    forged = {"kind": "unread", "name": "a", "near": "b", "place": PLACE}
    assert told(read, say(lint_findings=[forged])).lint_findings == (found,)


NONSENSE = (
    *(b"{", b"\xff", b"[]", b"3", b"null", b"{}", b"[" * 20_000, b""),
    *(say(spun_s=True), say(spun_s=-1), say(spun_s="1"), say(ends=None), say(ends=[3])),
    say().replace(b'"spun_s": 0.5', b'"spun_s": NaN'),
    say().replace(b'"spun_s": 0.5', b'"spun_s": 1e999'),
    *(say(unheard_of=1), say(is_blind=True), say(ends=[{}]), say(stop={"place": None})),
    *(say(ends=[{**END, "kind": "friend"}]), say(ends=[{**END, "name": "x" * 301}])),
    *(say(ends=[END] * 101), say(waits=[{}]), say(slow=[1]), say(is_known=False, extra=1)),
    say(ends=[{**END, "place": {**PLACE, "line": "2"}}]),
)


def test_of_a_process_that_tells_nonsense_or_nothing_nothing_is_told(submission):
    for text in NONSENSE:
        assert told(submission, text) == Observations(), text


@pytest.fixture
def evidence_page():
    with closing(EvidencePage()) as made:
        yield made


def test_the_newest_half_that_is_whole_counts(submission, evidence_page):
    page = evidence_page.page
    for number in (1, 2, 3):
        put(page, number, say(spun_s=number))
    os.pwrite(page, b"?", account.HALVES[1] + 100)  # killed in the middle of writing
    assert evidence_page.observations(submission, 1.5, computes=True).spun_s == 2


@pytest.mark.parametrize("length", [0, 1, 2**31, 2**32 - 1])
def test_a_length_that_is_none_is_not_believed(submission, evidence_page, length):
    put(evidence_page.page, 1, say(), length)
    assert evidence_page.observations(submission, 1.5, computes=True) == Observations()


def test_nobody_makes_the_page_longer_or_shorter(evidence_page):
    for size in (0, 10 * account.HALF_BYTES):
        with pytest.raises(PermissionError):
            os.ftruncate(evidence_page.page, size)


@pytest.fixture
def page():
    made = account.make()
    yield made
    os.close(made)


def kept(page, told):
    """What of an account comes through the page, as a process writes it."""
    account.ProcessAccount(page, lambda: json.loads(json.dumps(told))).write()
    return json.loads(account.read(page)[0])


def test_what_there_is_no_room_for_is_left_out_in_an_order(page):
    slow = [{"place": PLACE, "longest_s": 0.1, "times": n} for n in range(600)]
    found = kept(page, {**ACCOUNT, "slow": slow, "timers": [1]})
    assert (found["slow"], found["timers"], found["ends"]) == ([], [1], [END])


def test_of_too_many_ends_the_first_are_told(page):
    found = kept(page, {**ACCOUNT, "ends": [END] * 500, "waits": [1]})
    assert 100 < len(found["ends"]) < 500
    assert (found["waits"], found["returned_s"]) == ([], 1)


def test_a_fork_tells_nothing(page):
    writer = account.ProcessAccount(page, lambda: {"ends": []})
    writer.write()
    in_child(writer.write)
    assert len({os.pread(page, 16, begin) for begin in account.HALVES} - {bytes(16)}) == 1


def test_the_last_one_is_known_as_such(page):
    writer = account.ProcessAccount(page, dict)
    for is_last in (False, True):
        writer.write(is_last=is_last)
        assert account.read(page)[1] is is_last


def test_what_a_program_has_opened_in_its_place_is_left_alone(page, tmp_path):
    writer = account.ProcessAccount(page, dict)
    with (tmp_path / "its own").open("wb") as other:
        os.dup2(other.fileno(), page)
        writer.write()
    assert (tmp_path / "its own").read_bytes() == b""


def test_the_more_often_something_changes_the_less_often_it_is_written(page):
    written: list[int] = []
    writer = account.ProcessAccount(page, lambda: {"n": written.append(1)})
    for _ in range(100_000):
        writer.changed()
    assert len(written) < 60


def test_texts_are_told_in_one_line_that_can_be_shown(submission):
    text = "red \x1b[31m\nand\ud800\u202e"
    raised = {"type": "Error", "text": text, "time_s": 1, "place": None}
    assert told(submission, say(raised=raised)).raised.text == "red ?[31m and??"


def test_bytes_of_any_kind_are_never_our_failure(submission):
    chance = random.Random(12)
    whole = say()
    for _ in range(300):
        data = bytearray(whole)
        for _ in range(chance.randint(1, 6)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        told(submission, bytes(data), bytes(data))


def test_a_dump_has_so_much_room_and_no_more(submission, evidence_page):
    put(evidence_page.page, 1, say())
    sent = 0
    with pytest.raises(PermissionError):
        while True:
            sent += os.write(evidence_page.page, b"x" * 1000)
    assert sent == account.DUMP_BYTES
    assert evidence_page.observations(submission, 0.0, computes=True).is_known


def dump(*frames: tuple[str, int, str]) -> bytes:
    head = b"Current thread 0x00007f (most recent call first):"
    lines = (f'  File "{file}", line {n} in {name}'.encode() for file, n, name in frames)
    return b"".join(line + b"\n" for line in (head, *lines))


def test_a_loop_is_shown_where_it_begins(submission):
    file = str(submission.root / "a.py")
    for line in (1, 2):
        stop = told(submission, b"", dump((file, line, "<module>"))).stop
        assert stop.place == SourceLine("a.py", 1, "", "while True:")
        assert stop.time_s == 1.5


def test_a_process_that_waits_for_a_processor_is_heard_to_the_end(
    submission, evidence_page, monkeypatch
):
    lines = iter(dump((str(submission.root / "a.py"), 2, "<module>")).splitlines())
    # each look finds it where the last one did; every fifth time it has come to a line more
    looks = count(1)

    def look(pid: int) -> linux.ProcessStat:
        number = next(looks)
        line = next(lines, None) if number % 5 == 0 else None
        if line is not None:
            os.write(evidence_page.page, line + b"\n")
        return linux.ProcessStat(0.0 if number < 20 else number, "R")

    monkeypatch.setattr(evidence.linux, "process_stat", look)
    monkeypatch.setattr(account, "DUMP_SIGNAL", signal.SIGCONT)
    monkeypatch.setattr(evidence, "QUIET_S", 0.01)
    monkeypatch.setattr(evidence, "PATIENCE_S", 0.01)
    evidence_page.request_dump(os.getpid())
    assert len(account.dumped(evidence_page.page).splitlines()) == 2


def test_a_link_that_leads_to_itself_or_out_is_no_source(submission):
    for name, to in (("itself.py", "itself.py"), ("out.py", "/etc/passwd")):
        link = submission.root / name
        link.symlink_to(to)
        found = told(submission, b"", dump((str(link), 1, "f"))).stop
        assert found.place == SourceLine(name, 1, "f", "")
        link.unlink()


def test_what_lies_beside_a_submission_is_none_of_its_own(submission):
    file = f"{submission.root}/../secret.py"
    assert told(submission, b"", dump((file, 1, "f"))) == Observations(is_known=True)
    for name in ("../secret.py", "/etc/passwd", "a/../../b.py"):
        place = {**PLACE, "file": name}
        assert told(submission, say(ends=[{**END, "place": place}])) == Observations()
