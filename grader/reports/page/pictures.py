"""Pictures inside a document: PNG as data URI, small enough for the systems that take them."""

from __future__ import annotations

import base64
import io

from PIL import Image, UnidentifiedImageError

from grader.reports.report import Report

#: A picture above this is reduced to 256 colours. Only noise is: a spiral has some 20 kB.
_LIMIT_BYTES = 150_000


def canvas_uri(report: Report) -> str:
    """The window at the end of the nominal run; '' where no picture lies beside the result."""
    path = report.beside.canvas_file
    if path is not None:
        try:
            with Image.open(path, formats=["PNG"]) as image:
                if max(image.size) <= report.scene.plane.size_px:
                    # anew, and without anything else that the file may hold
                    return _uri(_png(image.convert("RGB")))
        except (OSError, UnidentifiedImageError):
            pass  # a damaged picture; the recording may hold it whole
    return window_uri(report, 0)


def window_uri(report: Report, run: int) -> str:
    """The window at the end of a run, as its recording holds it; '' without a recording."""
    recording = report.recordings.get(run)
    if recording is None:
        return ""
    return _uri(recording.png["window"])


def _uri(data: bytes) -> str:
    if len(data) > _LIMIT_BYTES:
        with Image.open(io.BytesIO(data)) as image:
            data = _png(image.quantize(256), optimize=True)
    return f"data:image/png;base64,{base64.b64encode(data).decode()}"


def _png(image: Image.Image, optimize: bool = False) -> bytes:
    out = io.BytesIO()
    image.save(out, format="PNG", optimize=optimize)
    return out.getvalue()
