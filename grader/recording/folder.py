"""The folder in which a recording lies on disk: a rosbag2, and small files beside its two.

| file | what | read back |
|---|---|---|
| metadata.yaml, recording.mcap | the bag: see `grader.recording.bag` | yes |
| run.json | how the run went, where it started, what the submission published on | yes |
| output.txt | what the submission printed | yes |
| circumstances.json | what differs between equal runs: `CIRCUMSTANCES` | if it is there |
| path.png, window.png | the bag's pictures, for people | no |
| scenario.json | the inputs, for `python -m turtlesim_py.scenario` | no |

Two saves of equal recordings differ in circumstances.json at most. metadata.yaml comes into the
folder last, so that a save that was cut off leaves nothing that looks like a recording.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Iterable
from dataclasses import asdict
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import Any

import jsonschema

from grader import strict_json
from grader.errors import RecordingError
from grader.recording.recording import PublishedTopic, Recording, Recordings, Run
from grader.requirements import require
from grader.scenes import load_scene
from grader.scenes.scene import Scene, Start

SCHEMA = "turtlesim-grader/recording/v2"
NAME = "recording"
BAG, METADATA, RUN, OUTPUT = f"{NAME}.mcap", "metadata.yaml", "run.json", "output.txt"
CIRCUMSTANCES_FILE, SCENARIO = "circumstances.json", "scenario.json"
PATH_PICTURE, WINDOW_PICTURE = "path.png", "window.png"
#: The scene of a recording that names none.
FIRST_SCENE = "turtlesim"
#: In the order in which they come into the folder.
FILES = (BAG, RUN, OUTPUT, CIRCUMSTANCES_FILE, SCENARIO, PATH_PICTURE, WINDOW_PICTURE, METADATA)
#: What of a `Run` is chance: the same run on another day has others.
CIRCUMSTANCES = ("wall_s", "isolation")
#: Where the files are written before they come into the folder.
UNFINISHED = ".unfinished"


def save(recording: Recording, folder: Path, varied_runs: int = 0) -> None:
    """Write a recording into a folder, which is made if need be; an older one is replaced.

    Args:
        varied_runs: how many varied runs belong to it, so that none gets lost.

    Raises:
        OSError: it cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    unfinished = folder / UNFINISHED
    shutil.rmtree(unfinished, ignore_errors=True)
    try:
        _write(recording, unfinished / NAME, varied_runs)
        _withdraw(folder)
        for name in FILES:
            made = unfinished / NAME / name
            if made.exists():
                made.replace(folder / name)
            else:
                (folder / name).unlink(missing_ok=True)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def save_all(recordings: Recordings, folder: Path) -> None:
    """Write a nominal recording and its varied ones; see `save`."""
    _withdraw(folder)  # comes back as the last file of all
    for number, recording in enumerate(recordings.varied, 1):
        save(recording, folder / f"varied_{number}")
    for number in _varied(folder):
        older = folder / f"varied_{number}"
        if number > len(recordings.varied) and (older / RUN).exists():
            shutil.rmtree(older)
    save(recordings.nominal, folder, len(recordings.varied))


def load(path: Path) -> Recording:
    """Read a recording back from its folder, or from that of any of its files.

    Raises:
        RecordingError: it is missing, damaged, or something else.
    """
    folder = _folder(path)
    return _load(folder, _facts(folder))


def load_all(path: Path) -> Recordings:
    """Read a nominal recording and the varied ones in it.

    Raises:
        RecordingError: one of them is missing, damaged, or something else.
    """
    folder = _folder(path)
    facts = _facts(folder)
    nominal = _load(folder, facts)
    found = _varied(folder)
    count = max(facts["varied_runs"], len(found))
    lost = next((number for number in range(1, count + 1) if number not in found), None)
    if lost is not None:
        raise RecordingError(f"{folder} is incomplete: its folder varied_{lost} is missing")
    varied = (load(folder / f"varied_{number}") for number in range(1, count + 1))
    return Recordings(nominal, tuple(varied))


def scene_of(folder: Path) -> str:
    """The name of the scene of a recording, as far as its run.json tells; its bag is not opened."""
    try:
        return str(_read_json(folder / RUN).get("scene", FIRST_SCENE))
    except RecordingError:
        return FIRST_SCENE


# Writing --------------------------------------------------------------------------------------


def _withdraw(folder: Path) -> None:
    (folder / METADATA).unlink(missing_ok=True)


def _write(recording: Recording, folder: Path, varied_runs: int) -> None:
    scene = load_scene(recording.scene)
    mcap = _bag().write(recording.trace, scene, folder)
    run = asdict(recording.run)
    circumstances = {key: run.pop(key) for key in CIRCUMSTANCES}
    if not recording.run.interfaces:
        del run["interfaces"]
    facts = {
        "schema": SCHEMA,
        "bag_sha256": _sha256(mcap),
        "varied_runs": varied_runs,
        "start": asdict(recording.start) if recording.start else None,
        "topics": [asdict(topic) for topic in recording.topics],
        "run": run,
    }
    if recording.scene != FIRST_SCENE:
        facts["scene"] = recording.scene
    _write_json(folder / RUN, facts)
    _write_json(folder / CIRCUMSTANCES_FILE, circumstances)
    # Bytes: a student's line ends stay as they are.
    (folder / OUTPUT).write_bytes(recording.output.encode("utf-8", "surrogatepass"))
    for name, png in recording.png.items():
        (folder / f"{name}.png").write_bytes(png)
    if recording.start is None:  # a scenario begins in the usual place
        scenario = {"name": NAME, "description": "a graded run", **scene.scenario(recording.trace)}
        _write_json(folder / SCENARIO, scenario, indent=None)


