"""A double of ROS's package `launch`, which starts nothing; see `launch._core`."""

from logging import getLogger

from launch import _core, actions, conditions, events, substitutions
from launch._core import (
    Action,
    Condition,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    LaunchDescriptionSource,
    Substitution,
    module,
    unknown,
)
from launch.events import Event, EventHandler, event_handlers

SomeSubstitutionsType = SomeActionsType = SomeEntitiesType = object

action = module("launch.action", Action)
condition = module("launch.condition", Condition)
descriptions = module("launch.descriptions", _core.Executable)
frontend = module("launch.frontend", __path__=[])  # extensions of it are not followed
launch_context = module("launch.launch_context", LaunchContext)
launch_description = module("launch.launch_description", LaunchDescription)
launch_description_entity = module("launch.launch_description_entity", LaunchDescriptionEntity)
launch_description_source = module("launch.launch_description_source", LaunchDescriptionSource)
launch_description_sources = module(
    "launch.launch_description_sources",
    _core.AnyLaunchDescriptionSource,
    _core.FrontendLaunchDescriptionSource,
    _core.InvalidPythonLaunchFileError,
    _core.PythonLaunchDescriptionSource,
)
logging = module("launch.logging", get_logger=getLogger)
some_actions_type = module("launch.some_actions_type", SomeActionsType=object)
some_entities_type = module("launch.some_entities_type", SomeEntitiesType=object)
some_substitutions_type = module("launch.some_substitutions_type", SomeSubstitutionsType=object)
substitution = module("launch.substitution", Substitution)
utilities = module(
    "launch.utilities", _core.normalize_to_list_of_substitutions, _core.perform_substitutions
)

__all__ = [
    "Action",
    "Condition",
    "Event",
    "EventHandler",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchDescriptionSource",
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
