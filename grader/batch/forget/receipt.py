"""The receipt of a student who was forgotten: DIR/forgotten/NUMBER.json.

It tells when, and how much of what; neither whom, nor anything made of a name: who has asked for it
notes its number.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final, Literal

from grader import files, system
from grader.message import Message, msg_many
from grader.recording.recording import now
from grader.result import json_file

FOLDER: Final = "forgotten"
SCHEMA: Final = "turtlesim-grader/forgotten/v1"
#: What is counted, in words.
_COUNTED: Final = {
    "hand_ins": msg_many("{n:,} hand-in of the class goes", "{n:,} hand-ins of the class go", 0),
    "set_aside": msg_many("{n:,} hand-in in aside/ goes", "{n:,} hand-ins in aside/ go", 0),
    "replaced_results": msg_many("{n:,} result in before/ goes", "{n:,} results in before/ go", 0),
    "runs": msg_many("{n:,} run that nobody shares goes", "{n:,} runs that nobody shares go", 0),
    "rows": msg_many("{n:,} row of older tables goes", "{n:,} rows of older tables go", 0),
    "pages": msg_many("{n:,} page of a regrade goes", "{n:,} pages of regrades go", 0),
    "groups": msg_many(
        "{n:,} group stays, without this member", "{n:,} groups stay, without this member", 0
    ),
    "others": msg_many(
        "{n:,} hand-in of others stays, without the name",
        "{n:,} hand-ins of others stay, without the name",
        0,
    ),
    "changed": msg_many(
        "{n:,} row of older tables stays, without the name",
        "{n:,} rows of older tables stay, without the name",
        0,
    ),
}


@dataclass(frozen=True)
class Receipt:
    """A receipt.

    Attributes:
        number: by which it is named; it tells nothing.
        state: "begun" until all is done; that of a call that was cut off stays so.
        begun, finished: when; `finished` is '' until then.
        grader: its version.
        counts: how much of what has gone, or was changed: the keys of `_COUNTED`.
        unplayable: hand-ins of others whose recording could not be kept without the name.
        left: how many files still have the name: others than the grader's.
    """

    number: str
    state: Literal["begun", "done"]
    begun: str
    finished: str = ""
    grader: str = ""
    counts: Mapping[str, int] = field(default_factory=dict)
    unplayable: int = 0
    left: int = 0
    schema: Literal["turtlesim-grader/forgotten/v1"] = SCHEMA

    def put(self, out: Path) -> None:
        """Write it.

        Raises:
            UsageError: it cannot be written.
        """
        data = json_file.with_phrases(self)
        files.put(path_of(out, self.number), json_file.text(data).encode())


def described(counts: Mapping[str, int]) -> list[Message]:
    """Return what goes and changes, a sentence each."""
    return [_COUNTED[name].given(n=counts[name]) for name in _COUNTED if counts.get(name)]


def path_of(out: Path, number: str) -> Path:
    """Return the path of a receipt."""
    return out / FOLDER / f"{number}.json"


def begun(out: Path, counts: Mapping[str, int]) -> Receipt:
    """Write the receipt of what begins."""
    files.clear(out / FOLDER)  # it may be a link to another folder
    made = Receipt(
        secrets.token_hex(6), "begun", now(), grader=system.grader_version(), counts=dict(counts)
    )
    made.put(out)
    return made


def finished(out: Path, receipt: Receipt, unplayable: int, left: int) -> Receipt:
    """Write that all is done."""
    done = replace(receipt, state="done", finished=now(), unplayable=unplayable, left=left)
    done.put(out)
    return done
