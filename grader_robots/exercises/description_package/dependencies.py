"""What a package takes from elsewhere: meshes by their names, and other packages."""

from __future__ import annotations

from typing import Final

from grader import Checks, Finding, Tolerances
from grader.submission import package_trace, shown
from grader.text import Message, joined, msg
from grader_robots.exercises.description_package import robots
from grader_robots.exercises.description_package.facts import (
    PackageFacts,
    nothing_started,
    of_package,
    unjudged,
)
from grader_robots.exercises.description_package.installing import AS_CREATED
from ros_doubles.known import DESKTOP

checks = Checks()
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


@checks()
@of_package
def meshes(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """Meshes are named by package://, and are there.

    Each file that the description names, textures too, has to be found from its name: by
    package://PACKAGE/PATH, or a file:// that $(find) has made. The share of those that are so is
    the share of the points. One that the package has and does not install is no fault here.
    A description without any gets all points, if a launch file starts anything; one that
    robot_state_publisher does not take is not judged.
    """
    readable = [each for each in robots.readable(facts) if each.is_xml]
    if not readable:
        return unjudged(
            msg("Not judged: there is no description whose meshes could be looked for."),
            msg("See what is said of the description itself first."),
        )
    meshes = {mesh.uri: mesh for each in readable for mesh in each.meshes}.values()
    if not meshes and facts.starts_nothing:
        return nothing_started()
    if not meshes:
        return Finding(1, msg("The description names no files."))
    wrong = [each for each in meshes if each.state in ("scheme", "missing", "case", "package")]
    if not wrong:
        return Finding(
            1,
            msg("All {count} files that the description names are to be found.", count=len(meshes)),
        )
    first = wrong[0]
    why = {
        "scheme": msg("no viewer resolves that: expected package://PACKAGE/PATH"),
        "missing": _instead(facts, first),
        "case": msg("there is {path}: letters count", path=first.path),
        "package": msg("there is no package {package!r}", package=shown(first.path)),
    }[first.state]
    if first.uri.startswith("file://"):
        why = msg("a path of one machine, which no other has")
    file = readable[0].source or readable[0].by
    text = msg("{file} names {uri}, and {why}.", file=file, uri=shown(first.uri), why=why)
    if len(wrong) > 1:
        text = joined([text, msg(" So {count} more.", count=len(wrong) - 1)])
    help = msg(
        "The way to a mesh begins with package:// and your package's name, and "
        "goes on as below its share folder: package://{name}/meshes/FILE.",
        name=facts.name,
    )
    return Finding(1 - len(wrong) / len(meshes), text, help)


def _instead(facts: PackageFacts, mesh: package_trace.NamedMesh) -> Message:
    """Of a mesh that is not there: and where a file of the same name is installed."""
    name = mesh.path.rsplit("/", 1)[-1]
    share = f"share/{facts.name}/"
    for path in facts.setup.installed:
        if path.startswith(share) and path.endswith(f"/{name}"):
            return msg(
                "there is no such file: {name} is installed as {uri}",
                name=name,
                uri=f"package://{facts.name}/{path.removeprefix(share)}",
            )
    return msg("there is no such file")


@checks()
@of_package
def dependencies(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """package.xml declares the packages that are used.

    Used are those whose nodes or files a launch file starts or includes, whose meshes the
    description names, and xacro. What every desktop installation of ROS 2 has
    (robot_state_publisher, rviz2, tf2_ros, ...) need not be declared. The share that is, is the
    share of the points.
    """
    if facts.starts_nothing:
        return nothing_started()
    declared = set(facts.setup.depends)
    covered = {other for name in declared for other in COVERED.get(name, ())}
    needed = used(facts) - DESKTOP
    missing = sorted(needed - declared - covered)
    if facts.setup.manifest:
        rationale = msg(
            "package.xml cannot be read for dependencies: {why}.", why=facts.setup.manifest
        )
        return Finding(0, rationale, AS_CREATED)
    if not missing:
        used_ = ", ".join(sorted(needed)) or msg("nothing but what every desktop installation has")
        return Finding(1, msg("What it uses is declared: {packages}.", packages=used_))
    rationale = msg(
        "package.xml does not declare {missing}, which the package uses: `rosdep install` does not "
        "bring it, and on another machine it is missing.",
        missing=", ".join(missing),
    )
    help = msg("Add <exec_depend>{package}</exec_depend>.", package=missing[0])
    return Finding(1 - len(missing) / len(needed), rationale, help)


def used(facts: PackageFacts) -> set[str]:
    """Other packages that launch files, descriptions and xacro need."""
    found = {name for launch in facts.launches for name in launch.packages}
    found |= {each.package for launch in facts.launches for each in launch.includes}
    for description in facts.descriptions:
        found |= {each.path for each in description.meshes if each.state == "foreign"}
        if description.is_launched and description.source.endswith((".xacro", ".xacro.xml")):
            found.add("xacro")
    own = {facts.name, *facts.trace.others}
    lacking = {e.name for launch in facts.launches for e in launch.lacking if e.kind == "package"}
    return {each for each in found - own - lacking if "/" not in each}
