"""Packages that are used and have to be declared."""

from __future__ import annotations

from typing import Final

from grader.exercise.verdict import Finding
from grader.exercises.description_package.looked import Looked, nothing_started
from grader.language.phrase import say
from grader.scenes.package.examining.known import DESKTOP
from grader.scenes.package.said import phrase_of

#: What comes along with another package.
COVERED: Final = {
    "ros_gz": ("ros_gz_sim", "ros_gz_bridge", "ros_gz_image"),
    "gazebo_ros_pkgs": ("gazebo_ros", "gazebo_plugins", "gazebo_msgs"),
    "joint_state_publisher_gui": ("joint_state_publisher",),
    "urdf_launch": ("joint_state_publisher", "joint_state_publisher_gui", "xacro"),
    "urdf_tutorial": ("joint_state_publisher", "joint_state_publisher_gui", "xacro", "urdf_launch"),
    "ros2_controllers": (
        *("joint_state_broadcaster", "diff_drive_controller", "joint_trajectory_controller"),
        "forward_command_controller",
    ),
    "ros2_control": ("controller_manager",),
}


def judge(looked: Looked) -> Finding:
    """Whether who installs the package by rosdep gets what it needs."""
    if looked.starts_nothing:
        return nothing_started()
    declared = set(looked.setup.depends)
    covered = {other for name in declared for other in COVERED.get(name, ())}
    needed = used(looked) - DESKTOP
    missing = sorted(needed - declared - covered)
    if looked.setup.manifest:
        return Finding(
            0,
            say(
                "package.xml cannot be read for dependencies: {why}.",
                why=phrase_of(looked.setup.manifest),
            ),
            say("Compare it with one that `ros2 pkg create` writes."),
        )
    if not missing:
        used_ = ", ".join(sorted(needed)) or say("nothing but what every desktop installation has")
        return Finding(1, say("What it uses is declared: {packages}.", packages=used_))
    return Finding(
        1 - len(missing) / len(needed),
        say(
            "package.xml does not declare {missing}, which the package uses: "
            "`rosdep install` does not bring it, and on another machine it is "
            "missing.",
            missing=", ".join(missing),
        ),
        say("Add <exec_depend>{package}</exec_depend>.", package=missing[0]),
    )


def used(looked: Looked) -> set[str]:
    """Other packages that launch files, descriptions and xacro need."""
    found = {name for launch in looked.launches for name in launch.packages}
    found |= {each.package for launch in looked.launches for each in launch.includes}
    for description in looked.descriptions:
        found |= {each.path for each in description.meshes if each.state == "foreign"}
        if description.is_launched and description.source.endswith((".xacro", ".xacro.xml")):
            found.add("xacro")
    own = {looked.name, *looked.trace.others}
    lacking = {e.name for launch in looked.launches for e in launch.lacking if e.kind == "package"}
    return {each for each in found - own - lacking if "/" not in each}
