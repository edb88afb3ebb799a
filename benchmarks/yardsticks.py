"""What rclpy itself costs on this machine: two yardsticks, in which gradings can be counted.

    start   a bare rclpy process: import, init, a node, shutdown
    floor   a process that takes and handles as many poses, from itself and by rclpy's own
            executor, as a run of the reference controller has ticks

Both are whole processes, from their start to their end. `python benchmarks/yardsticks.py start` (or
`floor`) is one of them.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median

import measuring
from measuring import Sample

#: Ticks of the reference controller's nominal run.
POSES = 3449


@dataclass(frozen=True)
class Yardsticks:
    """Both yardsticks; each a median."""

    start: Sample
    floor: Sample

    def multiples(self, wall_s: float, cpu_s: float | None) -> tuple[str, str]:
        """How many starts, and how many floors, something takes: wall and CPU."""
        return _ratio(wall_s, cpu_s, self.start), _ratio(wall_s, cpu_s, self.floor)


def measure(
    env: Mapping[str, str], repetitions: int, cpus: float | None = None
) -> tuple[Yardsticks, list[Sample], list[Sample]]:
    """Measure both, in turns."""
    starts, floors = [], []
    for _ in range(repetitions):
        starts.append(measuring.command([sys.executable, __file__, "start"], env, cpus))
        floors.append(measuring.command([sys.executable, __file__, "floor"], env, cpus))
    return Yardsticks(middle(starts), middle(floors)), starts, floors


def middle(samples: list[Sample]) -> Sample:
    """The medians of some samples."""
    cpu = [sample.cpu_s for sample in samples if sample.cpu_s is not None]
    peak = [sample.peak_mib for sample in samples if sample.peak_mib is not None]
    wall_s = median(sample.wall_s for sample in samples)
    return Sample(wall_s, median(cpu) if cpu else None, median(peak) if peak else None)


def _ratio(wall_s: float, cpu_s: float | None, unit: Sample) -> str:
    cpu = "-" if cpu_s is None or not unit.cpu_s else f"{cpu_s / unit.cpu_s:.1f}"
    return f"{wall_s / unit.wall_s:.1f} / {cpu}"


# The processes --------------------------------------------------------------------------------


def start() -> None:
    """Import, init, a node, shutdown."""
    import rclpy

    rclpy.init()
    node = rclpy.create_node("bare")
    node.destroy_node()
    rclpy.shutdown()


def floor() -> None:
    """Publish pose after pose, and handle each."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from turtlesim.msg import Pose

    rclpy.init()
    node = rclpy.create_node("floor")
    places: list[float] = []
    node.create_subscription(Pose, "turtle1/pose", lambda pose: places.append(pose.x), 10)
    publisher = node.create_publisher(Pose, "turtle1/pose", 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    for number in range(POSES):
        publisher.publish(Pose(x=float(number), y=5.5, theta=0.5, linear_velocity=2.0))
        while len(places) <= number:
            executor.spin_once()
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    {"start": start, "floor": floor}[sys.argv[1]]()
