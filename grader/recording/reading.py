"""Reads recordings strictly, for a folder may come from anywhere."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from grader.errors import RecordingError
from grader.recording import bag
from grader.recording.observations import Observations
from grader.recording.recording import (
    OwnInterfaces,
    Provenance,
    PublishedTopic,
    Recording,
    Recordings,
    Run,
)
from grader.recording.saving import (
    BAG,
    CIRCUMSTANCES,
    CIRCUMSTANCES_FILE,
    INTERFACES,
    METADATA,
    OBSERVATIONS,
    OUTPUT,
    PACKAGE,
    PROVENANCE,
    RUN,
    SCHEMA,
    varied_in,
)
from grader.recording.scene_and_cast import CastKeeper, split
from grader.recording.subject import (
    DEFAULT_SCENE,
    PACKAGE_SCENE,
    Keeper,
    Start,
    Trace,
    load_keeper,
    scene_at_work,
)
from grader.system import content, limited, strict_json
from grader.system.limited import WorkLimits
from grader.text.message import Message

#: The files that are read, and their most bytes. A minute's usual run is 0.2 MB.
SIZES = {
    BAG: 2**28,
    METADATA: 2**20,
    RUN: 2**20,
    OUTPUT: 2**26,
    CIRCUMSTANCES_FILE: 2**20,
    OBSERVATIONS: 2**20,
    PACKAGE: 2**24,
}
#: An exercise has no more.
MOST_VARIED_RUNS = 100
#: Limits of reading one bag.
READING = WorkLimits(cpu_s=60.0, wall_s=300.0)


def load(path: Path) -> Recording:
    """Read a recording from its folder, or from that of any of its files."""
    (recording,) = _loaded([_read_header(_folder(path))])
    return recording


def load_all(path: Path) -> Recordings:
    """Read a nominal recording and the varied ones in it."""
    folder = _folder(path)
    first = _read_header(folder)
    found = varied_in(folder)
    count = max(first.facts["varied_runs"], len(found))
    lost = next((number for number in range(1, count + 1) if number not in found), None)
    if lost is not None:
        raise RecordingError(
            "{folder} is incomplete: its folder varied_{lost} is missing",
            folder=str(folder),
            lost=str(lost),
        )
    if count > MOST_VARIED_RUNS:
        raise RecordingError(
            "{folder} has {count} varied runs; expected {most} at most",
            folder=str(folder),
            count=count,
            most=MOST_VARIED_RUNS,
        )
    varied = (_read_header(folder / f"varied_{number}") for number in range(1, count + 1))
    nominal, *others = _loaded([first, *varied])
    return Recordings(nominal, tuple(others))


def scene_of(folder: Path) -> str:
    """Return the scene of a recording by its run.json; its bag is not opened."""
    try:
        return str(_read_json(folder / RUN).get("scene", DEFAULT_SCENE))
    except RecordingError:
        return DEFAULT_SCENE


def _folder(path: Path) -> Path:
    if not path.exists():
        raise RecordingError("cannot read the recording: {path} does not exist", path=str(path))
    return path if path.is_dir() else path.parent


def _facts(folder: Path) -> dict[str, Any]:
    """Read run.json and circumstances.json, and validate them by the schema."""
    for name in (RUN, METADATA):  # this one is saved last
        if not (folder / name).exists():
            raise RecordingError(
                "{folder} is no recording of the grader, or an incomplete one: it has no {file}",
                folder=str(folder),
                file=name,
            )
    for name, most in SIZES.items():
        path = folder / name
        # a pipe would be waited for, for ever; a link may lead to anybody's file
        is_plain = path.is_file() and path.resolve().is_relative_to(folder.resolve())
        if not is_plain and (path.exists() or path.is_symlink()):
            raise RecordingError(
                "{path} is no part of a recording: it is no ordinary file in its folder",
                path=str(path),
            )
        if is_plain and (size := path.stat().st_size) > most:
            raise RecordingError(
                "{path} has {size} bytes; expected {most} at most",
                path=str(path),
                size=size,
                most=most,
            )
    facts = _read_json(folder / RUN)
    if facts.get("schema") != SCHEMA:
        raise RecordingError(
            "{run} is of another version: expected schema {schema!r}, found {found}",
            run=str(folder / RUN),
            schema=SCHEMA,
            found=repr(facts.get("schema")),
        )
    path = folder / CIRCUMSTANCES_FILE
    circumstances = _read_json(path) if path.exists() else {}
    if isinstance(facts.get("run"), dict):
        facts["run"].update((k, v) for k, v in circumstances.items() if k in CIRCUMSTANCES)
    facts[PROVENANCE] = circumstances.get(PROVENANCE)
    error = strict_json.first_error("grader.recording", "recording", facts)
    if error is not None:
        raise RecordingError(
            "{run} is damaged: {place}: {message}",
            run=str(folder / RUN),
            place=error.json_path,
            message=error.message,
        )
    with _refusing(path):
        facts[INTERFACES] = strict_json.from_json(
            OwnInterfaces, circumstances.get(INTERFACES, {}), strict_json.OURS
        )
    return facts


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    """Turn an error in a file or folder into one that names it."""
    try:
        yield
    except OSError as error:
        raise RecordingError("cannot read the recording: {error}", error=str(error)) from None
    except (ValueError, TypeError, RecursionError) as error:
        raise RecordingError(
            "{path} is damaged: {error}", path=str(path), error=str(error)
        ) from None


@dataclass(frozen=True)
class _Header:
    """A recording before its bag is read.

    Attributes:
        facts: of run.json and circumstances.json.
    """

    folder: Path
    facts: dict[str, Any]
    run: Run
    subject: Keeper
    output: str

    def read_trace(self) -> Trace:
        kept = CastKeeper(self.subject) if self.facts.get("cast") else self.subject
        return bag.read(self.folder / BAG, kept, round(self.run.simulated_s * 1e9))


def _read_header(folder: Path) -> _Header:
    """Read the files beside the bag, and compare the bag's checksum."""
    facts = _facts(folder)
    with _refusing(folder):
        digest = content.of_file(folder / BAG)
        output = (folder / OUTPUT).read_bytes().decode("utf-8", "surrogatepass")
        run = strict_json.from_json(Run, facts["run"], strict_json.OURS)
    if digest != facts["bag_sha256"]:
        raise RecordingError(
            "{bag} is damaged: it is cut off or was changed since it was saved",
            bag=str(folder / BAG),
        )
    subject = _subject(folder, facts.get("scene", DEFAULT_SCENE))
    return _Header(folder, facts, run, subject, output)


