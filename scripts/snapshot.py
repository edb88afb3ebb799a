"""Grade all fixture submissions with a checkout's grader, for a comparison.

    python scripts/snapshot.py BEFORE [--grader PATH/TO/grader] [--jobs N] [--only NAME...]
    python scripts/snapshot.py AFTER
    diff -rq BEFORE AFTER

To check that a change leaves behaviour as it is, take a snapshot before and one after it. Only the
command line is used, so it works for any two versions of the grader. A snapshot has the result, the
recordings and every report format, without what differs between equal runs (wall time, dates and
versions), and with a hash of its pixels for each picture inside a report. Of runs in real time
there is the outcome alone.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
#: Always the same path: tracebacks in a submission's output contain it.
FIXTURES = Path("/tmp/turtlesim-snapshot-fixtures")
FORMATS = (
    *("html", "markdown", "csv", "junit", "gradescope", "prairielearn", "autolab"),
    *("moodle-vpl", "github-autograding", "terminal"),
)
#: Folders of what is not the challenge's; of the tutorials, right ones of one file are graded.
OTHERS = ("tutorials", "hostile_casts", "interfaces")
#: The file of a recording that differs between equal runs.
CIRCUMSTANCES = "circumstances.json"


def lay_out() -> dict[str, tuple[Path, str]]:
    """Copy the fixtures; name -> path and exercise."""
    sys.path.insert(0, str(ROOT))
    from tests import hand_ins
    from tests.runs import MUTANTS

    shutil.rmtree(FIXTURES, ignore_errors=True)
    shutil.copytree(hand_ins.SUBMISSIONS, FIXTURES)
    found: dict[str, tuple[Path, str]] = {}
    for path in sorted(FIXTURES.rglob("*.py")):
        kind, *inside = path.relative_to(FIXTURES).parts
        if kind == "tutorials" and inside[1:] == ["right", path.name]:
            found[f"{inside[0]}-{path.stem}"] = (path, inside[0])
        elif kind in OTHERS or inside[:1] == ["tutorials"]:
            continue
        else:
            is_square = path.stem.startswith("square")
            found[path.stem] = (path, "square" if is_square else "turtlesim_challenge")
    for name, text in {
        "reference": hand_ins.REFERENCE.read_text(encoding="utf-8"),
        **{name: mutant.text() for name, mutant in MUTANTS.items()},
    }.items():
        path = FIXTURES / "mutants" / name / "turtle_controller.py"
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
        found[f"mutant-{name}"] = (path, "turtlesim_challenge")
    starter = FIXTURES / "starter"
    shutil.copytree(ROOT / "turtlesim_challenge" / "starter", starter)
    return {**found, "starter": (starter, "turtlesim_challenge")}


def record(grader: str, folder: Path, jobs: int, only: list[str]) -> None:
    """Grade everything into a new folder."""
    folder.mkdir(parents=True)
    fixtures = {name: case for name, case in lay_out().items() if not only or name in only}
    with ThreadPoolExecutor(jobs) as pool:
        for line in pool.map(lambda item: _grade(grader, folder, *item), fixtures.items()):
            print(line, flush=True)


def _grade(grader: str, folder: Path, name: str, case: tuple[Path, str]) -> str:
    path, exercise = case
    command = [grader, "run", str(path), "--exercise", exercise, "--out", name]
    env = {**os.environ, "COLUMNS": "100"}
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True)
    if done.returncode:
        (folder / name).mkdir(exist_ok=True)
        (folder / name / "failed.txt").write_text(f"{done.returncode}\n{done.stderr}")
        _remove_what_differs(folder / name, [])
        return f"{name}: exit {done.returncode}"
    file = folder / name / "result.json"
    result = json.loads(file.read_text(encoding="utf-8"))
    for run in _runs(result):
        run["wall_s"] = 1.0
    result.pop("provenance", None)
    file.write_text(json.dumps(result, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    for form in FORMATS:
        command = [grader, "report", f"{name}/result.json", "--format", form]
        report = subprocess.run(command, cwd=folder, env=env, capture_output=True)
        (folder / name / f"report.{form}").write_bytes(report.stdout or report.stderr)
    _remove_what_differs(folder / name, _runs(result))
    hashes = " ".join(run["trace_sha256"][:8] for run in _runs(result))
    return f"{name}: {result['score']} {result['run']['time']} {hashes}"


def _runs(result: dict[str, Any]) -> list[dict[str, Any]]:
    return [result["run"], *result.get("varied_runs", [])]


def _remove_what_differs(folder: Path, runs: list[dict[str, Any]]) -> None:
    """Leave what is the same in equal runs; of those in real time, how they have ended."""
    if any(run["time"] == "real" for run in runs):
        shutil.rmtree(folder)
        folder.mkdir()
        ends = [(run["time"], run["outcome"], run["flags"]) for run in runs]
        (folder / "runs.json").write_text(json.dumps(ends, indent=2), encoding="utf-8")
    for path in filter(Path.is_file, folder.rglob("*")):
        if path.name == CIRCUMSTANCES:
            path.unlink()
        else:
            path.write_bytes(_timeless(path))


def _timeless(path: Path) -> bytes:
    """Return a file's bytes without the times of rclpy's logger, and without rclpy's path.

    A picture inside is replaced by a hash of its pixels: another encoder makes other bytes.
    """
    data = re.sub(rb"\[\d{10}\.\d{9}\]", b"[time]", path.read_bytes())
    data = re.sub(rb"/[^\s\"&]*/site-packages/", b"[site]/", data)
    return re.sub(rb"data:image/png;base64,([A-Za-z0-9+/=]+)", _pixels, data)


def _pixels(found: re.Match[bytes]) -> bytes:
    with Image.open(io.BytesIO(base64.b64decode(found[1]))) as image:
        shown = image.convert("RGBA")
    return f"[{shown.size} {hashlib.sha256(shown.tobytes()).hexdigest()}]".encode()


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", nargs="*", default=[], metavar="NAME")
    parser.add_argument("--grader", default=str(ROOT / ".venv" / "bin" / "grader"))
    args = parser.parse_args()
    record(args.grader, args.folder, args.jobs, args.only)


if __name__ == "__main__":
    main()
