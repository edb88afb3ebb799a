"""The folder in which a recording lies on disk: a rosbag2, and small files beside its two.

| file | what | read back |
|---|---|---|
| metadata.yaml, recording.mcap | the bag: see `grader.recording.bag` | yes |
| run.json | how the run went, where it started, what the submission published on | yes |
| output.txt | what the submission printed | yes |
| circumstances.json | duration, provenance, definitions of interfaces | if it is there |
| observations.json | what the submission's process reported, if anything | if it is there |
| path.png, window.png | the bag's pictures, for people, as many as its scene makes | no |
| scenario.json | the inputs, for `python -m turtlesim_py.scenario` | no |

Two saves of equal recordings differ in circumstances.json at most. metadata.yaml comes into the
folder last, so that a save that was cut off leaves nothing that looks like a recording.

A recording may come from anywhere. What is read has a size, and the bag, which is compressed, is
read in a copy of this process with limits of time and memory. `saving` writes, `reading` reads.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

SCHEMA = "turtlesim-grader/recording/v2"
NAME = "recording"
BAG, METADATA, RUN, OUTPUT = f"{NAME}.mcap", "metadata.yaml", "run.json", "output.txt"
CIRCUMSTANCES_FILE, SCENARIO = "circumstances.json", "scenario.json"
OBSERVATIONS, PACKAGE = "observations.json", "package.json"
WINDOW_PICTURE = "window.png"
PICTURES = ("path.png", WINDOW_PICTURE)
#: In the order in which they come into the folder.
FILES = (
    *(BAG, RUN, OUTPUT, OBSERVATIONS, PACKAGE, CIRCUMSTANCES_FILE, SCENARIO),
    *PICTURES,
    METADATA,
)
#: Fields of a `Run` that are chance: the same run on another day has others.
CIRCUMSTANCES = ("wall_s", "isolation")
#: The keys beside them.
PROVENANCE, INTERFACES = "provenance", "interfaces"


def varied_in(folder: Path) -> set[int]:
    """Return the numbers of the varied runs whose folders exist."""
    names: Iterable[str] = (path.name for path in folder.glob("varied_*"))
    matches = (re.fullmatch(r"varied_([1-9]\d{0,5})", name) for name in names)
    return {int(match[1]) for match in matches if match}
