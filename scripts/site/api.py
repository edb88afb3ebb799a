"""Names what the pages of the Python API show; mkdocstrings reads it from the sources."""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from types import ModuleType

import grader
import grader.testing
from grader.recording import subject, view
from grader.scenes import scene


def of(module: ModuleType) -> list[str]:
    """Return what a module defines for others."""
    defined = {name for name, value in vars(module).items() if is_of(value, module)}
    return [f"{module.__name__}.{name}" for name in sorted(defined) if not name.startswith("_")]


def is_of(value: object, module: ModuleType) -> bool:
    """Whether a class or function is defined in a module."""
    return getattr(value, "__module__", "") == module.__name__ and hasattr(value, "__qualname__")


#: Page -> its heading, what is said first, and what it shows.
PAGES = {
    "grader": (
        "grader",
        "To grade from Python and to write checks; [how](../docs/python-api.md).",
        [f"grader.{name}" for name in grader.__all__],
    ),
    "testing": (
        "grader.testing",
        "To try exercises, scenes and reports; [how](../docs/check-exercise.md).",
        [f"grader.testing.{name}" for name in sorted(grader.testing.__all__)],
    ),
    "scenes": (
        "Scenes",
        "What a scene is made of, and what is recorded of it; [how to write "
        "one](../docs/write-a-scene.md).",
        [*chain(*map(of, (scene, subject, view))), "grader.message.Message", "grader.message.msg"],
    ),
    "reports": (
        "Reports",
        "To add a format for `grader report`: a `Format`, named by an entry point of the group "
        "`grader.reports`; [those there are](../docs/reports.md).",
        ["grader.reports.Format", "grader.reports.Report", "grader.reports.ErrorReport"],
    ),
}


def lay_out(into: Path) -> None:
    """Write the pages."""
    into.mkdir(parents=True)
    for page, (heading, said, shown) in PAGES.items():
        parts = [f"# {heading}", said, *(f"::: {name}" for name in shown)]
        (into / f"{page}.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")
