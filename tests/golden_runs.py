"""The recorded runs of the original, read from tests/golden."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

FOLDER = Path(__file__).with_name("golden")
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))


def load(name: str) -> dict[str, Any]:
    """One recording."""
    loaded: dict[str, Any] = json.loads((FOLDER / f"{name}.json").read_text())
    return loaded


def drawing(name: str) -> npt.NDArray[np.uint8]:
    """A recorded drawing, RGBA (500, 500, 4)."""
    with Image.open(FOLDER / f"{name}.path.png") as image:
        return np.asarray(image.convert("RGBA"))


def differing_pixels(ours: npt.NDArray[np.uint8], theirs: npt.NDArray[np.uint8]) -> int:
    """How many pixels differ; the colour of an unpainted pixel does not count."""
    painted = theirs[..., 3] > 0
    other = (ours[..., 3] > 0) != painted
    return int(np.count_nonzero(other | (painted & (ours != theirs).any(axis=-1))))
