"""Doubles of ROS's launch, for evaluating launch files where nothing is to be started.

`launch`, `launch_ros` and `ament_index_python` have the names, arguments and refusals of ROS's
packages. Whoever evaluates a launch file puts their folder, `packages`, first on `sys.path`;
anything else that lay there would hide a module of the same name in a hand-in. `frontend` reads
launch files, `launch_time` says what happens when, `known` has what they use of other packages.
What would be started is taken down in `LaunchContext.record`, which the caller gives.
"""

from __future__ import annotations


class NotKnown(Exception):
    """A launch file uses what ROS may have, and these doubles have not: no fault of the file.

    Its argument names that, or is what the caller says of it.
    """


class OfAnother(NotKnown):
    """It belongs to another package, of which nobody has anything here."""
