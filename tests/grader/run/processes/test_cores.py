"""How much of the machine is ours."""

import pytest

from grader.run.processes import cores
from tests.files import lay


@pytest.fixture
def groups(tmp_path, monkeypatch):
    """A machine of 8 cores whose control groups a test writes."""
    monkeypatch.setattr(cores, "available", lambda: list(range(8)))
    monkeypatch.setattr(cores, "_CGROUPS", tmp_path)
    monkeypatch.setattr(cores, "_MEMBERSHIP", tmp_path / "own")
    (tmp_path / "own").write_text("1:cpu:/\n0::/slice/ours\n")
    (tmp_path / "slice" / "ours").mkdir(parents=True)
    return tmp_path


@pytest.mark.parametrize(
    ("files", "share"),
    [
        ({}, 8),
        ({"slice/ours/cpu.max": "max 100000", "slice/cpu.max": "max 100000"}, 8),
        ({"slice/ours/cpu.max": "50000 100000", "slice/cpu.max": "max 100000"}, 0.5),
        ({"slice/ours/cpu.max": "max 100000", "slice/cpu.max": "150000 100000"}, 1.5),
    ],
)
def test_quotas_of_ours_and_of_what_we_are_in_count(groups, files, share):
    lay(groups, {name: f"{text}\n" for name, text in files.items()})
    assert cores.share() == share


def test_what_cannot_be_read_limits_nothing(groups):
    (groups / "own").unlink()
    (groups / "slice" / "cpu.max").write_text("nonsense")
    assert cores.share() == 8
