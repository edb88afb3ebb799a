"""Print the size of the project, class names that occur twice, and imports that form cycles.

    python scripts/size.py [FOLDER]

It counts the Python that git tracks, without tests and without students' programs. A room is a
top-level folder, and below grader/ each sub-folder; the core is grader/ without exercises and
batch. An arrow runs from a room to one that it imports; where two rooms import each other, it runs
back up in the direction in which fewer imports go. Nothing of the code is imported.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath

#: Folders of students' programs.
STUDENTS = {"starter", "reference", "right"}
#: Rooms of grader/ that are not the core.
AROUND_THE_CORE = {"grader/exercises", "grader/batch"}
#: Folders from which packages are imported.
IMPORTED_FROM = (PurePosixPath("."), PurePosixPath("tf2"))
#: Folders whose classes have the names of ROS's.
DOUBLES = ("tf2/", "robot_py/ros/")

Trees = Mapping[PurePosixPath, ast.Module]


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


def double_names(trees: Trees) -> dict[str, list[PurePosixPath]]:
    """Return the names of top-level classes that occur in several files."""
    found = defaultdict(list)
    for path, tree in trees.items():
        for name in {node.name for node in tree.body if isinstance(node, ast.ClassDef)}:
            found[name].append(path)
    return {name: found[name] for name in sorted(found) if len(found[name]) > 1}


def is_double_of_ros(paths: list[PurePosixPath]) -> bool:
    """Whether a name occurs in at most one file that is no double of ROS's API."""
    others = [p for p in paths if "doubles" not in p.parts and not str(p).startswith(DOUBLES)]
    return len(others) < 2


def imports(trees: Trees) -> Iterator[tuple[PurePosixPath, int, PurePosixPath]]:
    """Yield file, line and imported file of every import of a file that counts."""
    modules = {}
    for path in trees:
        for folder in IMPORTED_FROM:
            if path.is_relative_to(folder):
                parts = path.relative_to(folder).with_suffix("").parts
                modules[parts[:-1] if parts[-1] == "__init__" else parts] = path
    for path, tree in trees.items():
        for node in ast.walk(tree):
            names: list[tuple[str, ...]] = []
            if isinstance(node, ast.Import):
                names = [tuple(alias.name.split(".")) for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                above = path.parts[: -node.level] if node.level else ()
                start = (*above, *(node.module.split(".") if node.module else ()))
                names = [(*start, alias.name) for alias in node.names]
            for name in names:
                known = (modules.get(name[:length]) for length in range(len(name), 0, -1))
                target = next(filter(None, known), None)
                if target is not None:
                    yield path, node.lineno, target


def arrows(trees: Trees) -> dict[tuple[str, str], list[str]]:
    """Return the imports between rooms, as "file:line"; in grader/ itself each file is a room."""
    found = defaultdict(list)
    for path, line, target in imports(trees):
        ends = [str(p) if room(p) == "grader" else room(p) for p in (path, target)]
        if ends[0] != ends[1]:
            found[ends[0], ends[1]].append(f"{path}:{line}")
    return dict(found)


def circles(pairs: Mapping[tuple[str, str], object]) -> list[list[str]]:
    """Return the groups of rooms each of which leads to each other one."""
    reached = defaultdict(set)
    for start, end in pairs:
        reached[start].add(end)
    for middle in list(reached):
        for start in list(reached):
            if middle in reached[start]:
                reached[start] |= reached[middle]
    groups = {
        frozenset(end for end in reached[start] if start in reached[end])
        for start in list(reached)
        if start in reached[start]
    }
    return sorted(sorted(group) for group in groups)


def main(root: Path) -> None:
    """Print everything."""
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
    ours = {name: paths for name, paths in names.items() if not is_double_of_ros(paths)}
    print(f"\nclass names in several modules: {len(ours)}")
    for name, paths in ours.items():
        print(f"  {name}: {', '.join(map(str, paths))}")
    print(f"  doubles of ROS's API besides: {', '.join(sorted(names.keys() - ours.keys()))}")

    found = arrows(trees)
    back = [pair for pair in found if len(found[pair]) < len(found.get(pair[::-1], []))]
    print(f"\narrows between rooms: {len(found)}; that run back up: {len(back)}")
    for start, end in sorted(back):
        print(f"  {start} -> {end}: {', '.join(found[start, end])}")
    groups = circles(found)
    print(f"circles: {len(groups)}")
    for group in groups:
        print(f"  {', '.join(group)}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1])
