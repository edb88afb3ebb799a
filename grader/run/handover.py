"""The file in which the simulator's process leaves what it has recorded.

The topics as JSON, behind its length in eight bytes; then the trace (`grader.scenes.transfer`).
Nothing is unpickled: whoever wrote the file could have the grader do as he likes.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from struct import Struct

from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.recording.recording import PublishedTopic
from grader.scenes import transfer
from grader.scenes.scene import Scene, Trace

_LENGTH = Struct("<Q")
#: More than any run leaves; the grader's process holds it a few times over.
MOST_BYTES = 256_000_000


def leave(path: Path, scene: Scene, trace: Trace, topics: tuple[PublishedTopic, ...]) -> None:
    """In the simulator's process: write it."""
    facts = json.dumps([asdict(topic) for topic in topics]).encode()
    path.write_bytes(_LENGTH.pack(len(facts)) + facts + transfer.pack(trace, scene))


def _topic(words: dict[str, str]) -> PublishedTopic:
    topic = PublishedTopic(**words)
    if not isinstance(topic.topic, str) or not isinstance(topic.type, str):
        raise TypeError("a topic and its type are texts")
    return topic


def fetch(file: int, scene: Scene) -> tuple[Trace, tuple[PublishedTopic, ...]]:
    """In the grader's process: read it from an open file descriptor.

    Raises:
        GraderFailure: it is not what `leave` writes.
    """
    try:
        with open(file, "rb", closefd=False) as opened:
            opened.seek(0)
            data = opened.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise ValueError(f"more than {MOST_BYTES} bytes")
        (length,) = _LENGTH.unpack_from(data)
        end = _LENGTH.size + length
        # of bytes, json.loads would guess the encoding
        topics = tuple(map(_topic, json.loads(data[_LENGTH.size : end].decode("utf-8"))))
        return transfer.unpack(data[end:], scene), topics
    except Exception as error:
        raise GraderFailure(
            say("the simulator left no recording: {why}", why=str(error)[:200])
        ) from error
