"""Doubles of ROS's launch, for evaluating launch files where nothing is to be started.

`launch`, `launch_ros` and `ament_index_python` have the names, arguments and refusals of ROS's
packages; whoever evaluates a launch file puts this folder first on `sys.path`. `frontend` reads
XML and YAML, `known` what launch files use of other packages. What would be started is taken down
in `LaunchContext.record`, which the caller gives.
"""

from __future__ import annotations


class NotKnown(Exception):
    """A launch file uses what ROS may have, and these doubles have not: no fault of the file.

    Attributes:
        is_of_others: whether it belongs to a package that nobody has here.
    """

    def __init__(self, name: str, *, is_of_others: bool = False) -> None:
        super().__init__(name)
        self.is_of_others = is_of_others
