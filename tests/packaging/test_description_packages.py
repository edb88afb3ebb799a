"""What a recording setup() says is installed is what `colcon build` installs."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.grader_robots.packages import FOLDER, REFERENCE, looked_at

from .conftest import colcon_build

#: What colcon adds by itself.
OF_COLCON = ("hook", "package.bash", "package.ps1", "package.sh", "package.zsh", "package.dsv")
PACKAGES = {
    "reference": REFERENCE,
    "r2d2_tutorial": FOLDER / "r2d2_tutorial",
    "urdf_to_package": FOLDER / "urdf_to_package",
}


def built(package: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    shutil.copytree(package, folder / "src")
    return colcon_build(folder, "--merge-install", "--base-paths", "src")


@pytest.mark.more("builds with colcon; what setup() says is installed is known of each package")
@pytest.mark.parametrize("name", PACKAGES)
def test_the_same_files_are_installed_as_by_colcon(name, tmp_path):
    setup = looked_at(PACKAGES[name]).setup
    build = built(PACKAGES[name], tmp_path)
    assert build.returncode == 0, build.stdout + build.stderr
    share = tmp_path / "install" / "share" / setup.name
    found = {
        path.relative_to(tmp_path / "install").as_posix()
        for path in share.rglob("*")
        if path.is_file() and path.relative_to(share).parts[0] not in OF_COLCON
    }
    marker = f"share/ament_index/resource_index/packages/{setup.name}"
    assert found | {marker} == set(setup.installed)
    assert (tmp_path / "install" / marker).is_file()
    programs = tmp_path / "install" / setup.scripts_folder
    assert {each.name for each in setup.scripts} == {path.name for path in programs.glob("*")}


@pytest.fixture
def without_its_marker(tmp_path):
    shutil.copytree(REFERENCE, tmp_path / "package")
    (tmp_path / "package/resource/walker_description").unlink()
    return tmp_path / "package"


def test_a_file_that_is_not_there_is_told(without_its_marker):
    assert looked_at(without_its_marker).setup.absent == ("resource/walker_description",)


@pytest.mark.more("builds with colcon; what is not there is told without it")
def test_it_stops_colcon(without_its_marker, tmp_path):
    build = built(without_its_marker, tmp_path / "workspace")
    assert build.returncode != 0
    assert "resource/walker_description" in build.stdout + build.stderr
