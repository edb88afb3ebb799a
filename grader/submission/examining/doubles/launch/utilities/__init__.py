"""A double of ROS's `launch.utilities`."""

from launch._core import normalize_to_list_of_substitutions, perform_substitutions, unknown

__all__ = ["normalize_to_list_of_substitutions", "perform_substitutions"]
__getattr__ = unknown("launch.utilities")
