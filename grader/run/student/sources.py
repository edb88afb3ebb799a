"""Looks at the submission's own files once, when they are loaded, and tells of their slips."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from grader.run.student import slips, telling
from grader.run.student.telling import Teller

#: So many slips are told of.
MOST = 20
#: Sources that are longer are not looked at [characters].
MOST_SOURCE = 200_000


class Sources:
    """What they show; see `grader.recording.conduct.Slip`."""

    def __init__(self, teller: Teller) -> None:
        self._teller = teller
        self._has_looked = False

    def look(self) -> None:
        """Tell of the slips in what is loaded."""
        sources = self._teller.loaded()
        if self._has_looked or not sources:
            return
        self._has_looked = True
        if sum(map(len, sources.values())) > MOST_SOURCE:
            return
        for slip in slips.find(sources)[:MOST]:
            place = self._teller.place_in(slip.file, slip.line)
            self._tell(slip.kind, slip.name, slip.near, place)

    def look_beside(self, name: str, place: dict[str, Any]) -> None:
        """A module that was not found may lie in the package that asks for it."""
        folder = str(place["file"]).rpartition("/")[0]
        if not folder or not name.isidentifier():
            return
        beside = Path(self._teller.root, folder, name)
        if beside.is_dir() or beside.with_suffix(".py").is_file():
            self._tell("beside", name, ".".join((*folder.split("/"), name)), place)

    def _tell(self, kind: str, name: str, near: str, place: dict[str, Any]) -> None:
        names = {"name": name[: telling.LONGEST], "near": near[: telling.LONGEST]}
        self._teller.tell("slip", {"kind": kind, **names, "place": place})
