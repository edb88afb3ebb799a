import io
import re
from pathlib import Path

import pytest
from rich.console import Console

from grader.reports import terminal
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict


def shown(result, width=80):
    out = io.StringIO()
    terminal.show(samples.report_in(Path(), result), Console(file=out, width=width))
    return out.getvalue()


@pytest.mark.parametrize("rationale", ["word " * 60, "[bold]x[/bold] [/red] [1]"])
def test_the_first_line_is_the_first_thing_to_mend_uncut_and_as_it_is(rationale):
    text = shown(samples.result(verdict("a", "failed", 0, rationale=rationale)))
    assert text.splitlines()[0] == f"Fix this first: {rationale.strip()}"
    text = shown(samples.result(verdict("a")))
    assert text.startswith("Nothing to fix: the only check passed.\n")


def test_the_verdict_is_there_before_any_file_is_written(capfd):
    def write():
        said = capfd.readouterr().out
        assert said.startswith("Fix this first: ")
        assert "Score: " in said
        return Path("report.html")

    terminal.show_first(samples.report(verdict("a", "failed", 0)), write)
    assert capfd.readouterr().out == "The page with picture and plots: report.html\n"


def test_in_a_terminal_the_first_line_is_wrapped_at_words():
    out = io.StringIO()
    report = samples.report(verdict("a", "failed", 0, rationale="word " * 60))
    terminal.show(report, Console(file=out, width=80, force_terminal=True, color_system=None))
    lines = out.getvalue().splitlines()
    assert {*" ".join(lines[:4]).split()} == {"Fix", "this", "first:", "word"}
    assert max(map(len, lines)) <= 80


@pytest.mark.parametrize("width", [80, 120])
def test_it_stays_within_the_terminal(width):
    verdicts = [verdict(f"a_long_name_of_check_{i}", title="word " * 20) for i in range(7)]
    text = shown(samples.result(*verdicts), width)
    assert max(map(len, text.splitlines())) <= width
    assert "a_long_name_of_check_6" in text and "10 / 10" in text


def test_at_80_columns_a_usual_check_is_one_line():
    title = "Stops near an edge, wherever it starts"
    lines = shown(samples.result(verdict("edge_stop", "failed", 0, title=title))).splitlines()
    assert lines[3].rstrip() == f" ✗ failed  0 / 10  {title}  edge_stop"


def test_a_title_that_leaves_no_room_for_the_name_stands_alone_in_its_line():
    titles = {"a": "A title of an ordinary length", "b": "t" * 58}
    text = shown(samples.result(*[verdict(name, title=title) for name, title in titles.items()]))
    assert text.splitlines()[3].rstrip() == f" ✓ passed  10 / 10  {titles['a']}"
    assert text.splitlines()[4].rstrip() == f" ✓ passed  10 / 10  {titles['b']}"


def test_all_that_wait_for_the_same_share_a_line():
    waiting = [verdict(name, "not_judged", 0, depends_on=["moves"]) for name in "abc"]
    text = shown(samples.result(verdict("moves", "failed", 0), *waiting))
    assert " – not judged, since “Title of moves” did not pass: a, b, c (30 points)\n" in text
    assert text.count("not judged") == 1


def test_no_advice_of_a_check_contradicts_the_first_line():
    other = verdict("b", "failed", 0, evidence=[samples.evidence(run=1)])
    judged = samples.result(
        verdict("a", "failed", 0),
        verdict("c", "failed", 0),
        other,
        diagnosis=samples.diagnosis(),
        varied_runs=[samples.run()],
    )
    text = shown(judged)
    assert text.count("→ See the first line.") == 1
    assert "Help for a." not in text
    assert "Help for c." not in text
    assert "→ Help for b." in text  # of a run in which there was no such cause
    repeated = samples.diagnosis(key="check", check="a")
    assert "→ Help for a." in shown(samples.result(verdict("a", "failed", 0), diagnosis=repeated))


def test_what_several_checks_say_stands_once_below_their_titles():
    same = {"rationale": "Nothing came.", "help": "Does it publish?"}
    text = shown(
        samples.result(verdict("a", "failed", 0, **same), verdict("b", "failed", 0, **same))
    )
    titles = "✗ Title of a: 0 / 10\n✗ Title of b: 0 / 10\n  Nothing came."
    assert titles in "\n".join(line.rstrip() for line in text.splitlines())
    assert text.count("→ Does it publish?") == 1


def test_a_check_without_a_title_is_called_by_its_name():
    text = shown(samples.result(verdict("a", "failed", 0, title="")))
    assert " ✗ failed  0 / 10  a" in text
    assert "✗ a: 0 / 10" in text


def test_partial_credit_notes_and_what_a_check_waits_for_are_shown():
    text = shown(samples.result())
    assert "8.33 / 10" in text
    assert "partial credit" in text
    assert "“Title of stops” did not pass: rests (10 points)" in text
    assert "Score: 18.33 of 40" in text
    flagged = samples.run(flags=["seen twice"])
    assert "Note: seen twice" in shown(samples.result(run=flagged))
    spoiled = verdict("a", "not_judged", 0, rationale="The run was spoiled.")
    assert "– Title of a: 0 / 10\n  The run was spoiled." in shown(samples.result(spoiled))


def test_a_submission_cannot_speak_to_the_runner_of_a_ci_system():
    rationale = "x\n::error file=a.py::boo ::stop-commands::t ##[error]no ##vso[task.x]"
    lines = shown(samples.result(verdict("a", "failed", 0, rationale=rationale)), 20).splitlines()
    assert not [line for line in lines if "::" in line or "##" in line]


def test_colours_say_nothing_that_the_words_do_not():
    report = samples.report(verdict("a"), verdict("b", "failed", 0))
    coloured, plain = io.StringIO(), io.StringIO()
    for file, system in ((coloured, "standard"), (plain, None)):
        terminal.show(report, Console(file=file, width=100, color_system=system))
    assert "\x1b[3" in coloured.getvalue()
    assert re.sub(r"\x1b\[[0-9;]*m", "", coloured.getvalue()) == plain.getvalue()
