"""Pictures to PNG files; the world itself knows no files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image


def save_png(picture: NDArray[np.uint8], path: Path) -> None:
    """Write a picture, RGB (height, width, 3) or RGBA (height, width, 4).

    Raises:
        OSError: the file cannot be written.
    """
    Image.fromarray(picture).save(path, format="PNG")
