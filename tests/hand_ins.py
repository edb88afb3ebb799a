"""What tests grade: hand-ins, written as data and laid out as files once for all tests.

    python -m tests.hand_ins FOLDER

lays them out in a new folder, to look at or to grade by hand. `tests/submissions/README.md` says
how they are written.
"""

import re
import shutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import yaml

import turtlesim_challenge
from grader import exercise
from tests import once

DATA = Path(__file__).with_name("submissions")
STARTER = Path(exercise.__file__).with_name("starter")
#: Keys of a hand-in that is made of another one.
MADE = {"of", "files", "replace"}


@cache
def read(group: str) -> dict[str, Any]:
    """The data of a group, by its path below tests/submissions without `.yaml`."""
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast, where it is there
    data: dict[str, Any] = yaml.load((DATA / f"{group}.yaml").read_bytes(), loader)
    return data


def lay_out(folder: Path) -> None:
    """Write all hand-ins into a folder, as files and folders."""
    made = []
    for program in DATA.glob("*.py"):
        shutil.copy(program, folder)
    for path in sorted(DATA.rglob("*.yaml")):
        group = path.relative_to(DATA).with_suffix("").as_posix()
        nodes = dict(read(group))
        of = nodes.pop("of", "")
        made += [(place, {"of": of, **node}) for place, node in _write(folder / group, nodes)]
    for place, node in made:
        _make(folder, place, **node)


def find(folder: Path, name: str) -> Path:
    """Where a hand-in lies: `name` is its path, that of a program without `.py`."""
    path = folder / name
    return path if path.exists() else path.with_name(f"{path.name}.py")


def write(path: Path, node: Any) -> Path:
    """Write a hand-in that is made of no other one; where it lies."""
    assert not list(_write(path, node))
    return path


def _write(path: Path, node: Any) -> Iterator[tuple[Path, dict[str, Any]]]:
    """Write a file or a folder; yield what in it is made of others, with its path."""
    if isinstance(node, str | bytes):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(node if isinstance(node, bytes) else node.encode())
    elif "source" in node:
        encoded = node["source"].encode(node.get("encoding", "utf-8"))
        yield from _write(path.with_name(f"{path.name}.py"), encoded)
    elif MADE & node.keys():
        yield path, node
    elif "says" not in node:  # else it tells what is said of another one
        for name, child in _with_package(node).items():
            yield from _write(path / name, child)


def _make(
    root: Path,
    path: Path,
    of: str,
    files: Mapping[str, Any] | None = None,
    replace: Iterable[list[str]] = (),
    **_: object,
) -> None:
    """Make a hand-in of another one."""
    original = find(root, of)
    path.parent.mkdir(parents=True, exist_ok=True)
    if original.is_dir():
        shutil.copytree(original, path)
    else:
        path = path if path.suffix else path.with_suffix(original.suffix)
        shutil.copy(original, path)
    for name, node in (files or {}).items():
        if node is not None:
            for place, made in _write(path / name, node):
                _make(root, place, **made)
        elif (path / name).is_dir():
            shutil.rmtree(path / name)
        else:
            (path / name).unlink()
    for *file, old, new in replace:
        changed = path.joinpath(*file)
        text = changed.read_bytes().decode()
        assert text.count(old) == 1, f"{changed}: {old!r} stands there {text.count(old)} times"
        changed.write_bytes(text.replace(old, new).encode())


def _with_package(node: dict[str, Any]) -> dict[str, Any]:
    """A folder with the starter's files, where its package.xml, and its setup.py, are data."""
    manifest, setup = node.get("package.xml"), node.get("setup.py")
    if not isinstance(manifest, dict):
        return node
    files = _starter(manifest["name"])
    elements = [
        f"  <{tag}>{each}</{tag}>\n"
        for tag, values in manifest.items()
        for each in values
        if tag != "name"
    ]
    xml = files["package.xml"].replace("  <exec_depend>rclpy</exec_depend>\n", "".join(elements))
    if setup is None:
        return {**node, "package.xml": xml.replace("ament_python", "ament_cmake")}
    if isinstance(setup, dict):
        setup = _setup(files["setup.py"], **setup)
    return {**files, **node, "package.xml": xml, "setup.py": setup}


@cache
def _starter(name: str) -> dict[str, str]:
    """The starter's files, by their paths, as a package of this name."""
    paths = [path for path in STARTER.rglob("*") if path.is_file() and path.suffix != ".pyc"]
    return {
        str(path.relative_to(STARTER)).replace("my_solution", name): path.read_text(
            encoding="utf-8"
        ).replace("my_solution", name)
        for path in paths
    }


def _setup(text: str, console_scripts: Iterable[str] = (), data_files: Iterable[str] = ()) -> str:
    """A setup.py with these programs, and with what these patterns find."""
    scripts = [f'            "{script}",\n' for script in console_scripts]
    text = re.sub(r' +"my_node = .*\n', "".join(scripts), text)
    patterns = [
        f'        ("share/" + package_name + "/{Path(pattern).parent}", glob("{pattern}")),\n'
        for pattern in data_files
    ]
    if not patterns:
        return text
    manifest = '["package.xml"]),\n'
    return "from glob import glob\n\n" + text.replace(manifest, manifest + "".join(patterns))


#: Where they lie, each by its path: read them, or copy them.
SUBMISSIONS = once.folder(
    lay_out,
    "hand-ins",
    made_by=("grader/exercise/starter", "tests/hand_ins.py", "tests/submissions"),
)
REFERENCE = Path(turtlesim_challenge.__file__).with_name("turtle_controller.py")

if __name__ == "__main__":
    folder = Path(sys.argv[-1])
    if len(sys.argv) != 2 or folder.exists() or folder.name.startswith("-"):
        sys.exit("python -m tests.hand_ins FOLDER: lays out all hand-ins in a new folder")
    folder.mkdir(parents=True)
    lay_out(folder)
