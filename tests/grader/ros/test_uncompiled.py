import importlib
import sys
from importlib.util import find_spec

import pytest

from grader.ros import uncompiled
from grader.ros.definitions import Definitions, UncompiledPackages
from grader.ros.messages import deserialise, serialise

DEFINITIONS = {
    "mine_first/msg/Num": "int64 num 3\ngeometry_msgs/Point at\n",
    "mine_first/srv/Add": "Num[] nums\n---\nmine_second/Sum sum\n",
    "mine_second/msg/Sum": "int64 sum\n",
}


@pytest.fixture(autouse=True)
def environment(monkeypatch, tmp_path):
    """An environment in which these are installed as definitions, and nothing else is."""
    for name, text in DEFINITIONS.items():
        package, kind, own = name.split("/")
        file = tmp_path / "share" / package / kind / f"{own}.{kind}"
        marker = tmp_path / uncompiled._INDEX / package
        for path, content in ((file, text), (marker, "")):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    monkeypatch.setattr(sys, "meta_path", [UncompiledPackages(), *sys.meta_path])
    uncompiled._indexed.cache_clear()
    before = set(sys.modules)
    yield tmp_path
    uncompiled._indexed.cache_clear()
    for name in set(sys.modules) - before:
        if name.startswith("mine_"):
            del sys.modules[name]


@pytest.fixture
def folder(monkeypatch, tmp_path):
    """Makes a folder where Python looks for packages."""
    monkeypatch.syspath_prepend(str(tmp_path / "path"))

    def folder(name):
        made = tmp_path / "path" / name
        made.mkdir(parents=True)
        importlib.invalidate_caches()
        return made

    return folder


def test_their_classes_are_imported_with_those_of_other_packages():
    from geometry_msgs.msg import Point
    from mine_first.msg import Num
    from mine_first.srv import Add

    assert uncompiled.packages() == ["mine_first", "mine_second"]
    response = Add.Response()
    response.sum.sum = 7
    assert type(response.sum).__module__ == "mine_second.msg._sum"
    assert deserialise(serialise(response), Add.Response) == response
    assert type(Num().at) is Point


def test_only_what_is_imported_is_parsed(monkeypatch):
    parsed = []

    def texts(package):
        parsed.append(package)
        return DEFINITIONS

    monkeypatch.setattr(uncompiled, "texts", texts)
    assert find_spec("mine_second").origin
    assert find_spec("mine_third") is None
    assert parsed == ["mine_second"]


def test_others_use_their_types():
    made = Definitions({"mine/msg/Both": "mine_first/Num num\nmine_second/Sum sum\n"})
    assert not made.errors
    assert made.type("mine/msg/Both")().num.num == 3
    (error,) = Definitions({"mine/msg/No": "mine_first/Never a\n"}).errors.values()
    assert "`mine_first/Never` is not known" in str(error)


def test_a_package_of_python_s_by_such_a_name_is_what_is_imported(folder):
    (folder("mine_first") / "__init__.py").touch()
    assert uncompiled.packages() == ["mine_second"]
    assert importlib.import_module("mine_first").__file__
    with pytest.raises(ModuleNotFoundError, match=r"mine_first\.msg"):
        importlib.import_module("mine_first.msg")


def test_a_mere_folder_of_such_a_name_hides_nothing(folder):
    folder("mine_first/msg")
    assert importlib.import_module("mine_first.msg").Num().num == 3


def test_where_ros_is_sourced_there_are_none(monkeypatch):
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    assert uncompiled.packages() == []
    assert uncompiled.texts("mine_first") == {}
    assert find_spec("mine_first") is None


def test_the_index_is_where_an_installation_writes_it():
    from interfaces.build import INTERFACES

    assert uncompiled._INDEX.as_posix() == INTERFACES
