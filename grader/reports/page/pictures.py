"""Pictures inside a document: PNG as data URI, small enough for the systems that take them."""

from __future__ import annotations

import base64
import io

from PIL import Image, UnidentifiedImageError

from grader.reports.report import Report

#: A picture above this is reduced to 256 colours. Only noise is: a spiral has some 20 kB.
_LIMIT_BYTES = 150_000
#: One that only who has no script and who prints the page gets to see.
_STILL_LIMIT_BYTES = 30_000


def canvas_uri(report: Report) -> str:
    """The window at the end of the nominal run; '' where no picture lies beside the result."""
    limit = _limit(report)
    path = report.beside.canvas_file
    if path is not None:
        try:
            with Image.open(path, formats=["PNG"]) as image:
                if max(image.size) <= report.scene.plane.size_px:
                    # anew, and without anything else that the file may hold
                    return _uri(_png(image.convert("RGB")), limit)
        except (OSError, UnidentifiedImageError):
            pass  # a damaged picture; the recording may hold it whole
    return window_uri(report, 0)


def window_uri(report: Report, run: int) -> str:
    """The window at the end of a run, as its recording holds it; '' without a recording."""
    return _recorded(report, run, "window")


def plane_uri(report: Report, run: int) -> str:
    """The scene's plane, where the window shows something else; '' where there is none."""
    return _recorded(report, run, "plan")


def _recorded(report: Report, run: int, name: str) -> str:
    recording = report.recordings.get(run)
    if recording is None or name not in recording.png:
        return ""
    limit = _limit(report) if name == "window" else _LIMIT_BYTES
    return _uri(recording.png[name], limit)


def _limit(report: Report) -> int:
    return _LIMIT_BYTES if report.scene.window_is_plane else _STILL_LIMIT_BYTES


def _uri(data: bytes, limit: int) -> str:
    if len(data) > limit:
        with Image.open(io.BytesIO(data)) as image:
            data = _png(image.quantize(256), optimize=True)
    return f"data:image/png;base64,{base64.b64encode(data).decode()}"


def _png(image: Image.Image, optimize: bool = False) -> bytes:
    out = io.BytesIO()
    image.save(out, format="PNG", optimize=optimize)
    return out.getvalue()
