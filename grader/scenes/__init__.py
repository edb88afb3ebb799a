"""What runs beside a submission, one folder a scene; `load_scene` finds one by its name."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grader.scenes.scene import Scene

#: The scenes that there are; each is a module of this package with an object `SCENE`.
NAMES = ("turtlesim", "robot", "package")
#: Packages whose messages nearly every submission to one of them imports; some may not be there.
MESSAGES = (
    *("geometry_msgs", "std_msgs", "std_srvs", "turtlesim", "turtlesim_msgs"),
    *("sensor_msgs", "tf2_msgs"),
)


def load_scene(name: str) -> Scene:
    """The scene of this name.

    Raises:
        KeyError: there is none.
    """
    if name not in NAMES:
        raise KeyError(f"there is no scene {name!r}; there are: {', '.join(NAMES)}")
    scene: Scene = importlib.import_module(f"{__name__}.{name}.scene").SCENE
    return scene
