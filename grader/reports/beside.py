"""The artifacts of a result: the picture, the recordings, and the output of the node."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path

from grader.errors import RecordingError
from grader.exercise.result.result import Result
from grader.recording import reading
from grader.recording.recording import Recording, Recordings
from grader.recording.subject import DEFAULT_SCENE
from grader.text.message import Message
from grader.text.strings import plain_all


class Beside:
    """The artifacts beside a result file; each is read when it is first used.

    Args:
        recordings: those of a new result, which then need not be read back.

    Attributes:
        folder: of the result file; artifacts outside it are ignored.
    """

    def __init__(self, result: Result, folder: Path, recordings: Recordings | None = None) -> None:
        self.folder = folder
        self._artifacts = plain_all(dict(result.artifacts))
        self._runs = 1 + len(result.varied_runs)
        self._made = recordings

    @cached_property
    def canvas_path(self) -> Path | None:
        """The path of the final window's picture; None where there is none."""
        path = self._artifact("canvas")
        return path if path is not None and path.is_file() else None  # reading a pipe would block

    @property
    def canvas_file(self) -> Path | None:
        """`canvas_path` if the picture has to be read from the file, else None."""
        return None if self._made is not None else self.canvas_path

    @property
    def solid_words(self) -> str:
        """What only a page could draw, in words, where no recording is kept; '' for nothing."""
        return ""

    @cached_property
    def scene(self) -> str:
        """The name of the scene; the default one where there is no recording."""
        if self._made is not None:
            return self._made.nominal.scene
        base = self._artifact("recording")
        return DEFAULT_SCENE if base is None else reading.scene_of(base)

    @cached_property
    def recordings(self) -> Mapping[int, Recording | Message]:
        """Run (0 nominal, 1, 2, ... varied) -> its recording, or why that cannot be read."""
        if self._made is not None:
            return dict(enumerate(self._made))
        base = self._artifact("recording")
        if base is None:
            return {}
        loaded: dict[int, Recording | Message] = {}
        for run in range(self._runs):
            try:
                loaded[run] = reading.load(base / f"varied_{run}" if run else base)
            except RecordingError as error:
                loaded[run] = error.message
        return loaded

    @cached_property
    def output(self) -> str:
        """The output of the node in the nominal run."""
        path = None if self._made is not None else self._artifact("output")
        if path is not None and path.is_file():
            return path.read_bytes().decode(errors="replace")
        nominal = self.recordings.get(0)
        return nominal.output if isinstance(nominal, Recording) else ""

    def _artifact(self, name: str) -> Path | None:
        """Return the path of an artifact; None if it is missing or outside the result's folder."""
        relative = self._artifacts.get(name)
        if not relative:
            return None
        folder = self.folder.resolve()
        path = (folder / relative).resolve()
        return path if path.is_relative_to(folder) and path.exists() else None
