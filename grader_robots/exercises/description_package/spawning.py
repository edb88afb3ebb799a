"""How a model gets into Gazebo: the arguments of the program that puts it there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from grader import Checks, Finding, Tolerances
from grader.exercise import unless_unknown
from grader.submission import package_trace, shown
from grader.text import Message, msg
from grader_robots.exercises.description_package.facts import (
    NO_FAULT,
    PackageFacts,
    no_robot,
    nothing_started,
    of_package,
)
from grader_robots.exercises.description_package.launching import (
    DESCRIPTION,
    is_publisher,
    starts_nothing,
)
from grader_robots.exercises.description_package.robots import readable

checks = Checks()
#: Program -> where the model may come from (one of these), and what must be named.
PROGRAMS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "spawn_entity.py": (("-file", "-topic", "-database", "-stdin"), ("-entity",)),
    "create": (("-file", "-param", "-string", "-topic"), ()),
}
_PLACES = ("-x", "-y", "-z", "-R", "-P", "-Y", "-timeout", "-spawn_service_timeout")
_TAKES_NOTHING = ("-stdin", "-unpause", "-b", "-package_to_model", "-allow_renaming")


def spawners(launch: package_trace.LaunchFile) -> list[package_trace.LaunchedNode]:
    """The nodes that put a model into a world."""
    packages = ("gazebo_ros", "ros_gz_sim", "ros_ign_gazebo")
    return [
        each for each in launch.nodes if each.package in packages and each.executable in PROGRAMS
    ]


@checks()
@of_package
def spawn(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """What puts the robot into Gazebo has the right arguments.

    spawn_entity.py of gazebo_ros, or create of ros_gz_sim: exactly one origin (-topic, -file, ...),
    a name where one is needed, numbers as places, and a topic that a launch file publishes.
    All or nothing, and nothing where `ros2 launch` ends with an error or robot_state_publisher
    takes no description; a package that puts nothing into Gazebo gets the points.
    """
    return judge_spawning(facts, is_asked=False)


def judge_spawning(facts: PackageFacts, is_asked: bool) -> Finding:
    if facts.starts_nothing:
        return nothing_started()
    if facts.descriptions and not readable(facts):
        return no_robot(msg("Not judged: there is no robot that could be put into Gazebo."))
    found = [(launch, node) for launch in facts.launches for node in spawners(launch)]
    included = [launch for launch in facts.launches if includes_spawner(launch)]
    if not found and not included:
        if is_asked:
            rationale = msg("No launch file puts the robot into Gazebo.")
            help = msg("Start create of ros_gz_sim with -topic robot_description and -name.")
            return unless_unknown(facts.trace, Finding(0, rationale, help), kinds=NO_FAULT)
        if stopped := _stopped(facts, [each for each in facts.launches if each.problem]):
            return stopped  # it may be the one that was to
        return Finding(1, msg("No launch file puts the robot into Gazebo, and none need."))
    if stopped := _stopped(facts, [*(each for each, _ in found), *included]):
        return stopped
    for launch, node in found:
        fault = next(_faults(facts, launch, node), "")
        if fault:
            rationale = msg(
                "{file}: {program} {fault}", file=launch.file, program=node.executable, fault=fault
            )
            help = msg("Compare the arguments with `ros2 run PACKAGE PROGRAM --help`.")
            return Finding(0, rationale, help)
    launches = [launch for launch, _ in found] or included
    return Finding(1, msg("{file} puts the robot into Gazebo.", file=launches[0].file))


def _stopped(facts: PackageFacts, launches: Sequence[package_trace.LaunchFile]) -> Finding | None:
    """The first of some launch files with which `ros2 launch` ends with an error."""
    found = (starts_nothing(facts, each) for each in launches)
    return next((each for each in found if each is not None), None)


def includes_spawner(launch: package_trace.LaunchFile) -> bool:
    """Whether a launch file leaves that to one of ros_gz_sim."""
    return any(each.file.endswith("gz_spawn_model.launch.py") for each in launch.includes)


def _faults(
    facts: PackageFacts, launch: package_trace.LaunchFile, node: package_trace.LaunchedNode
) -> Iterator[Message]:
    sources, needed = PROGRAMS[node.executable]
    received = _given(node)
    if None in received:
        yield msg("gets {word!r}, which is no argument of it.", word=shown(received[None]))
    origins = [each for each in sources if each in received]
    if len(origins) != 1:
        all_, found = ", ".join(sources), ", ".join(origins)
        yield (
            msg("needs exactly one of {options}; it gets {given}.", options=all_, given=found)
            if found
            else msg("needs exactly one of {options}; it gets none.", options=all_)
        )
    for name in needed:
        if not received.get(name):
            yield msg("needs {name} with a name.", name=name)
    for name in _PLACES:
        if name in received and not _is_number(received[name]):
            yield msg(
                "gets {name} {value!r}; expected a number.", name=name, value=shown(received[name])
            )
    if "-topic" in received:
        topic = received["-topic"].rsplit("/", 1)[-1]
        remapped = (each for node in launch.nodes for each in node.remappings)
        if topic == DESCRIPTION and not any(map(_is_published, facts.launches)):
            yield msg("waits for the topic robot_description, and no launch file publishes it.")
        elif topic != DESCRIPTION and not any(each.endswith(topic) for each in remapped):
            yield msg(
                "waits for the topic {topic!r}, which nobody publishes; "
                "robot_state_publisher publishes robot_description.",
                topic=shown(received["-topic"]),
            )


def _given(node: package_trace.LaunchedNode) -> dict[str | None, str]:
    """Option -> value; None: what is no option."""
    words = [word for each in node.arguments for word in each.split()]
    if "--ros-args" in words:
        words = words[: words.index("--ros-args")]
    found: dict[str | None, str] = {}
    while words:
        name = words.pop(0)
        name = name[1:] if name.startswith("--") else name
        name, is_joined, value = name.partition("=")
        if is_joined and name.startswith("-"):
            found[name] = value
        elif not name.startswith("-") or _is_number(name):
            if node.executable != "create":  # which ignores such words
                found.setdefault(None, name)
        elif name in _TAKES_NOTHING:
            found[name] = ""
        else:
            found[name] = words.pop(0) if words else ""
    for each in node.parameters:
        if node.executable == "create":
            found.setdefault(f"-{each.name}", each.value or "(a text)")
    return found


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _is_published(launch: package_trace.LaunchFile) -> bool:
    return any(
        is_publisher(node) and any(p.name == DESCRIPTION for p in node.parameters)
        for node in launch.nodes
    ) or any(each.package == "urdf_launch" for each in launch.includes)
