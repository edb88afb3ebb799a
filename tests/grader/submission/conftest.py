"""One process inspects the packages of all tests of this room, and nothing confines it.

One for each package, confined as in a run, would take a third of a second and find the same: see
tests/grader_robots/inspection/test_inspecting.py. Modules that need it have an `inspection` of
their own.
"""

import pytest

from grader.run import inspecting
from grader.submission import inspector
from tests.grader_robots.packages import inspected


@pytest.fixture(autouse=True)
def inspection(monkeypatch):
    def inspect(submission, folders, program, _, inspections, given):
        places = None if inspections is None else inspector.places(inspections)
        order = {"set_ups": [*folders], "program": program, "inspectors": places}
        return inspected(submission.root, **order, given=dict(given)), ()

    monkeypatch.setattr(inspecting, "inspect", inspect)
