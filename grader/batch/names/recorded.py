"""Replace names in recordings and results: in all texts that a submission has had a part in.

Of a bag the messages with texts are read and written anew, so that what is played, judged again
and reported of it has no names. Numbers and pictures stay.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final, TypeVar

import numpy as np

from grader import strict_json
from grader.batch.names.replacing import Names
from grader.recording.beside import apart, together
from grader.recording.channel import divided
from grader.recording.observations import STRANGERS, Observations
from grader.recording.recording import LONGEST_OUTPUT, Provenance, Recording, Recordings, Run
from grader.recording.subject import BagMessage, Subject, Trace, load_subject
from grader.result.result import Result, RunSummary
from grader.rosidl.bag_types import BagTypes
from grader.text import map_all

#: Of a program [characters]; see recording.schema.json.
_LONGEST_NAME: Final = 100
_SomeRun = TypeVar("_SomeRun", bound=Run)


def without_names(found: Recordings, names: Names) -> Recordings:
    """Return recordings without names; the same object where there are none.

    Raises:
        ValueError, KeyError, TypeError: a trace cannot be made without them.
    """
    made = Recordings(
        _recording(found.nominal, names), tuple(_recording(each, names) for each in found.varied)
    )
    pairs = zip(found, made, strict=True)
    is_same = found.nominal.provenance == made.nominal.provenance
    is_same &= found.nominal.interfaces == made.nominal.interfaces
    return found if is_same and all(one == other for one, other in pairs) else made


def without_hash(found: Recordings) -> Recordings:
    """Return recordings without the hash of what was handed in, which depends on names of files."""
    origin = found.nominal.provenance
    if origin is None:
        return found
    blank = replace(origin, submission_sha256="")
    return replace(found, nominal=replace(found.nominal, provenance=blank))


def _recording(found: Recording, names: Names) -> Recording:
    subject = load_subject(found.scene)
    kept, keeper = together(found.trace, found.cast, subject)
    trace = _trace(kept, keeper, names)
    own, cast = apart(trace)
    sha256 = found.run.trace_sha256 if trace is kept else trace.sha256()
    observed: Observations = map_all(found.observations, _clipped(names))
    package = found.package
    if package is not None:  # its surfaces are triangles in base64, which no name is found in
        package = map_all(package, names)
    return replace(
        found,
        trace=own,
        cast=cast,
        run=_run(replace(found.run, trace_sha256=sha256), names),
        topics=map_all(found.topics, names),
        output=names(found.output),
        observations=observed,
        package=package,
        provenance=_origin(found.provenance, names),
        interfaces=map_all(found.interfaces, names),
    )


def _origin(found: Provenance | None, names: Names) -> Provenance | None:
    return found and replace(found, submission=names(found.submission))


def _clipped(names: Names) -> Callable[[str], str]:
    return lambda text: names(text)[: int(STRANGERS.characters)]


def _run(run: _SomeRun, names: Names) -> _SomeRun:
    """Return a run, or its summary, whose texts have no names; its words and hashes stay."""
    programs = (
        replace(
            each,
            name=names(each.name)[:_LONGEST_NAME],
            package=names(each.package)[:_LONGEST_NAME],
            executable=names(each.executable)[:_LONGEST_NAME],
            output=names(each.output)[-LONGEST_OUTPUT:],
        )
        for each in run.programs
    )
    flags = map_all(run.flags, names)
    return replace(run, flags=flags, programs=tuple(programs))


def _trace(trace: Trace, subject: Subject, names: Names) -> Trace:
    """Return a trace without names; the same object where there are none."""
    definitions = subject.definitions_of(trace)
    before = subject.to_messages(trace)
    texts = _Texts(definitions, names)
    after = [
        BagMessage(m.time_ns, names(m.topic), names(m.msgtype), texts.changed(m.msgtype, m.data))
        for m in before
    ]
    topics = [(names(topic), names(kind)) for topic, kind in subject.bag_topics(trace)]
    if after == before and topics == list(subject.bag_topics(trace)):
        return trace
    topics = list(dict.fromkeys([*topics, *((m.topic, m.msgtype) for m in after)]))
    numbers = {each: number for number, each in enumerate(topics)}
    columns = [(m.time_ns, numbers[m.topic, m.msgtype], len(m.data)) for m in after]
    times_ns, of_topics, sizes = np.array(columns, np.int64).reshape(-1, 3).T
    data = np.frombuffer(b"".join(m.data for m in after), np.uint8)
    ends = np.cumsum(sizes)
    channels = divided(topics, times_ns, of_topics, ends - sizes, ends, data)
    return subject.from_channels(channels, trace.duration_ns)


class _Texts:
    """Changes the texts in messages.

    Args:
        definitions: of all types of a bag.
    """

    def __init__(self, definitions: Mapping[str, str], names: Names) -> None:
        self._types = BagTypes(definitions)
        self._names = names
        self._have: dict[str, bool] = {}

    def changed(self, msgtype: str, data: bytes) -> bytes:
        """Return the CDR of a message without names; the same bytes where there are none."""
        if msgtype not in self._have:
            self._have[msgtype] = self._types.has_texts(msgtype)
        if not self._have[msgtype]:
            return data
        values = self._types.values(data, msgtype)
        made = self._value(values)
        return data if made == values else self._types.cdr(made, msgtype)

    def _value(self, value: Any) -> Any:
        """Return values without names; their fields are called as before."""
        if isinstance(value, str):
            return self._text(value)
        if isinstance(value, dict):
            return {name: self._value(each) for name, each in value.items()}
        if isinstance(value, list) and value and isinstance(value[0], str | dict):
            return [self._value(each) for each in value]
        return value

    def _text(self, text: str) -> str:
        """Return a text without names; one that is JSON stays so."""
        if text[:1] in ("{", "["):
            try:
                data = strict_json.loads(text)
            except (ValueError, RecursionError):
                return self._names(text)
            made = map_all(data, self._names)
            if made == data:
                return text
            return json.dumps(made, separators=None if '": ' in text else (",", ":"))
        return self._names(text)


def result_without_names(result: Result, names: Names, recordings: Recordings | None) -> Result:
    """Return a result without names, and without the hash of what was handed in.

    Args:
        recordings: those of the result, already without names; their traces may have other hashes.
    """
    runs: list[RunSummary] = [result.run, *result.varied_runs]
    hashes = [] if recordings is None else [each.run.trace_sha256 for each in recordings]
    if len(hashes) == len(runs):
        pairs = zip(runs, hashes, strict=True)
        runs = [replace(run, trace_sha256=sha256) for run, sha256 in pairs]
    nominal, *varied = (_run(each, names) for each in runs)
    origin = result.provenance
    if origin is not None and origin.recorded is not None:
        recorded = replace(
            origin.recorded, submission=names(origin.recorded.submission), submission_sha256=""
        )
        origin = replace(origin, recorded=recorded)
    return replace(
        result,
        submission=names(result.submission),
        run=nominal,
        varied_runs=tuple(varied),
        verdicts=map_all(result.verdicts, names),
        diagnosis=map_all(result.diagnosis, names),
        provenance=origin,
    )
