"""How much of the machine is ours."""

import pytest

from grader.run.processes import cores


@pytest.fixture
def groups(tmp_path, monkeypatch):
    """A machine of 8 cores whose control groups a test writes."""
    monkeypatch.setattr(cores, "available", lambda: list(range(8)))
    monkeypatch.setattr(cores, "_CGROUPS", tmp_path)
    monkeypatch.setattr(cores, "_MEMBERSHIP", tmp_path / "own")
    (tmp_path / "own").write_text("1:cpu:/\n0::/slice/ours\n")
    (tmp_path / "slice" / "ours").mkdir(parents=True)
    (tmp_path / "cpu").mkdir()
    return tmp_path


def test_without_quotas_it_is_every_core(groups):
    assert cores.share() == 8


@pytest.mark.parametrize(("group", "above", "share"), [("max", "max", 8), ("50000", "max", 0.5)])
def test_a_quota_of_ours_counts(groups, group, above, share):
    (groups / "slice" / "ours" / "cpu.max").write_text(f"{group} 100000\n")
    (groups / "slice" / "cpu.max").write_text(f"{above} 100000\n")
    assert cores.share() == share


def test_so_does_one_of_what_we_are_in(groups):
    (groups / "slice" / "ours" / "cpu.max").write_text("max 100000\n")
    (groups / "slice" / "cpu.max").write_text("150000 100000\n")
    assert cores.share() == 1.5


@pytest.mark.parametrize(("quota", "share"), [("-1", 8), ("200000", 2)])
def test_so_does_one_of_version_1(groups, quota, share):
    (groups / "cpu" / "cpu.cfs_quota_us").write_text(f"{quota}\n")
    (groups / "cpu" / "cpu.cfs_period_us").write_text("100000\n")
    assert cores.share() == share


def test_what_cannot_be_read_limits_nothing(groups):
    (groups / "own").unlink()
    (groups / "slice" / "cpu.max").write_text("nonsense")
    assert cores.share() == 8
