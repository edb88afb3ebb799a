"""The versions that a result tells."""

from __future__ import annotations

import sys
from importlib import metadata
from types import SimpleNamespace

from grader import versions


def test_ours_is_that_of_the_installed_package():
    assert versions.grader() == metadata.version("turtlesim_py")


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
    assert versions.rclpy() == "7.1.9"
    assert versions.grader() == "?"
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert versions.rclpy() == "?"


def test_python_s_is_this_one_s():
    assert sys.version.startswith(versions.python())
