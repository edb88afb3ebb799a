"""For all tests: checked message fields and a ROS graph that nobody else is on."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import count
from typing import Any

import pytest

from grader.run.processes import domain
from tests.programs import Program

# Before anything of ROS is imported: the wheels take an int in a float field for other bits.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
# whatever the locale of who runs them
os.environ["LANGUAGE"] = "en"

_reserved = ExitStack()
_numbers = count(1)


def pytest_configure() -> None:
    """Take a ROS domain for this session, and a place for ROS's log files."""
    os.environ["ROS_DOMAIN_ID"] = str(_reserved.enter_context(domain.reserve_domain()))
    os.environ["ROS_LOG_DIR"] = _reserved.enter_context(tempfile.TemporaryDirectory())


def pytest_unconfigure() -> None:
    """Give them back."""
    _reserved.close()


@pytest.fixture(scope="session")
def ros() -> Iterator[None]:
    """ROS is up in this process; whoever needs a node in it asks for this."""
    import rclpy

    rclpy.init(args=[])
    yield
    rclpy.shutdown()


@pytest.fixture(scope="session")
def session_graph(ros: None) -> Iterator[Any]:
    """The node behind `graph`."""
    from tests.graph import Graph

    graph = Graph()
    yield graph
    graph.close()


@pytest.fixture
def graph(session_graph: Any) -> Iterator[Any]:
    """A node of the tests' own, a `tests.graph.Graph`; empty again for each test."""
    yield session_graph
    session_graph.forget()


@pytest.fixture(scope="session")
def simulator(session_graph: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    """One turtlesim_node for the whole session, a process of its own, as `/turtlesim`."""
    folder = tmp_path_factory.mktemp("simulator")
    with Program("turtlesim_py.ros.node", cwd=folder) as program:
        session_graph.meet("turtlesim")
        yield program
        assert program.stop() == 0
        assert "Traceback" not in program.text()


@pytest.fixture
def turtle(graph: Any, simulator: Program) -> Iterator[str]:
    """Its name: a turtle in the middle of `simulator` that only this test knows."""
    from turtlesim.srv import Kill, Spawn

    name = f"own{next(_numbers)}"
    assert graph.call(Spawn, "/spawn", x=5.5, y=5.5, theta=0.0, name=name).name == name
    yield name
    graph.call(Kill, "/kill", name=name)
