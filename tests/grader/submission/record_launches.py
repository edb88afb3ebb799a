"""Record what the real `launch` starts of the launch files of the hand-in `like_ros2_launch`.

    python -m tests.grader.submission.record_launches

It needs ROS's launch and launch_ros, and writes `launched.json` beside it. The packages are laid
out as `colcon build` would, with programs that do nothing: `worker` and scripts end at once, all
others wait. Programs of other packages are such, too. Of each start it writes the name that `ros2
launch` prints, the moment [s], and the arguments; a file by its name alone, a temporary file of
parameters by what it holds.
"""

import asyncio
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

from tests.hand_ins import SUBMISSIONS

FOLDER = SUBMISSIONS / "like_ros2_launch"
RECORDED = Path(__file__).with_name("launched.json")
MARKS = "share/ament_index/resource_index/packages"
PROGRAMS = {
    "demo": ("talker", "listener", "worker"),
    "bringup": ("watch.py",),
    "turtlesim": ("turtlesim_node",),
    "rqt_graph": ("rqt_graph",),
    "tf2_ros": ("static_transform_publisher",),
    "rclcpp_components": ("component_container",),
}
WAITS, ENDS = "#!/bin/sh\nexec sleep 60\n", "#!/bin/sh\n"
LASTS_S = 4.0


def lay_out(prefix):
    for package, programs in PROGRAMS.items():
        (prefix / MARKS).mkdir(parents=True, exist_ok=True)
        (prefix / MARKS / package).touch()
        source = FOLDER / "src" / package
        if source.is_dir():
            shutil.copytree(source, prefix / "share" / package)
        for name in programs:
            program = prefix / "lib" / package / name
            program.parent.mkdir(parents=True, exist_ok=True)
            program.write_text(ENDS if name in ("worker", "watch.py") else WAITS)
            program.chmod(0o755)
    (prefix / "bin").mkdir()
    (prefix / "bin" / "ros2").write_text(WAITS)
    (prefix / "bin" / "ros2").chmod(0o755)


def told(words):
    """The arguments of a program, as the test compares them."""
    found = []
    for word in words:
        if found[-1:] == ["--params-file"] and Path(word).name.startswith("launch_params_"):
            found.pop()
            (node,) = yaml.full_load(Path(word).read_text()).values()
            for name, value in flat(node["ros__parameters"]):
                found += ["-p", f"{name}:={json.dumps(value)}"]
        elif found[-1:] == ["-p"]:
            name, _, value = word.partition(":=")
            found.append(f"{name}:={json.dumps(yaml.full_load(value))}")
        else:
            found.append(Path(word).name if word.startswith("/") and Path(word).is_file() else word)
    return found[:-1] if found[-1:] == ["--ros-args"] else found


def flat(values, before=""):
    for name, value in values.items():
        if isinstance(value, dict):
            yield from flat(value, f"{before}{name}.")
        else:
            yield before + name, value


def record(file):
    """In a process of its own: what a launch file starts."""
    from launch import LaunchDescription, LaunchService, actions
    from launch.event_handler import EventHandler
    from launch.events.process import ProcessStarted
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    found = []
    loop = asyncio.new_event_loop()

    def note(context):
        event = context.locals.event
        at_s = loop.time() - began_s
        found.append([event.process_name, round(at_s, 3), told(list(event.cmd[1:]))])

    handler = EventHandler(
        matcher=lambda event: isinstance(event, ProcessStarted),
        entities=actions.OpaqueFunction(function=note),
    )
    service = LaunchService()
    entities = [
        actions.RegisterEventHandler(handler),
        actions.IncludeLaunchDescription(AnyLaunchDescriptionSource(file)),
        actions.TimerAction(period=LASTS_S, actions=[actions.Shutdown()]),
    ]
    service.include_launch_description(LaunchDescription(entities))
    asyncio.set_event_loop(loop)
    began_s = loop.time()
    if loop.run_until_complete(service.run_async()) and not found:
        sys.exit("it could not be launched")
    return found


def main():
    if len(sys.argv) > 1:
        print(json.dumps(record(sys.argv[1])))
        return
    recorded = {}
    with tempfile.TemporaryDirectory() as folder:
        prefix = Path(folder)
        lay_out(prefix)
        env = {
            **os.environ,
            "AMENT_PREFIX_PATH": f"{prefix}:{os.environ.get('AMENT_PREFIX_PATH', '')}",
            "PATH": f"{prefix}/bin:{os.environ['PATH']}",
            "ROS_LOG_DIR": str(prefix / "log"),
        }
        for file in sorted(prefix.glob("share/*/launch/*")):
            command = [sys.executable, "-m", "tests.grader.submission.record_launches", str(file)]
            done = subprocess.run(command, env=env, capture_output=True, text=True)
            if done.returncode:
                sys.exit(f"{file.name}: {done.stdout}{done.stderr}")
            recorded[f"src/{file.relative_to(prefix / 'share')}"] = json.loads(
                done.stdout.splitlines()[-1]
            )
    lines = [
        f"  {json.dumps(file)}: [\n    " + ",\n    ".join(map(json.dumps, starts)) + "\n  ]"
        for file, starts in recorded.items()
    ]
    RECORDED.write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    main()
