"""What runs beside a submission, one folder a scene; `load_scene` finds one by its name."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grader.scenes.live import LivePage
    from grader.scenes.playback import Playback
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


def load_words(name: str) -> ModuleType:
    """What a scene's processes say as texts: `REMARKS`."""
    return importlib.import_module(f"{__name__}.{name}.remarked")


def load_player(name: str) -> Callable[[Playback], str] | None:
    """What makes a page that plays runs of a scene; None where it has no such page.

    The page is HTML that needs nothing beside it. What makes it raises RecordingError where a run
    cannot be played.
    """
    if name not in NAMES or importlib.util.find_spec(f"{__name__}.{name}.player") is None:
        return None
    render: Callable[[Playback], str] = importlib.import_module(
        f"{__name__}.{name}.player.page"
    ).render
    return render


def load_live(name: str) -> Callable[[int], LivePage] | None:
    """What makes a page on which runs of a scene are seen while they go on; None where none does.

    It gets the page's port, 0 for any that is free, and raises OSError where it cannot be served.
    """
    if name not in NAMES or importlib.util.find_spec(f"{__name__}.{name}.live") is None:
        return None
    serve: Callable[[int], LivePage] = importlib.import_module(f"{__name__}.{name}.live.page").serve
    return serve
