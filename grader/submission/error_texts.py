"""What to do about the usual errors that a launch file ends with."""

from __future__ import annotations

from typing import Final

from grader.text.message import Message, msg

_NAMES: Final = msg(
    "Compare the names of the arguments with those of your ROS release: "
    "node_executable and node_name are called executable and name since "
    "Foxy."
)
#: Words of the error that a launch file ends with, all of which it has -> what to do. The first
#: that fit count.
_ADVICE: Final = {
    ("file not found", "xacro/"): msg(
        "Command joins its parts as they stand: a blank is missing, Command(['xacro ', path])."
    ),
    ("keyword", "unexpected"): _NAMES,
    ("keyword", "'executable'"): _NAMES,
    ("launch configuration", "does not exist"): msg(
        "DeclareLaunchArgument(NAME, default_value=...) has to stand in the "
        "list before what uses it. Compare the names letter by letter."
    ),
    ("Failed to normalize", "float"): msg(
        "Arguments of a program are texts: write '0.1', not 0.1."
    ),
    ("values to unpack",): msg(
        "launch_arguments takes pairs: {{'NAME': value}}.items(), with .items() behind the dict."
    ),
    ("'parameters' given to Node", "dict"): msg(
        "parameters is a list: parameters=[{{...}}], with brackets round the dict."
    ),
    ("generate_launch_description", "NoneType"): msg(
        "The function's last line is: return LaunchDescription([...])."
    ),
    ("expected a list of actions",): msg(
        "The function of an OpaqueFunction returns a list: return [node], with brackets."
    ),
    ("Attribute", "'str'", "got", "'bool'"): msg("Put it in quotes, as all texts: 'true'."),
    ("Attribute", "'str'", "got", "'int'"): msg("Put it in quotes, as all texts: '5'."),
    ("required function", "generate_launch_description"): msg(
        "Name it so, letter by letter: ros2 launch calls generate_launch_description()."
    ),
    ("it is one of ROS 1",): msg(
        "In ROS 2 <param> stands within its <node>, and a node has pkg=, exec= and no type=."
    ),
    ("did not come to an end",): msg("Look for a loop without end, and for what it waits for."),
    ("it ended the process",): msg("Take out what ends it: os._exit, sys.exit, a signal."),
    ("xacro",): msg("Run xacro by hand on the same file: it says the same, with file and line."),
    ("as yaml",): msg("Wrap it: ParameterValue(Command([...]), value_type=str)."),
}
_BY_HAND: Final = msg("`ros2 launch` says the same, with all lines of the traceback.")


def advice(error: str) -> Message:
    """What to do about an error, by what it says."""
    fitting = (help for words, help in _ADVICE.items() if all(word in error for word in words))
    return next(fitting, _BY_HAND)
