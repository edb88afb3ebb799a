"""A double of ROS's package `launch`, which starts nothing; see `launch._core`."""

from logging import getLogger

from launch import _core, actions, events, substitutions, utilities
from launch._core import (
    Action,
    Condition,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    LaunchDescriptionSource,
    LaunchIntrospector,
    LaunchService,
    Substitution,
    conditions,
    module,
    unknown,
)
from launch.events import Event, EventHandler, event_handlers

SomeSubstitutionsType = SomeActionsType = SomeEntitiesType = object

descriptions = module("launch.descriptions", _core.Executable)
frontend = module("launch.frontend")  # extensions of it are not followed
launch_description_sources = module(
    "launch.launch_description_sources",
    _core.AnyLaunchDescriptionSource,
    _core.FrontendLaunchDescriptionSource,
    _core.InvalidPythonLaunchFileError,
    _core.PythonLaunchDescriptionSource,
)
for _name, _source in (
    ("launch_xml", _core.XMLLaunchDescriptionSource),
    ("launch_yaml", _core.YAMLLaunchDescriptionSource),
):
    _sources = module(f"{_name}.launch_description_sources", _source)
    module(_name, launch_description_sources=_sources)
logging = module("launch.logging", get_logger=getLogger)
__all__ = [
    "Action",
    "Condition",
    "Event",
    "EventHandler",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchDescriptionSource",
    "LaunchIntrospector",
    "LaunchService",
    "SomeActionsType",
    "SomeEntitiesType",
    "SomeSubstitutionsType",
    "Substitution",
    "actions",
    "conditions",
    "descriptions",
    "event_handlers",
    "events",
    "launch_description_sources",
    "logging",
    "substitutions",
    "utilities",
]
__getattr__ = unknown("launch")
