"""What is of other packages: launch files that description packages make use of, and modules.

Of two packages it is known what their launch files start. A module that nobody has here, such as
`ros_gz_sim.actions`, stands for itself: what is made with it is an action of which only the package
is known. Whatever else it is used for ends in `NotKnown`.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, Final

from grader.submission.examining.steps import not_there

PUBLISHER: Final = "robot_state_publisher"
_NODE: Final = {"name": "", "namespace": "", "arguments": [], "remappings": []}


def nodes_of(
    package: str,
    file: str,
    arguments: dict[str, str],
    share: Callable[[str], str],
    expand: Callable[[str], str],
) -> list[dict[str, Any]]:
    """The nodes that a launch file of another package starts, as far as that is known.

    Args:
        arguments: that it gets.
        share: the share folder of a package.
        expand: what xacro makes of a file.
    """
    if package == "urdf_launch":
        model = (arguments.get("urdf_package", ""), arguments.get("urdf_package_path", ""))
        config = arguments.get("rviz_config", "")
        gui = arguments.get("jsp_gui", "true")
    elif (package, file) == ("urdf_tutorial", "launch/display.launch.py"):
        model = (package, arguments.get("model", ""))
        config, gui = arguments.get("rvizconfig", ""), arguments.get("gui", "true")
    else:
        return []
    text = expand(os.path.join(share(model[0]), model[1]))
    description = {"name": "robot_description", "value": text, "wrapped": True}
    found = [_node(PUBLISHER, parameters=[description])]
    if file.endswith("display.launch.py"):
        suffix = "_gui" if gui.lower() in ("true", "1") else ""
        found.append(_node(f"joint_state_publisher{suffix}"))
        config = config or f"{share(package)}/rviz/urdf.rviz"
        found.append(_node("rviz2", arguments=["-d", config]))
    return found


def _node(package: str, **more: Any) -> dict[str, Any]:
    return {**_NODE, "package": package, "executable": package, "parameters": [], **more}


def module(name: str) -> ModuleSpec:
    """A module of another package, which nobody has here."""
    return spec_of(_Module(name))


def spec_of(made: ModuleType) -> ModuleSpec:
    """By which a module is imported that is made already."""
    return ModuleSpec(made.__name__, _Loader(made), is_package=True)


class _Loader(Loader):
    def __init__(self, made: ModuleType) -> None:
        self._made = made

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._made

    def exec_module(self, module: ModuleType) -> None:
        pass


class _Module(ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return _Name(f"{self.__name__}.{name}")


class _Name:
    """Something in such a module; calling it makes an action."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return _action(self._name, kwargs.get("condition"))

    def __getattr__(self, name: str) -> Any:
        raise not_there(self._name)


def _action(of: str, condition: Any) -> Any:
    from launch import Action  # the double: this is in the copy that evaluates

    class Foreign(Action):  # type: ignore[misc, unused-ignore]
        def execute(self, context: Any) -> None:
            package, _, name = of.partition(".")
            context.record.add_external(package, name)

        def __getattr__(self, name: str) -> Any:
            raise not_there(of)

    return Foreign(condition=condition)
