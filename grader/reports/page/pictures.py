"""Pictures inside a document: PNG as data URI, small enough for the systems that take them."""

from __future__ import annotations

import base64
import io

import numpy as np
import numpy.typing as npt
from PIL import Image, UnidentifiedImageError

from grader.reports.report import Report
from turtlesim_py.world.canvas import SIZE_PX

#: A picture above this is reduced to 256 colours. Only noise is: a spiral has some 20 kB.
_LIMIT_BYTES = 150_000


def canvas_uri(report: Report) -> str:
    """The window at the end of the nominal run; '' where no picture lies beside the result."""
    if report.canvas_path is not None:
        try:
            with Image.open(report.canvas_path, formats=["PNG"]) as image:
                if max(image.size) <= SIZE_PX:
                    return _uri(image.convert("RGB"))
        except (OSError, UnidentifiedImageError):
            pass  # a damaged picture; the recording may hold it whole
    return window_uri(report.recordings[0].window) if 0 in report.recordings else ""


def window_uri(window: npt.NDArray[np.uint8]) -> str:
    """A recording's window, uint8 array (height, width, 3)."""
    return _uri(Image.fromarray(window))


def _uri(image: Image.Image) -> str:
    data = _png(image)
    if len(data) > _LIMIT_BYTES:
        data = _png(image.quantize(256))
    return f"data:image/png;base64,{base64.b64encode(data).decode()}"


def _png(image: Image.Image) -> bytes:
    out = io.BytesIO()
    image.save(out, format="PNG", optimize=True)
    return out.getvalue()
