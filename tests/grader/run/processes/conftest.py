"""A server whose processes are forked, and what it is started with."""

import os
import sys
from pathlib import Path

import pytest
import yaml

from grader.run.processes.fork_server import ForkServer

TEXTS = yaml.safe_load(Path(__file__).with_name("test_fork_server.yaml").read_text())
ROOT = Path(__file__).parents[4]
COMMAND = [sys.executable, "-c", TEXTS["serves"].format(root=str(ROOT))]
#: The seed is that of a set that becomes a library path, where ROS's wheels start.
ENV = {"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8", "PYTHONHASHSEED": "0"}
#: Stands before a command that is not to make namespaces; only root has something to give up.
UNPRIVILEGED = ("setpriv", "--bounding-set", "-sys_admin") if os.geteuid() == 0 else ()


@pytest.fixture(scope="module")
def server():
    made = ForkServer(COMMAND, ENV)
    yield made
    made.close()


@pytest.fixture(params=["started", "forked"])
def warm(request, server):
    return server if request.param == "forked" else None
