"""Results and recordings that teachers have on their disks stay usable: tests/kept, never renewed.

What is promised stands in docs/reports.md, "What the versions promise".
"""

import json
import shutil

import jsonschema
import pytest

from grader.cli import main
from grader.reports import read as read_report
from grader.reports import render
from tests.files import untar
from tests.grader.reports.readers import READERS
from tests.grader.reports.samples import CLASSROOM50, FORMATS
from tests.once import ROOT, folder
from tests.tiers import others_are_more

KEPT = ROOT / "tests" / "kept"
SCHEMAS = {
    "result": ROOT / "grader" / "exercise" / "result" / "result.schema.json",
    "error": ROOT / "grader" / "exercise" / "result" / "error.schema.json",
    "recording": ROOT / "grader" / "recording" / "recording.schema.json",
}
OTHERS = ("spiral", "programs", "peers", "cases", "real_time")
#: tests/grader_robots has these judged.
OF_ROBOTS = ("package", "robot")
#: Folder of a result -> the rubric by which it was judged, in its archive or beside it: the
#: points of an installed exercise may change.
RESULTS = {
    **{name: f"{name}/rubric.yaml" for name in (*OTHERS, *OF_ROBOTS)},
    **dict.fromkeys((f"class/submissions/{who}" for who in ("anna", "ben", "chen")), "before.yaml"),
}


def unpacked():
    """All that was kept; read it, or copy it."""

    def unpack(folder):
        for rubric in KEPT.glob("*.yaml"):
            shutil.copy(rubric, folder)
        for archive in KEPT.glob("*.tar.xz"):
            untar(archive, folder)

    return folder(unpack, "kept", made_by=("tests/kept",))


@pytest.fixture
def classroom(monkeypatch):
    for variable, value in CLASSROOM50.items():
        monkeypatch.setenv(variable, value)


def stored(path):
    return json.loads(path.read_text(encoding="utf-8"))


def judged(path):
    """What a judging decides, without its words, the first line and when that was."""
    result = stored(path)
    points = ("check", "status", "score", "max_score", "depends_on")
    runs = [result["run"], *result["varied_runs"]]
    return {
        "verdicts": [{name: verdict[name] for name in points} for verdict in result["verdicts"]],
        "runs": [{name: run[name] for name in run.keys() - {"flags"}} for run in runs],
        **{name: result.get(name) for name in ("exercise", "score", "max_score", "handed_in")},
    }


def expect_judged_as_then(name, folder):
    exercise, again = str(unpacked() / RESULTS[name]), folder / "again.json"
    words = ["--exercise", exercise, "--json", str(again)]
    assert main(["check", str(unpacked() / name), *words]) == 0
    assert judged(again) == judged(unpacked() / name / "result.json")


@pytest.mark.parametrize("name", [name for name in RESULTS if name not in OF_ROBOTS])
def test_it_is_judged_as_it_was_then(name, tmp_path):
    expect_judged_as_then(name, tmp_path)


@pytest.mark.parametrize(
    "name",
    others_are_more("only the page knows scenes", RESULTS, "spiral", "class/submissions/chen"),
)
def test_every_report_can_be_made_of_it_with_the_score_of_then(name, classroom):
    path = unpacked() / name / "result.json"
    result = stored(path)
    for format in FORMATS:
        content = render(format, [read_report(path, view="whole")])
        if "chen" not in name:  # late; the readers add up checks
            assert READERS[format](content) == result["score"], format


def test_it_can_be_played(tmp_path):
    page = tmp_path / "view.html"
    assert main(["view", str(unpacked() / "spiral"), "--out", str(page), "--no-open"]) == 0
    assert page.stat().st_size > 10_000


def test_it_follows_the_schema_of_today():
    for kind, pattern in (("result", "result.json"), ("recording", "run.json")):
        found = list(unpacked().rglob(pattern))
        assert len(found) >= len(RESULTS)
        valid = jsonschema.Draft202012Validator(stored(SCHEMAS[kind]))
        assert [str(path) for path in found if not valid.is_valid(stored(path))] == []


def test_an_error_follows_the_schema_of_today_and_is_in_every_report(classroom):
    jsonschema.validate(stored(KEPT / "error.json"), stored(SCHEMAS["error"]))
    for format in FORMATS:
        assert render(format, [read_report(KEPT / "error.json", ("moves",))])


def broken(then, now, at=""):
    """The places where a schema of today is more than the one of then with optional fields."""
    if isinstance(then, dict) and isinstance(now, dict):
        grows = at.endswith(("/properties", "/$defs"))
        here = [f"{at}/{key}" for key in now.keys() - then.keys() - {"description"} if not grows]
        gone = [f"{at}/{key}" for key in then.keys() - now.keys() - {"description"}]
        both = sorted(then.keys() & now.keys() - {"description", "title"})
        deeper = (broken(then[key], now[key], f"{at}/{key}") for key in both)
        return [*here, *gone, *(each for found in deeper for each in found)]
    if at.endswith(("/outcome/enum", "/visible/enum")):
        return [] if set(then) <= set(now) else [at]
    return [] if then == now else [at]


@pytest.mark.parametrize("kind", SCHEMAS)
def test_a_schema_has_only_gained_optional_fields(kind):
    assert broken(stored(KEPT / f"{kind}.schema.json"), stored(SCHEMAS[kind])) == []


def test_what_a_reader_relies_on_cannot_go_unnoticed():
    then = stored(KEPT / "result.schema.json")
    for change in (
        lambda now: now["properties"].pop("score"),
        lambda now: now["required"].append("provenance"),
        lambda now: now["$defs"]["run"]["properties"]["outcome"]["enum"].remove("killed"),
        lambda now: now["properties"]["exercise"].update(maxLength=8),
    ):
        now = stored(KEPT / "result.schema.json")
        change(now)
        assert len(broken(then, now)) == 1
    then["properties"].pop("provenance")  # new, and optional
    assert broken(then, stored(KEPT / "result.schema.json")) == []
