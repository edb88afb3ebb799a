import json
from dataclasses import asdict, replace
from datetime import UTC, datetime, timedelta

import pytest
from hypothesis import given

from grader import reports
from grader.errors import UsageError
from grader.exercise.loading import load_exercise
from grader.exercise.policies import LatePolicy
from grader.exercise.result.diagnosis import Diagnosis
from grader.exercise.result.result import (
    Judging,
    Result,
    ResultProvenance,
    RunSummary,
    SubmissionInfo,
    build,
)
from grader.exercise.verdict import Evidence, Verdict
from grader.recording.observations import SourceLine
from grader.recording.recording import Provenance, Recordings, Run, Start
from grader.system.strict_json import to_json
from grader.text.message import NOTHING, Message, authored, joined, msg
from tests.grader.driving import Spiral, drive
from tests.grader.reports import samples
from tests.grader.reports.drawn import any_results


@given(made=any_results())
def test_whatever_follows_the_schema_can_be_read_and_written_again(made):
    found = Result.from_json(made).to_json()
    for run in (made["run"], *made["varied_runs"]):
        run["seed"] = None
    for verdict in made["verdicts"]:
        for item in verdict["evidence"]:
            item.setdefault("run", 0)
    # as text: a place can be not a number, which equals nothing
    assert json.dumps(found, sort_keys=True) == json.dumps(made, sort_keys=True)


def test_what_may_be_left_out_has_its_usual_value_and_a_whole_number_may_be_a_float():
    run = samples.run(ticks=100.0, exit_code=1.0)
    evidence = samples.evidence(tick=5.0)
    result = Result.from_json(samples.result(samples.verdict("a", evidence=[evidence]), run=run))
    assert (result.varied_runs, result.diagnosis) == ((), None)
    assert (result.run.seed, result.run.start) == (None, None)
    assert repr((result.run.ticks, result.run.exit_code)) == "(100, 1)"
    found = result.verdicts[0].evidence[0]
    assert repr((found.tick, found.run)) == "(5, 0)"


def test_everything_comes_back_as_it_was(tmp_path):
    seen = (Evidence(0.016, msg("n {at}", at=2), 2.0, 3.0, 1, tick=1),)
    words = (Message.of("seen {as} it is"), msg("{n} help", "{n} helps", n=2))
    title = authored("A").translated("fr", "Â")
    verdict = Verdict("a", title, "failed", 1.5, 4.0, *words, seen, ("b",))
    run = RunSummary(exit_code=-9, outcome="killed", ticks=3, flags=(msg("x"),), seed=5)
    varied = replace(run, seed=None, start=Start(1.0, 2.0, 3.0), interfaces="moon_msgs")
    place = SourceLine("d.py", 3, "f", "x = 1")
    cause = Diagnosis("k", joined([msg("cause"), "!"]), msg("help"), 1, 0.0, place, "a")
    parts = ((verdict,), run, (varied,), {"canvas": "c.png"})
    result = Result("e", "größe 🐢", 1.5, 4.0, *parts, diagnosis=cause)
    path = tmp_path / "new" / "result.json"
    result.write(str(path))
    data = json.loads(path.read_text(encoding="utf-8"))
    assert ["interfaces" in each for each in (data["run"], *data["varied_runs"])] == [False, True]
    assert Result.read(str(path)) == result
    path.write_text(path.read_text(encoding="utf-8"), encoding="utf-8-sig")
    assert Result.read(path) == result


RECORDED = Provenance("2026-11-21T23:52:52Z", "0.1.0", "3.12.3", "7.1.6", seed=7)
JUDGED = Judging("2026-11-22T10:00:00Z", "0.2.0", "b" * 64)


@pytest.mark.parametrize("recorded", [RECORDED, None])
def test_where_it_comes_from_is_told_and_makes_no_other_result_of_it(tmp_path, recorded):
    result = Result.from_json(samples.result())
    told = replace(result, provenance=ResultProvenance(JUDGED, recorded))
    told.write(tmp_path / "result.json")
    assert Result.read(tmp_path / "result.json").provenance == told.provenance
    assert told == result
    assert result.provenance is None


