"""What to do about the error that a launch file ends with: one line for each that is usual."""

from __future__ import annotations

from typing import Final

from grader.language.phrase import say

_NAMES: Final = say(
    "Compare the names of the arguments with those of your ROS release: "
    "node_executable and node_name are called executable and name since "
    "Foxy."
)
#: Words of an error, all of which it has -> what to do. The first that fit count.
_ADVICE: Final = (
    (
        ("file not found", "xacro/"),
        say(
            "Command joins its parts as they stand: a blank is missing, Command(['xacro ', path])."
        ),
    ),
    (("keyword", "unexpected"), _NAMES),
    (("keyword", "'executable'"), _NAMES),
    (
        ("launch configuration", "does not exist"),
        say(
            "DeclareLaunchArgument(NAME, default_value=...) has to stand in the "
            "list before what uses it. Compare the names letter by letter."
        ),
    ),
    (
        ("Failed to normalize", "float"),
        say("Arguments of a program are texts: write '0.1', not 0.1."),
    ),
    (
        ("values to unpack",),
        say(
            "launch_arguments takes pairs: {{'NAME': value}}.items(), with .items()"
            " behind the dict."
        ),
    ),
    (
        ("'parameters' given to Node", "dict"),
        say("parameters is a list: parameters=[{{...}}], with brackets round the dict."),
    ),
    (
        ("generate_launch_description", "NoneType"),
        say("The function's last line is: return LaunchDescription([...])."),
    ),
    (
        ("required function", "generate_launch_description"),
        say("Name it so, letter by letter: ros2 launch calls generate_launch_description()."),
    ),
    (
        ("it is one of ROS 1",),
        say("In ROS 2 <param> stands within its <node>, and a node has pkg=, exec= and no type=."),
    ),
    (("xacro",), say("Run xacro by hand on the same file: it says the same, with file and line.")),
    (("as yaml",), say("Wrap it: ParameterValue(Command([...]), value_type=str).")),
)
_BY_HAND: Final = say("`ros2 launch` says the same, with all lines of the traceback.")


def advice(error: str) -> str:
    """What to do about an error, by what it says."""
    return next((help for words, help in _ADVICE if all(word in error for word in words)), _BY_HAND)
