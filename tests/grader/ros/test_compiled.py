"""Every class made of an installed definition is as the compiled one; and of 500 drawn ones."""

import base64
import random
from importlib import metadata
from pathlib import Path

import pytest
from ament_index_python import get_search_paths

from grader.ros import building
from grader.ros.definitions import Definitions, slot_of
from grader.ros.messages import installed
from grader.run import compiling
from tests.grader.ros.comparing import differences
from tests.grader.ros.drawing import package

KINDS = ("msg", "srv", "action")
pytestmark = [
    # other releases write classes a little differently
    pytest.mark.applies(metadata.version("rclpy").startswith("7."), reason="Jazzy's"),
]


def definitions(shares):
    """Package -> type's name -> text."""
    found = {}
    for share in shares:
        for kind in KINDS:
            for file in sorted(share.glob(f"*/{kind}/*.{kind}")):
                package_name = file.parts[-3]
                texts = found.setdefault(package_name, {})
                texts.setdefault(f"{package_name}/{kind}/{file.stem}", file.read_text("utf-8"))
    return found


def compare(texts):
    made = Definitions(texts)
    print("skipped:", {name: str(error) for name, error in made.errors.items()})
    assert not made.errors
    wrong, compared, rng = [], set(), random.Random(1)
    for name in texts:
        real, ours = installed(slot_of(name)), made.type(name)
        wrong += [f"{name} {each}" for each in differences(real, ours, rng, compared)]
    print(f"{len(texts)} interfaces, {len(compared)} classes; {len(wrong)} differences")
    assert not wrong, "\n".join([f"{len(wrong)} differences", *wrong[:20]])


INSTALLED = definitions(Path(prefix, "share") for prefix in get_search_paths())


def test_the_installed_definitions_are_found():
    assert len(INSTALLED) >= 20
    assert sum(map(len, INSTALLED.values())) >= 190


@pytest.mark.parametrize("name", INSTALLED)
def test_made_classes_are_as_those_that_are_installed(name):
    compare(INSTALLED[name])


@pytest.mark.more("minutes to compile")
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("number", range(5))
def test_made_classes_are_as_those_that_are_compiled(number, tmp_path, monkeypatch):
    name = f"drawn_{number}"
    texts = package(random.Random(number), name, count=100)
    built = building.build(texts, tmp_path / "place")
    library = base64.b64decode(built.pop(""))
    compiling._keep(built, library, {name}, tmp_path / "kept")
    monkeypatch.syspath_prepend(tmp_path / "kept")
    compare(texts)
