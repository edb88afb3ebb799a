"""The process that imports and runs the checks of an added exercise, confined as a submission is.

    python confined_main.py {"say": "describe" | "judge", "shown": ..., "leaves": ..., ...}

It is shown the exercise, the values that are in force and, to judge, the runs. It leaves lines in
the open file `leaves`: one `grader.exercise.confined.Description`, or what `.asking` yields.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
if __name__ == "__main__":
    sys.path[0] = str(ROOT)

from grader import strict_json  # noqa: E402
from grader.added.pins import FILES  # noqa: E402
from grader.errors import ExerciseError  # noqa: E402
from grader.exercise import asking, places  # noqa: E402
from grader.exercise.building import build  # noqa: E402
from grader.exercise.check import Checks  # noqa: E402
from grader.exercise.confined import RECORDINGS, VALUES, Described, Description  # noqa: E402
from grader.exercise.places import Place  # noqa: E402
from grader.recording.reading import load_all  # noqa: E402
from grader.recording.recording import NominalAlone  # noqa: E402
from grader.yaml_file import read_yaml  # noqa: E402


def main() -> None:
    """Answer one order."""
    order = json.loads(sys.argv[1])
    shown = Path(order["shown"])
    place = Place(shown / FILES)
    values = read_yaml(shown / VALUES).data
    with os.fdopen(order["leaves"], "wb") as left:
        if order["say"] == "describe":
            left.write(strict_json.line(described(place, values)))
            return
        for answer in judged(place, values, shown / RECORDINGS, order):
            left.write(answer)
            left.flush()  # the next check may end this process


def described(place: Place, values: Mapping[str, Any]) -> Description:
    """Describe the checks of an exercise's own code, and try its tolerances."""
    try:
        has_own = (place.folder / places.CHECKS).is_file()
        checks = places.import_checks(place) if has_own else Checks()
    except ExerciseError as error:
        return Description(refused=error.message)
    each = (Described(c.name, c.title, c.depends_on, c.rubric, c.file) for c in checks)
    tolerances = values.get("tolerances") or {}
    wrong = checks.wrong_tolerance(tolerances) if isinstance(tolerances, dict) else None
    return Description(tuple(each), *(wrong or ()))


def judged(
    place: Place, values: dict[str, Any], folder: Path, order: Mapping[str, Any]
) -> Iterator[bytes]:
    """Yield the answers of the checks that are asked."""
    exercise = build(values, place)
    recordings = load_all(folder)
    if order["is_alone"]:
        recordings = NominalAlone(recordings.nominal)
    functions = {c.name: c.function for c in exercise.checks if c.name in order["after"]}
    describe = places.describer(place.folder) if order["is_described"] else None
    yield from asking.answers(
        functions, order["after"], recordings, exercise.tolerances, describe, order["rounds"]
    )


if __name__ == "__main__":
    main()
