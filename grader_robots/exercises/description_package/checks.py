"""The checks: the installation, the launch files, the description, its meshes, the rest."""

from __future__ import annotations

from grader import Checks
from grader_robots.exercises.description_package import (
    dependencies,
    installing,
    launching,
    robots,
    spawning,
)

checks = Checks(*(part.checks for part in (installing, launching, robots, dependencies, spawning)))
