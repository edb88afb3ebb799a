"""The checks: package and launch file, then what the node sends."""

from __future__ import annotations

from grader import Checks
from grader_robots.exercises.state_publisher import joints, packaging, timing, transforms

checks = Checks(*(part.checks for part in (packaging, timing, joints, transforms)))
