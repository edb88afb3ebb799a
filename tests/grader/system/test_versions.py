"""Where the system refuses something, a run goes on without it; and its versions."""

import sys
from importlib import metadata
from types import SimpleNamespace

import pytest

from grader.run.processes import network
from grader.system import linux
from grader.system import versions as system


def test_submissions_are_run_where_linux_shows_its_processes(monkeypatch, tmp_path):
    assert system.runs_submissions()
    monkeypatch.setattr(system, "PROC", tmp_path)
    assert not system.runs_submissions()


@pytest.mark.parametrize("libc", [None, object()])
def test_namespaces_that_libc_does_not_know_are_refused(monkeypatch, libc):
    monkeypatch.setattr(linux, "_libc", libc)
    monkeypatch.setattr(network, "_refused", set())
    with pytest.raises(OSError, match=r"unshare \(net\)"):
        linux.unshare(linux.CLONE_NEWNET)
    with pytest.raises(OSError, match=r"unshare \(net\)"):
        network._as_root()


def test_versions_are_those_of_what_is_installed():
    assert system.grader_version() == metadata.version("turtlesim_py")
    assert sys.version.startswith(system.python_version())


def test_rclpy_s_is_in_its_package_xml_where_pip_knows_nothing_of_it(tmp_path, monkeypatch):
    def unknown(name):
        raise metadata.PackageNotFoundError(name)

    module = tmp_path / "lib" / "python3.12" / "site-packages" / "rclpy" / "__init__.py"
    manifest = tmp_path / "share" / "rclpy" / "package.xml"
    manifest.parent.mkdir(parents=True)
    manifest.write_text("<package><version>7.1.9</version></package>")
    monkeypatch.setattr(metadata, "version", unknown)
    find = lambda name: SimpleNamespace(origin=str(module))  # noqa: E731
    monkeypatch.setattr("importlib.util.find_spec", find)
    assert system.rclpy_version() == "7.1.9"
    assert system.grader_version() == "?"
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert system.rclpy_version() == "?"
