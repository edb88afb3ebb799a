"""Real submissions with a beginner's mistake: the first line of the report names the cause."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import yaml

from grader.diagnosis.diagnose import diagnose
from grader.diagnosis.diagnosis import Diagnosis
from grader.recording.recording import Recordings
from grader.run import virtual_time
from grader.run.plan import Plan
from grader.run.simulator.link import Patience
from grader.scenes.scene import Limits
from grader.submission.opening import open_submission
from tests.grader.language.holes import holes

SUBMISSIONS = Path(__file__).parents[2] / "submissions"
TABLE: dict[str, dict[str, Any]] = yaml.safe_load(
    (SUBMISSIONS / "first_lines" / "first_lines.yaml").read_text(encoding="utf-8")
)
LIMITS = Limits(first_motion_s=3, rest_s=1, total_s=10)
#: What loops for ever is not waited for as long as a student's imports would be.
PATIENCE = Patience(stall_cpu_s=0.5, start_cpu_s=4.0)


def found_in(path: Path) -> Diagnosis | None:
    """The diagnosis of one run."""
    with open_submission(path) as submission:
        recording = virtual_time.run(submission, Plan(LIMITS), patience=PATIENCE)
    return diagnose(Recordings(recording))


@pytest.fixture(scope="module")
def diagnoses(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Future[Any]]]:
    """Of all of them, each run once."""
    folder = tmp_path_factory.mktemp("first_lines")
    paths = {}
    for name, row in TABLE.items():
        paths[name] = SUBMISSIONS / ("" if "/" in name else "first_lines") / f"{name}.py"
        if "source" in row:
            paths[name] = folder / f"{name}.py"
            paths[name].write_bytes(row["source"].encode(row.get("encoding", "utf-8")))
    with ThreadPoolExecutor(2) as pool:
        yield {name: pool.submit(found_in, path) for name, path in paths.items()}
        pool.shutdown(cancel_futures=True)


@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", TABLE)
def test_the_first_line_is_the_cause(diagnoses, name):
    found, row = diagnoses[name].result(), TABLE[name]
    assert found is not None
    said = f"{found.cause} {found.help}"
    begin = 0
    for piece in row["says"]:
        assert piece in said[begin:], f"{found.key}: {said}"
        begin = said.index(piece, begin) + len(piece)
    assert found.key == row["key"], said


@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", TABLE)
def test_the_first_line_is_said_in_other_languages(diagnoses, name):
    found = diagnoses[name].result()
    for language in ("fr", "zh"):
        assert holes(found.cause, language) == holes(found.help, language) == []
