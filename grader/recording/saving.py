"""Writes recordings into their folders: whole, or not at all.

| file | what | read back |
|---|---|---|
| metadata.yaml, recording.mcap | the bag: see `grader.recording.bag` | yes |
| run.json | how the run went, where it started, what the submission published on | yes |
| output.txt | what the submission printed | yes |
| circumstances.json | duration, provenance, definitions of interfaces | if it is there |
| observations.json | what the submission's process reported, if anything | if it is there |
| path.png, window.png | the bag's pictures, for people, as many as its scene makes | no |
| scenario.json | the inputs, for `python -m turtlesim_py.scenario` | no |

Two saves of equal recordings differ in circumstances.json at most. metadata.yaml comes into the
folder last, so that a save that was cut off leaves nothing that looks like a recording.

A recording may come from anywhere. What is read has a size, and the bag, which is compressed, is
read in a copy of this process with limits of time and memory. `grader.recording.reading` reads it.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from grader.recording import bag
from grader.recording.recording import Recording, Recordings
from grader.recording.scene_and_cast import merge
from grader.recording.subject import DEFAULT_SCENE, PACKAGE_SCENE, load_keeper
from grader.system import content
from grader.system.removal import remove
from grader.system.strict_json import OURS, to_json

SCHEMA = "turtlesim-grader/recording/v2"
NAME = "recording"
BAG, METADATA, RUN, OUTPUT = f"{NAME}.mcap", "metadata.yaml", "run.json", "output.txt"
CIRCUMSTANCES_FILE, SCENARIO = "circumstances.json", "scenario.json"
OBSERVATIONS, PACKAGE = "observations.json", "package.json"
WINDOW_PICTURE = "window.png"
PICTURES = ("path.png", WINDOW_PICTURE)
#: In the order in which they come into the folder.
FILES = (
    *(BAG, RUN, OUTPUT, OBSERVATIONS, PACKAGE, CIRCUMSTANCES_FILE, SCENARIO),
    *PICTURES,
    METADATA,
)
#: Fields of a `Run` that are chance: the same run on another day has others.
CIRCUMSTANCES = ("wall_s", "isolation")
#: The keys beside them.
PROVENANCE, INTERFACES = "provenance", "interfaces"
#: Where the files are written before they come into the folder.
UNFINISHED = ".unfinished"


def save_all(recordings: Recordings, folder: Path) -> None:
    """Write a nominal recording and its varied ones into a folder, in place of older ones.

    The folder is made if need be.
    """
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / UNFINISHED
    remove(place)  # the rest of a save that was cut off
    place.mkdir()
    varied_runs = len(recordings.varied)
    try:
        for number, recording in enumerate(recordings):
            _write(recording, place / str(number) / NAME, 0 if number else varied_runs)
        _put_all(place, folder, varied_runs)
    finally:
        remove(place)
        if is_new:
            with suppress(OSError):  # it holds what was put there
                folder.rmdir()


def _put_all(place: Path, folder: Path, varied_runs: int) -> None:
    """Put written recordings in place of older ones, of which none is left."""
    (folder / METADATA).unlink(missing_ok=True)  # comes back as the last file of all
    for number in range(1, varied_runs + 1):
        into = folder / f"varied_{number}"
        if into.is_symlink():
            into.unlink()
        _put(place / str(number) / NAME, into)
    for number in varied_in(folder):
        older = folder / f"varied_{number}"
        if number > varied_runs and not older.is_symlink() and (older / RUN).exists():
            shutil.rmtree(older)
    _put(place / "0" / NAME, folder)


def _put(made: Path, folder: Path) -> None:
    """Move the files of a recording to where they belong, metadata.yaml last."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / METADATA).unlink(missing_ok=True)
    for name in FILES:
        if (made / name).exists():
            (made / name).replace(folder / name)
        else:
            (folder / name).unlink(missing_ok=True)


def _write(recording: Recording, folder: Path, varied_runs: int) -> None:
    scene = load_keeper(recording.scene)
    mcap = bag.write(*merge(recording.trace, recording.cast, scene), folder)
    run = to_json(recording.run, OURS)
    circumstances = {key: run.pop(key) for key in CIRCUMSTANCES}
    if recording.provenance is not None:
        circumstances[PROVENANCE] = to_json(recording.provenance, OURS)
    if recording.interfaces.packages:
        circumstances[INTERFACES] = to_json(recording.interfaces, OURS)
    start = to_json(recording.start, OURS) if recording.start else None
    facts = {
        "schema": SCHEMA,
        "bag_sha256": content.of_file(mcap),
        "varied_runs": varied_runs,
        "start": start,
        "topics": [asdict(topic) for topic in recording.topics],
        "run": run,
    }
    if recording.scene != DEFAULT_SCENE:
        facts["scene"] = recording.scene
    if recording.cast is not None:
        facts["cast"] = True
    _write_json(folder / RUN, facts)
    _write_json(folder / CIRCUMSTANCES_FILE, circumstances)
    # Bytes: a student's line ends stay as they are.
    (folder / OUTPUT).write_bytes(recording.output.encode("utf-8", "surrogatepass"))
    if recording.observations.is_known:
        _write_json(folder / OBSERVATIONS, recording.observations.to_json())
    if recording.package is not None:
        package: Any = load_keeper(PACKAGE_SCENE)
        encoded = package.encode(recording.package)
        (folder / PACKAGE).write_bytes(encoded + b"\n")
    for name, png in recording.png.items():
        (folder / f"{name}.png").write_bytes(png)
    if inputs := scene.scenario(recording.trace):
        begins = {"start": start} if start else {}
        scenario = {"name": NAME, "description": "a graded run", **begins, **inputs}
        _write_json(folder / SCENARIO, scenario, indent=None)


def _write_json(path: Path, data: dict[str, Any], indent: int | None = 2) -> None:
    path.write_text(json.dumps(data, indent=indent) + "\n", encoding="utf-8")


def varied_in(folder: Path) -> set[int]:
    """Return the numbers of the varied runs whose folders exist."""
    names: Iterable[str] = (path.name for path in folder.glob("varied_*"))
    matches = (re.fullmatch(r"varied_([1-9]\d{0,5})", name) for name in names)
    return {int(match[1]) for match in matches if match}
