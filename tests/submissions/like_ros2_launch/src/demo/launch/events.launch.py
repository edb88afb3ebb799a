"""The tutorial on event handlers, with programs of one's own."""

from launch import LaunchDescription
from launch.actions import (
    EmitEvent,
    ExecuteProcess,
    LogInfo,
    OpaqueFunction,
    RegisterEventHandler,
    TimerAction,
)
from launch.event_handlers import (
    OnExecutionComplete,
    OnProcessExit,
    OnProcessIO,
    OnProcessStart,
    OnShutdown,
)
from launch.events import Shutdown
from launch.substitutions import FindExecutable, LocalSubstitution
from launch_ros.actions import Node


def later(context):
    return [Node(package="demo", executable="talker", name="third")]


def generate_launch_description():
    simulator = Node(package="turtlesim", executable="turtlesim_node", name="sim")
    first = Node(package="demo", executable="talker", name="first")
    worker = Node(package="demo", executable="worker", arguments=["1"])
    second = Node(package="demo", executable="worker", arguments=["2"])
    spawn = ExecuteProcess(
        cmd=[
            [
                FindExecutable(name="true"),
                " service call /spawn turtlesim/srv/Spawn ",
                '"{x: 2, y: 2, theta: 0.2}"',
            ]
        ],
        shell=True,
    )
    return LaunchDescription(
        [
            RegisterEventHandler(
                OnProcessStart(
                    target_action=first,
                    on_start=[LogInfo(msg="started"), TimerAction(period=0.4, actions=[worker])],
                )
            ),
            simulator,
            TimerAction(period=0.6, actions=[first]),
            spawn,
            RegisterEventHandler(
                OnProcessExit(
                    target_action=worker,
                    on_exit=(
                        second,
                        TimerAction(period=0.5, actions=[OpaqueFunction(function=later)]),
                    ),
                )
            ),
            RegisterEventHandler(
                OnExecutionComplete(
                    target_action=second,
                    on_completion=[
                        TimerAction(
                            period=1.0,
                            actions=[Node(package="demo", executable="listener", name="last")],
                        )
                    ],
                )
            ),
            RegisterEventHandler(
                OnProcessIO(target_action=first, on_stdout=lambda event: LogInfo(msg="said"))
            ),
            RegisterEventHandler(
                OnProcessExit(
                    target_action=simulator,
                    on_exit=[EmitEvent(event=Shutdown(reason="Window closed"))],
                )
            ),
            RegisterEventHandler(
                OnShutdown(
                    on_shutdown=[LogInfo(msg=["asked: ", LocalSubstitution("event.reason")])]
                )
            ),
        ]
    )
