"""For all tests: checked message fields, and a simulator on a graph that nobody else is on."""

import gc
import os
import subprocess
import zlib
from itertools import count
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.programs import Program

# Before anything of ROS is imported: the wheels take an int in a float field for other bits.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
# A program that is killed leaves its shared memory behind, and tests kill some.
os.environ["FASTDDS_BUILTIN_TRANSPORTS"] = "UDPv4"
# whatever the locale and the terminal of who runs them
os.environ["LANGUAGE"] = "en"
os.environ.pop("COLUMNS", None)

pytest_plugins = ["tests.apart", "tests.needs"]

#: So many examples has each search, in `make test-all`; without it, few, and the same every time.
EXAMPLES = int(os.environ.get("EXAMPLES") or 0)
#: "3/8": of all tests the part 3 of the parts 0 to 7; '' for all.
PART = os.environ.get("PART", "")
#: So many hand-ins and recordings, as nobody makes them, are drawn by each search for a failure of
#: the grader.
CASES = max(15, 2 * EXAMPLES)
#: A search with EXAMPLES may take so long [s].
SEARCH_S = 3600
settings.register_profile(
    "ours",
    max_examples=EXAMPLES or 30,
    derandomize=not EXAMPLES,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
settings.load_profile("ours")

_numbers = count(1)

_leave = subprocess.Popen.__exit__


def _kill_or_leave(process: subprocess.Popen[Any], kind: Any, *error: Any) -> None:
    """Leave a `with Popen(...)`; where its block has failed, do not wait for the process."""
    if kind is not None:
        process.kill()
    _leave(process, kind, *error)


subprocess.Popen.__exit__ = _kill_or_leave


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what does not apply to this system, and other parts than PART.

    With EXAMPLES, `more` searches where `make test` did, and takes its time.
    """
    for item in items:
        if EXAMPLES and getattr(getattr(item, "obj", None), "is_hypothesis_test", False):
            item.add_marker(pytest.mark.more("so many examples"))
            if item.get_closest_marker("timeout") is None:
                item.add_marker(pytest.mark.timeout(SEARCH_S))
    kept = {id(item) for item in items if _applies(item) and _is_in_part(item)}
    config.hook.pytest_deselected(items=[item for item in items if id(item) not in kept])
    items[:] = [item for item in items if id(item) in kept]


def _applies(item: pytest.Item) -> bool:
    return all(mark.args[0] for mark in item.iter_markers("applies"))


def _is_in_part(item: pytest.Item) -> bool:
    number, _, count = PART.partition("/")
    return not count or zlib.crc32(item.nodeid.encode()) % int(count) == int(number)


def pytest_collection_finish() -> None:
    """Spare every collection of garbage what there is by now, and stays; collect less often."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 100)


def pytest_xdist_auto_num_workers() -> int:
    """How many `make test` starts: a fifth of the time tests wait, for ROS or a page."""
    cores = len(os.sched_getaffinity(0))
    return cores + cores // 2


@pytest.fixture(scope="module")
def browser():
    """A real one, for tests that are marked with `needs_browser`."""
    from tests.browser import open_browser

    with open_browser() as opened:
        yield opened


@pytest.fixture(scope="session")
def ros():
    """ROS is up in this process; whoever needs a node in it asks for this."""
    import rclpy

    rclpy.init(args=[])
    yield
    rclpy.shutdown()


@pytest.fixture(scope="session")
def session_graph(ros):
    """The node behind `graph`."""
    from tests.graph import Graph

    graph = Graph()
    yield graph
    graph.close()


@pytest.fixture
def graph(session_graph):
    """A node of the tests' own, a `tests.graph.Graph`; empty again for each test."""
    yield session_graph
    session_graph.forget()


@pytest.fixture(scope="session")
def simulator(session_graph, tmp_path_factory):
    """One turtlesim_node for the whole session, a process of its own, as `/turtlesim`."""
    folder = tmp_path_factory.mktemp("simulator")
    with Program("turtlesim_py.ros.node", cwd=folder) as program:
        session_graph.meet("turtlesim")
        yield program
        assert program.stop() == 0
        assert "Traceback" not in program.text()


@pytest.fixture
def turtle(graph, simulator):
    """Its name: a turtle in the middle of `simulator` that only this test knows."""
    from turtlesim.srv import Kill, Spawn

    name = f"own{next(_numbers)}"
    assert graph.call(Spawn, "/spawn", x=5.5, y=5.5, theta=0.0, name=name).name == name
    yield name
    graph.call(Kill, "/kill", name=name)
