"""Builds what ../build.py describes, of the ROS 2 release that pyproject.toml names."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from interfaces.build import setup

setup()
