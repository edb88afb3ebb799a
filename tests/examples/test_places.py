"""examples/devcontainer, docker and pixi: what can be run of them without docker and conda."""

import json
import re
import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"


def test_what_they_run_is_shell():
    text = (EXAMPLES / "docker" / "Dockerfile").read_text(encoding="utf-8")
    lines = re.sub(r"(?m)^#.*\n", "", text).replace("\\\n", " ").splitlines()
    container = (EXAMPLES / "devcontainer" / "devcontainer.json").read_text(encoding="utf-8")
    start = json.loads(re.sub(r"(?m)^\s*//.*$", "", container))["postStartCommand"]
    commands = [start, *(line[4:] for line in lines if line.startswith("RUN "))]
    assert len(commands) > 1
    for command in commands:
        subprocess.run(["sh", "-n", "-c", command], check=True)


def test_pixi_requires_what_we_require():
    pixi = tomllib.loads((EXAMPLES / "pixi" / "pixi.toml").read_text(encoding="utf-8"))
    ours = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    required = {}
    # what builds is installed there, too, and asks for more of the same
    for text in (*ours["project"]["dependencies"], *ours["build-system"]["requires"]):
        match = re.match(r"([\w.-]+)([^;]*)", text)
        assert match
        required[match[1]] = match[2]
    given = {**pixi["dependencies"], **pixi["pypi-dependencies"]}
    assert {name: given.get(name) for name in required} == required
