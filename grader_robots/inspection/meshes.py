"""The files of a description's meshes, as few triangles as a picture needs.

STL is read here, as ROS packages mostly have it; other kinds by trimesh, where it is installed (the
extra `robots`). A mesh is a stranger's file: it is read in a copy of the process, which has limits.
"""

from __future__ import annotations

import base64
import os
import re
from itertools import islice
from typing import Any, Final

#: A file may have so many bytes and triangles.
_MOST_BYTES: Final = 30_000_000
_MOST_READ: Final = 400_000
#: All that are read of a package may take so much processor time [s]: it is for a picture.
CPU_S: Final = 30.0
#: What is read by trimesh; it knows more, archives of what may be any size among them.
_KINDS: Final = (".obj", ".ply", ".dae", ".gltf", ".glb", ".off")
#: So many triangles of a mesh are left, and so many meshes are read.
MOST_TRIANGLES: Final = 2000
MOST_MESHES: Final = 30
#: A coarser mesh has its corners on a grid of so many steps.
_STEPS: Final = (96, 64, 44, 30, 20, 14, 10)
_HEADER: Final = 84
_VERTEX: Final = re.compile(
    rb"^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)[ \t\r]*$", re.MULTILINE
)


def surface(path: str) -> str:
    """Of a file its triangles, nine float32 each, little-endian, in base64; '' for none."""
    import numpy as np

    try:
        if os.path.getsize(path) > _MOST_BYTES:
            return ""
        corners = _read(path)
    except MemoryError:
        raise
    except Exception:  # a reader of strange files raises anything
        return ""
    if corners is None or not len(corners) or len(corners) > _MOST_READ:
        return ""
    if not (np.abs(corners) < 1e9).all():
        return ""
    return base64.b64encode(_coarse(corners).astype("<f4").tobytes()).decode("ascii")


def _read(path: str) -> Any:
    """Triangles, float64 (n, 3, 3); None for a kind that nobody reads here."""
    if path.lower().endswith(".stl"):
        with open(path, "rb") as file:
            return _stl(file.read(_MOST_BYTES + 1))
    if not path.lower().endswith(_KINDS):
        return None
    try:
        import trimesh
    except ImportError:
        return None
    import numpy as np

    scene = trimesh.load(path, force="mesh", process=False, skip_materials=True)
    return np.asarray(scene.triangles, dtype=np.float64).reshape(-1, 3, 3)


def _stl(data: bytes) -> Any:
    """Both kinds of it: that in words begins with `solid`, but so do some of the other."""
    import numpy as np

    count = int.from_bytes(data[_HEADER - 4 : _HEADER], "little")
    if len(data) == _HEADER + 50 * count:
        kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
        return np.frombuffer(data, kind, count, _HEADER)["corners"].astype(np.float64)
    vertices = islice(_VERTEX.finditer(data), 3 * _MOST_READ + 3)
    numbers = [float(each) for match in vertices for each in match.groups()]
    return np.array(numbers[: len(numbers) // 9 * 9]).reshape(-1, 3, 3)


def _coarse(corners: Any) -> Any:
    """No more triangles than there may be: corners that are near each other become one."""
    import numpy as np

    low = corners.min(axis=(0, 1))
    size = float((corners.max(axis=(0, 1)) - low).max()) or 1.0
    for steps in _STEPS:
        if len(corners) <= MOST_TRIANGLES:
            break
        at = np.round((corners - low) / size * steps)
        flat = np.unique(at.reshape(-1, 9), axis=0).reshape(-1, 3, 3)
        a, b, c = flat[:, 0], flat[:, 1], flat[:, 2]
        is_there = (a != b).any(axis=1) & (b != c).any(axis=1) & (a != c).any(axis=1)
        left = flat[is_there]
        if len(left) <= MOST_TRIANGLES or steps == _STEPS[-1]:
            return left[:MOST_TRIANGLES] * (size / steps) + low
    return corners