def _write_json(path: Path, data: dict[str, Any], indent: int | None = 2) -> None:
    path.write_text(json.dumps(data, indent=indent) + "\n", encoding="utf-8")


# Reading --------------------------------------------------------------------------------------


def _bag() -> ModuleType:
    """The module that reads and writes bags; imported late, because rosbags may be missing.

    Raises:
        GraderFailure: rosbags is missing.
    """
    require("rosbags")
    from grader.recording import bag

    return bag


def _folder(path: Path) -> Path:
    if not path.exists():
        raise RecordingError(f"cannot read the recording: {path} does not exist")
    return path if path.is_dir() else path.parent


def _varied(folder: Path) -> set[int]:
    names: Iterable[str] = (path.name for path in folder.glob("varied_*"))
    matches = (re.fullmatch(r"varied_([1-9]\d{0,5})", name) for name in names)
    return {int(match[1]) for match in matches if match}


def _facts(folder: Path) -> dict[str, Any]:
    """The contents of run.json and circumstances.json, valid by the schema."""
    has_bag, has_run = (folder / METADATA).exists(), (folder / RUN).exists()
    if not has_run:
        what = "a rosbag, but no recording of the grader" if has_bag else "no recording"
        raise RecordingError(f"{folder} is {what}: it has no {RUN}")
    if not has_bag:
        raise RecordingError(f"{folder} is incomplete: it has no {METADATA}, which is saved last")
    for name in (BAG, METADATA, RUN, OUTPUT, CIRCUMSTANCES_FILE):
        path = folder / name
        if path.exists() and not path.is_file():  # a pipe would be waited for, for ever
            raise RecordingError(f"{path} is damaged: it is no ordinary file")
    facts = _read_json(folder / RUN)
    if facts.get("schema") != SCHEMA:
        found = f"expected schema {SCHEMA!r}, found {facts.get('schema')!r}"
        raise RecordingError(f"{folder / RUN} is of another version: {found}")
    path = folder / CIRCUMSTANCES_FILE
    circumstances = _read_json(path) if path.exists() else {}
    if isinstance(facts.get("run"), dict):
        facts["run"].update((k, v) for k, v in circumstances.items() if k in CIRCUMSTANCES)
    error = jsonschema.exceptions.best_match(_validator().iter_errors(facts))
    if error is not None:
        raise RecordingError(f"{folder / RUN} is damaged: {error.json_path}: {error.message}")
    return facts


def _load(folder: Path, facts: dict[str, Any]) -> Recording:
    try:
        digest = _sha256(folder / BAG)
        output = (folder / OUTPUT).read_bytes().decode("utf-8", "surrogatepass")
        run = Run(**{**facts["run"], "flags": tuple(facts["run"]["flags"])})
    except OSError as error:
        raise RecordingError(f"cannot read the recording: {error}") from None
    except (ValueError, TypeError) as error:
        raise RecordingError(f"{folder} is damaged: {error}") from None
    if digest != facts["bag_sha256"]:
        raise RecordingError(
            f"{folder / BAG} is damaged: it is cut off or was changed since it was saved"
        )
    scene = _scene(folder, facts.get("scene", FIRST_SCENE))
    _must_agree(folder, "ticks", run.ticks, round(run.simulated_s * 1e9 / scene.tick_ns))
    trace = _bag().read(folder, scene, run.ticks)
    _must_agree(folder, "trace_sha256", run.trace_sha256, trace.sha256())
    return Recording(
        trace=trace,
        run=run,
        topics=tuple(PublishedTopic(**topic) for topic in facts["topics"]),
        output=output,
        start=Start(**facts["start"]) if facts["start"] else None,
        scene=scene.name,
    )


def _must_agree(folder: Path, key: str, told: object, found: object) -> None:
    if told != found:
        raise RecordingError(
            f"{folder / RUN} is damaged: its {key} is {told!r:.80}, but the run's is {found!r:.80}"
        )


def _scene(folder: Path, name: str) -> Scene:
    try:
        return load_scene(name)
    except KeyError as error:
        raise RecordingError(f"{folder} cannot be read: {error.args[0]}") from None


def _read_json(path: Path) -> dict[str, Any]:
    try:
        data = strict_json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordingError(f"cannot read the recording: {error}") from None
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"{path} is damaged: it is not JSON ({error})") from None
    if not isinstance(data, dict):
        raise RecordingError(f"{path} is damaged: expected an object, found {data!r:.40}")
    return data


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@cache
def _validator() -> jsonschema.Draft202012Validator:
    text = (files(__package__) / "recording.schema.json").read_text(encoding="utf-8")
    return jsonschema.Draft202012Validator(json.loads(text))