def _loaded(found: Sequence[_Header]) -> list[Recording]:
    """Read the bags of recordings, each once a copy of this process with limits has read it.

    Nobody knows before how much a bag unpacks to, and how long its reader takes.
    """

    def errors() -> Iterator[bytes]:
        for header in found:
            try:
                header.read_trace()
                yield b""
            except RecordingError as error:
                yield json.dumps(error.message.serialise()).encode()

    made: list[Recording] = []
    many = len(found)
    limits = replace(READING, cpu_s=many * READING.cpu_s, wall_s=many * READING.wall_s)
    try:
        with closing(limited.stream(errors, limits)) as answers:
            for header, error in zip(found, answers, strict=False):  # asks for no more than that
                if error:
                    raise RecordingError(Message.parse(json.loads(error)))
                made.append(_recording(header, header.read_trace()))
    except limited.LimitHit as hit:
        folder = str(found[len(made)].folder)
        raise RecordingError(
            "the bag in {folder} cannot be read: reading it {hit}", folder=folder, hit=hit.why
        ) from None
    return made


def _recording(header: _Header, trace: Trace) -> Recording:
    facts = header.facts
    origin = facts[PROVENANCE]
    with scene_at_work(header.subject.name, RecordingError):
        _must_agree(header.folder, "ticks", header.run.ticks, trace.ticks)
        _must_agree(header.folder, "trace_sha256", header.run.trace_sha256, trace.sha256())
    own, cast = split(trace)
    return Recording(
        trace=own,
        cast=cast,
        run=header.run,
        topics=tuple(PublishedTopic(**topic) for topic in facts["topics"]),
        output=header.output,
        start=Start(**facts["start"]) if facts["start"] else None,
        scene=header.subject.name,
        provenance=strict_json.from_json(Provenance, origin, strict_json.OURS) if origin else None,
        observations=_observations(header.folder / OBSERVATIONS),
        package=_package(header.folder / PACKAGE),
        interfaces=facts[INTERFACES],
    )


def _package(path: Path) -> Trace | None:
    if not path.exists():
        return None
    with _refusing(path):
        package: Any = load_keeper(PACKAGE_SCENE)
        trace: Trace = package.decode(path.read_bytes())
        return trace


def _observations(path: Path) -> Observations:
    """Read what the process has reported; empty where an older recording has no such file."""
    if not path.exists():
        return Observations()
    with _refusing(path):
        return Observations.from_json(_read_json(path))


def _must_agree(folder: Path, key: str, stated: object, found: object) -> None:
    if stated != found:
        raise RecordingError(
            "{run} is damaged: its {key} is {told}, but the run's is {found}",
            run=str(folder / RUN),
            key=key,
            told=f"{stated!r:.80}",
            found=f"{found!r:.80}",
        )


def _subject(folder: Path, name: str) -> Keeper:
    try:
        return load_keeper(name)
    except KeyError as error:
        raise RecordingError(
            "{folder} cannot be read: {why}", folder=str(folder), why=error.args[0]
        ) from None


def _read_json(path: Path) -> dict[str, Any]:
    with _refusing(path):
        data = strict_json.loads(path.read_bytes().decode())
        if not isinstance(data, dict):
            raise ValueError(f"expected an object, found {data!r:.40}")
        return data
