"""The folder in which a recording lies on disk: a rosbag2, and small files beside its two.

| file | what | read back |
|---|---|---|
| metadata.yaml, recording.mcap | the bag: see `grader.recording.bag` | yes |
| run.json | how the run went, where it started, what the submission published on | yes |
| output.txt | what the submission printed | yes |
| circumstances.json | what differs between equal runs: duration, provenance | if it is there |
| conduct.json | what the submission's process told of itself, if anything | if it is there |
| path.png, plan.png, window.png | the bag's pictures, for people, as many as its scene makes | no |
| scenario.json | the inputs, for `python -m turtlesim_py.scenario` | no |

Two saves of equal recordings differ in circumstances.json at most. metadata.yaml comes into the
folder last, so that a save that was cut off leaves nothing that looks like a recording.

A recording may come from anywhere. What is read has a size, and the bag, which is compressed, is
read in a copy of this process with limits of time and memory.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from grader import limited, strict_json
from grader.errors import RecordingError
from grader.language import stored
from grader.language.phrase import Phrase, say
from grader.limited import Limits
from grader.recording import remarks
from grader.recording.conduct import Conduct
from grader.recording.provenance import Provenance
from grader.recording.recording import PublishedTopic, Recording, Recordings, Run
from grader.requirements import require
from grader.scenes import load_scene
from grader.scenes.scene import Scene, Start, Trace

if TYPE_CHECKING:
    import jsonschema

SCHEMA = "turtlesim-grader/recording/v2"
NAME = "recording"
BAG, METADATA, RUN, OUTPUT = f"{NAME}.mcap", "metadata.yaml", "run.json", "output.txt"
CIRCUMSTANCES_FILE, SCENARIO = "circumstances.json", "scenario.json"
CONDUCT, PACKAGE = "conduct.json", "package.json"
WINDOW_PICTURE = "window.png"
PICTURES = ("path.png", "plan.png", WINDOW_PICTURE)
#: The scene of a recording that names none.
FIRST_SCENE = "turtlesim"
#: The one whose traces tell of packages.
PACKAGE_SCENE = "package"
#: In the order in which they come into the folder.
FILES = (
    *(BAG, RUN, OUTPUT, CONDUCT, PACKAGE, CIRCUMSTANCES_FILE, SCENARIO),
    *PICTURES,
    METADATA,
)
#: What of a `Run` is chance: the same run on another day has others.
CIRCUMSTANCES = ("wall_s", "isolation")
#: What of the run's remarks the submission's reader has made, for other languages.
PHRASES = "phrases"
#: Stands beside them.
PROVENANCE = "provenance"
#: What is read back, and its most bytes. A minute's usual run is 0.2 MB.
SIZES = {
    BAG: 2**28,
    METADATA: 2**20,
    RUN: 2**20,
    OUTPUT: 2**26,
    CIRCUMSTANCES_FILE: 2**20,
    CONDUCT: 2**20,
    PACKAGE: 2**24,
}
#: An exercise has no more.
MOST_VARIED_RUNS = 100
#: Of reading one bag.
READING = Limits(cpu_s=60.0, wall_s=300.0, answer_bytes=2**30)
#: What begins an answer of the process that reads bags if it is no trace, but says why.
_ERROR = b"!"
#: Where the files are written before they come into the folder.
UNFINISHED = ".unfinished"


def save(recording: Recording, folder: Path, varied_runs: int = 0) -> None:
    """Write a recording into a folder, which is made if need be; an older one is replaced.

    Args:
        varied_runs: how many varied runs belong to it, so that none gets lost.

    Raises:
        OSError: it cannot be written.
    """
    with _unfinished(folder) as place:
        _write(recording, place / NAME, varied_runs)
        _put(place / NAME, folder)


def save_all(recordings: Recordings, folder: Path) -> None:
    """Write a nominal recording and its varied ones; see `save`."""
    with saving(folder, len(recordings.varied)) as unsaved:
        for number, recording in enumerate(recordings):
            unsaved.write(number, recording)
        unsaved.put()


class Unsaved:
    """Recordings on their way into a folder: written one by one, put there all at once.

    Args:
        place: where they are written before.
        folder: where they come.
        varied_runs: how many varied ones there will be.
    """

    def __init__(self, place: Path, folder: Path, varied_runs: int) -> None:
        self._place = place
        self._folder = folder
        self._varied_runs = varied_runs

    def write(self, number: int, recording: Recording) -> None:
        """Write a recording: 0 the nominal one, 1, 2, ... varied ones, in any order."""
        _write(recording, self._of(number), 0 if number else self._varied_runs)

    def put(self) -> None:
        """Put all of them in place of older ones, of which none is left."""
        _withdraw(self._folder)  # comes back as the last file of all
        for number in range(1, self._varied_runs + 1):
            into = self._folder / f"varied_{number}"
            if into.is_symlink():
                into.unlink()
            _put(self._of(number), into)
        for number in _varied(self._folder):
            older = self._folder / f"varied_{number}"
            if number > self._varied_runs and not older.is_symlink() and (older / RUN).exists():
                shutil.rmtree(older)
        _put(self._of(0), self._folder)

    def _of(self, number: int) -> Path:
        return self._place / str(number) / NAME


@contextmanager
def saving(folder: Path, varied_runs: int) -> Iterator[Unsaved]:
    """Write recordings as they come; nothing of an older one changes before `Unsaved.put`.

    Raises:
        OSError: they cannot be written; also from `Unsaved`.
    """
    with _unfinished(folder) as place:
        yield Unsaved(place, folder, varied_runs)


def load(path: Path) -> Recording:
    """Read a recording back from its folder, or from that of any of its files.

    Raises:
        RecordingError: it is missing, damaged, or something else.
    """
    (recording,) = _loaded([_told(_folder(path))])
    return recording


def load_all(path: Path) -> Recordings:
    """Read a nominal recording and the varied ones in it.

    Raises:
        RecordingError: one of them is missing, damaged, or something else.
    """
    folder = _folder(path)
    first = _told(folder)
    found = _varied(folder)
    count = max(first.facts["varied_runs"], len(found))
    lost = next((number for number in range(1, count + 1) if number not in found), None)
    if lost is not None:
        raise RecordingError(
            say(
                "{folder} is incomplete: its folder varied_{lost} is missing",
                folder=str(folder),
                lost=str(lost),
            )
        )
    if count > MOST_VARIED_RUNS:
        raise RecordingError(
            say(
                "{folder} has {count} varied runs; expected {most} at most",
                folder=str(folder),
                count=count,
                most=MOST_VARIED_RUNS,
            )
        )
    varied = (_told(folder / f"varied_{number}") for number in range(1, count + 1))
    nominal, *others = _loaded([first, *varied])
    return Recordings(nominal, tuple(others))


def scene_of(folder: Path) -> str:
    """The name of the scene of a recording, as far as its run.json tells; its bag is not opened."""
    try:
        return str(_read_json(folder / RUN).get("scene", FIRST_SCENE))
    except RecordingError:
        return FIRST_SCENE


# Writing --------------------------------------------------------------------------------------


@contextmanager
def _unfinished(folder: Path) -> Iterator[Path]:
    """A place for files that come into the folder later; what is still there then goes."""
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / UNFINISHED
    _clear(place)
    place.mkdir()
    try:
        yield place
    finally:
        shutil.rmtree(place, ignore_errors=True)
        if is_new:
            with suppress(OSError):  # it holds what was put there
                folder.rmdir()


def _clear(place: Path) -> None:
    """Remove what is left of a save that was cut off; of a link, which none of ours is, the link.

    Raises:
        OSError: it cannot be removed.
    """
    if place.is_symlink() or (place.exists() and not place.is_dir()):
        place.unlink()
    elif place.exists():
        shutil.rmtree(place)


def _put(made: Path, folder: Path) -> None:
    """Move the files of a recording to where they belong, metadata.yaml last."""
    folder.mkdir(parents=True, exist_ok=True)
    _withdraw(folder)
    for name in FILES:
        if (made / name).exists():
            (made / name).replace(folder / name)
        else:
            (folder / name).unlink(missing_ok=True)


def _unknown(flags: Iterable[str]) -> list[str]:
    """Those that would not be known again by their English texts: what they are made of is kept."""
    return [flag for flag in flags if not isinstance(remarks.phrase(str(flag)), Phrase)]


def _withdraw(folder: Path) -> None:
    (folder / METADATA).unlink(missing_ok=True)


def _write(recording: Recording, folder: Path, varied_runs: int) -> None:
    scene = load_scene(recording.scene)
    mcap = _bag().write(recording.trace, scene, folder)
    run = asdict(recording.run)
    circumstances = {key: run.pop(key) for key in CIRCUMSTANCES}
    if phrases := stored.phrases_in(_unknown(recording.run.flags)):
        circumstances[PHRASES] = phrases
    if recording.provenance is not None:
        circumstances[PROVENANCE] = recording.provenance.to_json()
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
    if recording.conduct.is_told:
        _write_json(folder / CONDUCT, recording.conduct.to_json())
    if recording.package is not None:
        told = load_scene(PACKAGE_SCENE).encode(recording.package)
        (folder / PACKAGE).write_bytes(told + b"\n")
    for name, png in recording.png.items():
        (folder / f"{name}.png").write_bytes(png)
    # a scenario begins in the usual place
    if recording.start is None and (inputs := scene.scenario(recording.trace)):
        scenario = {"name": NAME, "description": "a graded run", **inputs}
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
        raise RecordingError(
            say("cannot read the recording: {path} does not exist", path=str(path))
        )
    return path if path.is_dir() else path.parent


def _varied(folder: Path) -> set[int]:
    names: Iterable[str] = (path.name for path in folder.glob("varied_*"))
    matches = (re.fullmatch(r"varied_([1-9]\d{0,5})", name) for name in names)
    return {int(match[1]) for match in matches if match}


def _facts(folder: Path) -> dict[str, Any]:
    """The contents of run.json and circumstances.json, valid by the schema."""
    has_bag, has_run = (folder / METADATA).exists(), (folder / RUN).exists()
    if not has_run:
        words = {"folder": str(folder), "run": RUN}
        raise RecordingError(
            say("{folder} is a rosbag, but no recording of the grader: it has no {run}", **words)
            if has_bag
            else say("{folder} is no recording: it has no {run}", **words)
        )
    if not has_bag:
        raise RecordingError(
            say(
                "{folder} is incomplete: it has no {metadata}, which is saved last",
                folder=str(folder),
                metadata=METADATA,
            )
        )
    for name, most in SIZES.items():
        path = folder / name
        if path.exists() and not path.is_file():  # a pipe would be waited for, for ever
            raise RecordingError(say("{path} is damaged: it is no ordinary file", path=str(path)))
        if path.is_symlink() and not path.resolve().is_relative_to(folder.resolve()):
            raise RecordingError(
                say("{path} is no part of a recording: it leads somewhere else", path=str(path))
            )
        if path.exists() and path.stat().st_size > most:
            size = path.stat().st_size
            raise RecordingError(
                say(
                    "{path} has {size} bytes; expected {most} at most",
                    path=str(path),
                    size=size,
                    most=most,
                )
            )
    facts = _read_json(folder / RUN)
    if facts.get("schema") != SCHEMA:
        raise RecordingError(
            say(
                "{run} is of another version: expected schema {schema!r}, found {found!r}",
                run=str(folder / RUN),
                schema=SCHEMA,
                found=facts.get("schema"),
            )
        )
    path = folder / CIRCUMSTANCES_FILE
    circumstances = _read_json(path) if path.exists() else {}
    if isinstance(facts.get("run"), dict):
        facts["run"].update((k, v) for k, v in circumstances.items() if k in CIRCUMSTANCES)
    facts[PROVENANCE] = circumstances.get(PROVENANCE)
    phrases = circumstances.get(PHRASES, {})
    from jsonschema.exceptions import best_match  # here: what is only written is not validated

    error = best_match(_validator().iter_errors(facts))
    if error is not None:
        raise RecordingError(
            say(
                "{run} is damaged: {place}: {message}",
                run=str(folder / RUN),
                place=error.json_path,
                message=error.message,
            )
        )
    try:
        facts["run"]["flags"] = stored.restored(tuple(facts["run"]["flags"]), phrases)
    except (ValueError, TypeError, AttributeError) as wrong:
        raise RecordingError(
            say("{path} is damaged: {error}", path=str(path), error=str(wrong))
        ) from None
    return facts


@dataclass(frozen=True)
class _Told:
    """What is known of a recording before its bag is read.

    Attributes:
        facts: of run.json and circumstances.json.
    """

    folder: Path
    facts: dict[str, Any]
    run: Run
    scene: Scene
    output: str


def _told(folder: Path) -> _Told:
    """What the files beside the bag tell, which has its checksum."""
    facts = _facts(folder)
    try:
        digest = _sha256(folder / BAG)
        output = (folder / OUTPUT).read_bytes().decode("utf-8", "surrogatepass")
        run = Run(**facts["run"])
    except OSError as error:
        raise RecordingError(say("cannot read the recording: {error}", error=str(error))) from None
    except (ValueError, TypeError) as error:
        raise RecordingError(
            say("{path} is damaged: {error}", path=str(folder), error=str(error))
        ) from None
    if digest != facts["bag_sha256"]:
        raise RecordingError(
            say(
                "{bag} is damaged: it is cut off or was changed since it was saved",
                bag=str(folder / BAG),
            )
        )
    scene = _scene(folder, facts.get("scene", FIRST_SCENE))
    _must_agree(folder, "ticks", run.ticks, round(run.simulated_s * 1e9 / scene.tick_ns))
    return _Told(folder, facts, run, scene, output)


def _loaded(found: Sequence[_Told]) -> list[Recording]:
    """Recordings with what is in their bags, of which nobody knows how much they unpack to.

    One copy of this process reads them all, each within the limits.
    """
    bag = _bag()
    for scene in {told.scene.name: told.scene for told in found}.values():
        bag.prepare(scene)

    def answer(number: int) -> bytes:
        told = found[number]
        try:
            trace = bag.read(told.folder / BAG, told.scene, told.run.ticks)
            return told.scene.encode(trace)
        except RecordingError as error:
            return _ERROR + error.message.encode("utf-8", "backslashreplace")

    with limited.Copy(answer, READING) as copy:
        return [_recording(told, _trace(told, copy, n)) for n, told in enumerate(found)]


def _trace(told: _Told, copy: limited.Copy, number: int) -> Trace:
    try:
        answer = copy.ask(number)
    except limited.LimitHit as hit:
        raise RecordingError(
            say(
                "the bag in {folder} cannot be read: reading it {hit}",
                folder=str(told.folder),
                hit=hit.args[0],
            )
        ) from None
    if answer.startswith(_ERROR):
        raise RecordingError(answer.removeprefix(_ERROR).decode())
    return told.scene.decode(answer)


def _recording(told: _Told, trace: Trace) -> Recording:
    facts = told.facts
    _must_agree(told.folder, "trace_sha256", told.run.trace_sha256, trace.sha256())
    return Recording(
        trace=trace,
        run=told.run,
        topics=tuple(PublishedTopic(**topic) for topic in facts["topics"]),
        output=told.output,
        start=Start(**facts["start"]) if facts["start"] else None,
        scene=told.scene.name,
        provenance=Provenance.from_json(facts[PROVENANCE]) if facts[PROVENANCE] else None,
        conduct=_conduct(told.folder / CONDUCT),
        package=_package(told.folder / PACKAGE),
    )


def _package(path: Path) -> Trace | None:
    if not path.exists():
        return None
    try:
        return load_scene(PACKAGE_SCENE).decode(path.read_bytes())
    except OSError as error:
        raise RecordingError(say("cannot read the recording: {error}", error=str(error))) from None
    except ValueError as error:
        raise RecordingError(
            say("{path} is damaged: {error}", path=str(path), error=str(error))
        ) from None


def _conduct(path: Path) -> Conduct:
    """What the process has told of itself; nothing in a recording that is older than that."""
    if not path.exists():
        return Conduct()
    try:
        return Conduct.from_json(_read_json(path))
    except ValueError as error:
        raise RecordingError(
            say("{path} is damaged: {error}", path=str(path), error=str(error))
        ) from None


def _must_agree(folder: Path, key: str, told: object, found: object) -> None:
    if told != found:
        raise RecordingError(
            say(
                "{run} is damaged: its {key} is {told}, but the run's is {found}",
                run=str(folder / RUN),
                key=key,
                told=f"{told!r:.80}",
                found=f"{found!r:.80}",
            )
        )


def _scene(folder: Path, name: str) -> Scene:
    try:
        return load_scene(name)
    except KeyError as error:
        raise RecordingError(
            say("{folder} cannot be read: {why}", folder=str(folder), why=error.args[0])
        ) from None


def _read_json(path: Path) -> dict[str, Any]:
    try:
        data = strict_json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordingError(say("cannot read the recording: {error}", error=str(error))) from None
    except (ValueError, RecursionError) as error:
        raise RecordingError(
            say("{path} is damaged: it is not JSON ({error})", path=str(path), error=str(error))
        ) from None
    if not isinstance(data, dict):
        raise RecordingError(
            say(
                "{path} is damaged: expected an object, found {data}",
                path=str(path),
                data=f"{data!r:.40}",
            )
        )
    return data


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@cache
def _validator() -> jsonschema.Draft202012Validator:
    import jsonschema

    text = (files(__package__) / "recording.schema.json").read_text(encoding="utf-8")
    return jsonschema.Draft202012Validator(json.loads(text))