@pytest.mark.parametrize(
    "change",
    [
        {"provenance": {}},
        {"provenance": {"judged": {**asdict(JUDGED), "date": "today"}}},
        {"provenance": {"judged": asdict(JUDGED), "recorded": {"grader": "0.1.0"}}},
        {"more": 1},
        {"score": "100"},
        {"score": -1},
        {"schema": "turtlesim-grader/result/v2"},
        {"run": {"time": "virtual"}},
        {"verdicts": [samples.verdict("a", more=1)]},
        {"artifacts": {"canvas": 1}},
        {"diagnosis": samples.diagnosis(run=-1)},
        {"diagnosis": samples.diagnosis(time_s=-1.0)},
        {"diagnosis": samples.diagnosis(place={"file": "a"})},
        {"handed_in": {}},
    ],
)
def test_what_does_not_follow_the_schema_is_refused(tmp_path, change):
    with pytest.raises(ValueError, match="is no result of turtlesim-grader/result/v1: "):
        Result.from_json(samples.result() | change)
    path = tmp_path / "x.json"
    path.write_text(json.dumps(samples.result() | change))
    with pytest.raises(UsageError, match=r"x\.json is no result of"):
        Result.read(path)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"score": 5}, "its score is 5, that of its verdicts 10"),
        ({"max_score": 20}, "its max_score is 20, that of its verdicts 10"),
        ({"verdicts": [samples.verdict("a")] * 2}, "two verdicts of the check 'a'"),
        ({"score": float("nan")}, "NaN is no number"),
        ({"score": 10**400}, "is no number"),
    ],
)
def test_what_somebody_has_changed_is_refused(tmp_path, change, why):
    path = tmp_path / "x.json"
    path.write_text(json.dumps(samples.result(samples.verdict("a")) | change))
    for read in (Result.read, reports.read):
        with pytest.raises(UsageError, match=r"x\.json is .*damaged") as error:
            read(path)
        assert why in str(error.value)


@pytest.mark.parametrize("name", ["result", "error"])
def test_another_version_is_told(tmp_path, name):
    path = tmp_path / "x.json"
    path.write_text(json.dumps({"schema": f"turtlesim-grader/{name}/v9"}))
    with pytest.raises(UsageError, match=f"of another version, turtlesim-grader/{name}/v9"):
        reports.read(path)


@pytest.mark.parametrize("text", ["{", "", "[" * 100_000, "\udcff"])
def test_what_is_no_json_is_refused(tmp_path, text):
    path = tmp_path / "x.json"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(UsageError, match=r"x\.json is not JSON"):
        Result.read(path)
    with pytest.raises(UsageError, match=r"cannot read .*y\.json: No such file"):
        Result.read(tmp_path / "y.json")


def test_a_result_adds_up_its_verdicts_and_remarks_on_its_runs():
    recording = drive(Spiral(), ticks=50)
    crashed = replace(recording, run=replace(recording.run, outcome="crashed", exit_code=1))
    verdicts = [Verdict(n, msg(n), "failed", 3.33, 10.0, NOTHING) for n in ("a", "b", "c")]
    exercise = load_exercise("turtlesim_challenge")
    varied = replace(recording, start=Start(1.0, 2.0, 0.5))
    result = build("s", exercise, Recordings(crashed, (varied,)), verdicts)
    assert (result.exercise, result.score, result.max_score) == ("turtlesim_challenge", 9.99, 30)
    assert tuple(map(str, result.run.flags)) == ("The node ended with an error: exit code 1.",)
    assert isinstance(result.run, Run)
    assert result.varied_runs[0].start == Start(1.0, 2.0, 0.5)
    assert "start" not in to_json(result.run)
    assert result.provenance.judged.exercise_sha256 == exercise.sha256


DUE = datetime(2026, 11, 30, 22, 59, tzinfo=UTC)
POLICY = LatePolicy(DUE, 10, 10, 50)
LATE = SubmissionInfo.of("4711", "Zoë Müller", 2, DUE + timedelta(days=1, hours=3), POLICY)


@pytest.mark.parametrize(("score", "final"), [(87.5, 67.5), (20, 0), (3.25, 0)])
def test_the_final_score_is_what_lateness_leaves_and_never_below_nothing(score, final):
    listed = [samples.verdict("a", "failed", score, max_score=100)]
    result = Result.from_json(samples.result(*listed) | {"handed_in": to_json(LATE)})
    assert (result.score, result.final) == (score, final)
    assert result.handed_in == LATE
    assert Result.from_json(result.to_json()) == result


def test_what_lateness_costs_is_what_the_policy_says():
    assert (LATE.at.isoformat(), LATE.late_s) == ("2026-12-02T01:59:00+00:00", 97_200)
    assert (LATE.days, LATE.deducted) == (2, 20)
    assert LATE.by(LatePolicy(DUE, 0, 1, 50)).deducted == 2
    assert LATE.by(None).deducted == 0
    assert LatePolicy(DUE, 0, 0, 100).deduction(DUE.replace(year=2027)).points == 0
    assert Result.from_json(samples.result()).final == 18.33
    for at, policy, final in ((DUE, None, 18.33), (DUE, POLICY, 18.33), (None, POLICY, 8.33)):
        told = to_json(SubmissionInfo.of("4711", "", 1, at, policy))
        assert Result.from_json(samples.result() | {"handed_in": told}).final == final


@pytest.mark.parametrize("at", ["2026-12-02T01:59:00", "soon"])
def test_a_time_without_a_zone_is_no_time(at):
    data = samples.result() | {"handed_in": to_json(LATE) | {"at": at}}
    with pytest.raises(ValueError, match=at):
        Result.from_json(data)
