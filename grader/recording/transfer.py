"""Serialises a trace to send it to another of our processes: the messages that a bag would hold.

The topics as JSON, behind its length in eight bytes; then of each message its time, the number of
its topic and its length; then the CDR of all, one behind the other. Nothing is unpickled.
"""

from __future__ import annotations

import json
from struct import Struct

import numpy as np

from grader.recording.channel import divided
from grader.recording.subject import Subject, Trace

_LENGTH = Struct("<Q")
_COLUMNS = np.dtype([("time_ns", "<i8"), ("topic", "<i8"), ("size", "<i8")])


class NotRead(ValueError):
    """A subject's own `from_channels` cannot read what `to_messages` has written, or not all."""


def pack(trace: Trace, subject: Subject) -> bytes:
    messages = subject.to_messages(trace)
    topics = [*subject.bag_topics(trace), *((each.topic, each.msgtype) for each in messages)]
    numbers = {each: number for number, each in enumerate(dict.fromkeys(topics))}
    columns = np.array(
        [(m.time_ns, numbers[m.topic, m.msgtype], len(m.data)) for m in messages], _COLUMNS
    )
    if (np.diff(columns["time_ns"]) < 0).any():
        raise ValueError(f"to_messages() of {subject.name} is not in the order of times")
    facts = {"duration_ns": trace.duration_ns, "sha256": trace.sha256()}
    head = json.dumps({**facts, "topics": [*numbers], "messages": len(messages)})
    data = b"".join(message.data for message in messages)
    return _LENGTH.pack(len(head)) + head.encode("ascii") + columns.tobytes() + data


def unpack(packed: bytes, subject: Subject) -> Trace:
    """Parse a trace."""
    failure: type[ValueError] = ValueError
    try:
        (length,) = _LENGTH.unpack_from(packed)
        begin = _LENGTH.size + length
        head = json.loads(packed[_LENGTH.size : begin].decode("ascii"))
        columns = np.frombuffer(packed, _COLUMNS, head["messages"], begin)
        data = np.frombuffer(packed, np.uint8, offset=begin + columns.nbytes)
        if (columns["size"] < 0).any() or columns["size"].sum(dtype=object) != len(data):
            raise ValueError("its messages have other lengths")
        ends = np.cumsum(columns["size"])
        order = (columns["time_ns"], columns["topic"], ends - columns["size"], ends)
        channels = divided(head["topics"], *order, data)
        if sum(map(len, channels)) != len(columns):
            raise ValueError("a message is of no topic")
        duration_ns = head["duration_ns"]
        if type(duration_ns) is not int:
            raise ValueError(f"it lasts {duration_ns!r:.40} ns")
        failure = NotRead
        trace = subject.from_channels(channels, duration_ns)
        if trace.sha256() != head["sha256"]:
            raise ValueError("from_channels() gives back another sha256() than to_messages() got")
        return trace
    except MemoryError:  # a limit
        raise
    except Exception as error:  # whatever it is that one of the readers raises
        raise failure(f"no trace of {subject.name}: {type(error).__name__}: {error}") from error
