"""Results to be shown, and recordings to lie beside them."""

import base64
import json
from pathlib import Path

from grader.exercise.result.result import Result
from grader.recording import saving
from grader.recording.recording import Recordings
from grader.reports import Artifacts, Report, render
from grader.reports.formats import names

#: The formats that are installed.
FORMATS = names()

#: The environment that Classroom 50 gives to an autograder.
CLASSROOM50 = {
    "CLASSROOM": "ros-1",
    "ASSIGNMENT": "spiral",
    "ASSIGNMENT_TYPE": "individual",
    "OWNER": "ada",
    "SUBMISSION_TAG": "submit/2026-10-01T12-00-00Z-a1b2c3d",
    "COMMIT_URL": "https://example.org/commit/a1b2c3d",
    "RELEASE_URL": "https://example.org/releases/1",
    "REVIEW_URL": "https://example.org/compare/1",
}


def evidence(note="here", time_s=1.6, **more):
    item = {"tick": 100, "time_s": time_s, "x": 5.5, "y": 7.25, "note": note}
    return item | more


def verdict(check, status="passed", score=10, **more):
    parts = {
        "check": check,
        "title": f"Title of {check}",
        "status": status,
        "score": score,
        "max_score": 10,
        "rationale": f"Rationale of {check}.",
        "help": "" if status == "passed" else f"Help for {check}.",
        "evidence": [],
        "depends_on": [],
    }
    return parts | more


def run(**more):
    parts = {
        "time": "virtual",
        "outcome": "finished",
        "exit_code": None,
        "ticks": 3500,
        "simulated_s": 56.0,
        "wall_s": 4.25,
        "trace_sha256": "ab" * 32,
        "isolation": "domain 17",
        "flags": [],
    }
    return parts | more


def diagnosis(**more):
    parts = {
        "key": "crashed",
        "cause": "You crashed at 6.0 s (drive.py, line 39).",
        "help": "Mend that line.",
        "run": 0,
        "time_s": 6.0,
        "place": {"file": "drive.py", "line": 39, "function": "on_pose", "text": "1 / 0"},
    }
    return parts | more


def result(*verdicts, **more):
    listed = list(verdicts) or MIXED
    parts = {
        "schema": "turtlesim-grader/result/v1",
        "exercise": "some_exercise",
        "submission": "controller.py",
        "score": round(sum(v["score"] for v in listed), 2),
        "max_score": round(sum(v["max_score"] for v in listed), 2),
        "verdicts": listed,
        "run": run(),
        "artifacts": {},
    }
    return parts | more


#: One of each: passed, failed with partial credit, failed, not judged. 18.33 of 40 points.
MIXED = [
    verdict("starts", evidence=[evidence("it starts", 0.16)]),
    verdict("draws", "failed", 8.33, evidence=[evidence("a gap", 20.0), evidence("again", 21.0)]),
    verdict("stops", "failed", 0),
    verdict("rests", "not_judged", 0, depends_on=["starts", "stops"]),
]


def report(*verdicts, **more):
    return report_in(Path("/nowhere"), result(*verdicts, **more))


def report_in(folder, data):
    """A report of what a result file in a folder would hold."""
    made = Result.from_json(data)
    return Report(made, Artifacts(made, folder))


def graded(folder, recording, *verdicts, varied=(), output="", **more):
    """A result file with a recording, a picture and an output beside it, as `grader run` leaves."""
    saving.save_all(Recordings(recording, tuple(varied)), folder / "recording")
    if recording.canvas:
        (folder / "canvas.png").write_bytes(recording.canvas)
    (folder / "output.txt").write_bytes(output.encode())
    artifacts = {"canvas": "canvas.png", "recording": "recording", "output": "output.txt"}
    if varied:
        start = {"x": 4.0, "y": 7.0, "theta": 1.0}
        more["varied_runs"] = [run(ticks=other.run.ticks, start=start) for other in varied]
    path = folder / "result.json"
    path.write_text(json.dumps(result(*verdicts, artifacts=artifacts, **more)))
    return path


def read_by_people(name, report):
    """What they see of a format, without the signs that keep Markdown from being obeyed."""
    content = render(name, [report])
    if name == "github-autograding":
        content = base64.b64decode(content).decode()
    return content.replace("\\", "")
