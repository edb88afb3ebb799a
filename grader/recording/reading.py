"""Reads recordings back: strictly, for a folder may come from anywhere."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from grader import limited, strict_json
from grader.errors import RecordingError
from grader.language import stored
from grader.language.phrase import say
from grader.limited import Limits
from grader.recording.conduct import Conduct
from grader.recording.folder import (
    BAG,
    CIRCUMSTANCES,
    CIRCUMSTANCES_FILE,
    CONDUCT,
    FIRST_SCENE,
    METADATA,
    OUTPUT,
    PACKAGE,
    PHRASES,
    PROVENANCE,
    RUN,
    SCHEMA,
    bag,
    sha256_of,
    varied_in,
)
from grader.recording.provenance import Provenance
from grader.recording.recording import PublishedTopic, Recording, Recordings, Run
from grader.scenes import load_scene, transfer
from grader.scenes.package.trace import decode
from grader.scenes.scene import Scene, Start, Trace

if TYPE_CHECKING:
    import jsonschema

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
    found = varied_in(folder)
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


def _folder(path: Path) -> Path:
    if not path.exists():
        raise RecordingError(
            say("cannot read the recording: {path} does not exist", path=str(path))
        )
    return path if path.is_dir() else path.parent


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
        raise RecordingError(say("{path} {error}", path=str(path), error=str(wrong))) from None
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
        digest = sha256_of(folder / BAG)
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

    One copy of this process reads them all, within the limits of so many.
    """
    bags = bag()

    def answers() -> Iterator[bytes]:
        for told in found:
            try:
                trace = bags.read(told.folder / BAG, told.scene, told.run.ticks)
                yield transfer.pack(trace, told.scene)
            except RecordingError as error:
                yield _ERROR + error.message.encode("utf-8", "backslashreplace")

    made: list[Recording] = []
    many = len(found)
    limits = replace(READING, cpu_s=many * READING.cpu_s, wall_s=many * READING.wall_s)
    try:
        with closing(limited.stream(answers, limits)) as read:
            for told, answer in zip(found, read, strict=False):  # asks for no more than that
                if answer.startswith(_ERROR):
                    raise RecordingError(answer.removeprefix(_ERROR).decode())
                made.append(_recording(told, transfer.unpack(answer, told.scene)))
    except limited.LimitHit as hit:
        folder = str(found[len(made)].folder)
        raise RecordingError(
            say(
                "the bag in {folder} cannot be read: reading it {hit}",
                folder=folder,
                hit=hit.args[0],
            )
        ) from None
    return made


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
        provenance=_provenance(facts[PROVENANCE]),
        conduct=_conduct(told.folder / CONDUCT),
        package=_package(told.folder / PACKAGE),
    )


def _provenance(told: object) -> Provenance | None:
    return strict_json.from_json(Provenance, told, strict_json.OURS) if told else None


def _package(path: Path) -> Trace | None:
    if not path.exists():
        return None
    try:
        return decode(path.read_bytes())
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


@cache
def _validator() -> jsonschema.Draft202012Validator:
    import jsonschema

    text = (files(__package__) / "recording.schema.json").read_text(encoding="utf-8")
    return jsonschema.Draft202012Validator(json.loads(text))
