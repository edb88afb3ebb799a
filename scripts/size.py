"""Print the size of the project, and class names that occur twice.

    python scripts/size.py [FOLDER]

It counts the Python that git tracks, without tests and without students' programs. A room is a
top-level folder, and below grader/ each sub-folder; the core is grader/ without its exercises.
Nothing of the code is imported. Who imports whom is proved by import-linter.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

#: Folders of students' programs.
STUDENTS = {"starter", "reference", "right"}
#: Rooms of grader/ that are not the core.
AROUND_THE_CORE = {"grader/exercises"}
#: Folders whose classes have the names of ROS's.
DOUBLES = ("ros_doubles/", "tf2/")


def sources(root: Path) -> dict[PurePosixPath, str]:
    """Return the text of each file that counts."""
    command = ["git", "ls-files", "-z", "*.py"]
    done = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True)
    paths = [PurePosixPath(name) for name in done.stdout.split("\0") if name]
    return {
        path: (root / path).read_text(encoding="utf-8")
        for path in paths
        if path.parts[0] != "tests" and STUDENTS.isdisjoint(path.parts) and (root / path).exists()
    }


def room(path: PurePosixPath) -> str:
    """Return the room of a file; those that lie in grader/ itself, or at the top, share one."""
    if path.parts[0] == "grader" and len(path.parts) > 2:
        return "/".join(path.parts[:2])
    return path.parts[0] if len(path.parts) > 1 else "."


def double_names(trees: Mapping[PurePosixPath, ast.Module]) -> dict[str, list[PurePosixPath]]:
    """Return the names of top-level classes that occur in several files."""
    found = defaultdict(list)
    for path, tree in trees.items():
        for name in {node.name for node in tree.body if isinstance(node, ast.ClassDef)}:
            found[name].append(path)
    return {name: found[name] for name in sorted(found) if len(found[name]) > 1}


def main(root: Path) -> None:
    texts = sources(root)
    trees = {path: ast.parse(text) for path, text in texts.items()}
    lines, modules = Counter[str](), Counter[str]()
    for path, text in texts.items():
        core = path.parts[0] == "grader" and room(path) not in AROUND_THE_CORE
        for name in ("all", room(path), *["core"] * core):
            lines[name] += text.count("\n")
            modules[name] += 1
    print(f"{'':24}{'lines':>8}{'modules':>9}")
    for name in ("all", "core", *sorted(lines.keys() - {"all", "core"})):
        print(f"{name:24}{lines[name]:8,}{modules[name]:9,}")

    names = double_names(trees)
    ours = {
        name: paths
        for name, paths in names.items()
        if sum(not str(path).startswith(DOUBLES) for path in paths) > 1
    }
    print(f"\nclass names in several modules: {len(ours)}")
    for name, paths in ours.items():
        print(f"  {name}: {', '.join(map(str, paths))}")
    print(f"  doubles of ROS's API besides: {', '.join(sorted(names.keys() - ours.keys()))}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1])
