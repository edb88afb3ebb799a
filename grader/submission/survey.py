"""What a package says of its program and its launch files, whatever else these hold; never run.

`launch_files` reads what is plain enough to be started as it says; this looks on, in any launch
file, for the nodes that it names. What is computed is not known, and taken to be right.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, Final

from grader.packaged import LaunchDescription, LaunchedNode, Packaged
from grader.submission.constants import Constants
from grader.submission.folder import HandedIn, files_below, read_bounded, shown
from grader.submission.launch_files import is_launch_file
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.manifest import parse_xml, read_manifest
from grader.submission.python_source import parse
from grader.submission.setup_files import Package

FUNCTION: Final = "generate_launch_description"
#: Keyword arguments of `Node` up to Foxy: since then they raise a TypeError.
OLD_WORDS: Final = ("node_executable", "node_name", "node_namespace")
DESCRIPTIONS: Final = (".urdf", ".urdf.xml", ".xacro")
#: What `setup.py` calls to list the files of a folder.
_LISTING: Final = ("walk", "listdir", "scandir", "rglob", "iterdir", "glob")
#: What a launch file may start that cannot be read.
ANYTHING: Final = LaunchedNode(None, None, None)
_AT_HOME: Final = re.compile(r"(/home/|/Users/|/root/|~/|[A-Za-z]:[\\/]).*")


def survey(
    handed_in: HandedIn, package: Package, started: str, shortcomings: tuple[str, ...]
) -> Packaged:
    """All that is told of a package.

    Args:
        started: the console script that is started; '' for none.
        shortcomings: from `building`.
    """
    folder = package.folder
    manifest = read_manifest(folder / MANIFEST) if (folder / MANIFEST).is_file() else None
    files = [file for file in files_below(folder) if file.is_relative_to(folder)]
    installs = _Installs(folder / "setup.py")
    return Packaged(
        name="" if manifest is None else manifest.name,
        scripts=tuple(script.name for script in package.scripts),
        started=started,
        shortcomings=shortcomings,
        launches=tuple(
            _launch(file, handed_in.called(file), is_installed=file.relative_to(folder) in installs)
            for file in files
            if is_launch_file(file)
        ),
        not_installed=tuple(
            handed_in.called(file)
            for file in files
            if file.name.endswith(DESCRIPTIONS) and file.relative_to(folder) not in installs
        ),
    )


class _Installs:
    """Which files a setup.py names: by a path, a pattern, or, where it lists folders, a folder."""

    def __init__(self, setup_py: Path) -> None:
        self._named: set[str] = set()
        self._lists = False
        data = read_bounded(setup_py) if setup_py.is_file() else b""
        try:
            tree = parse(data or b"", setup_py.name)
        except SyntaxError:
            return
        constants = Constants(tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.expr) and isinstance(text := constants.value(node), str):
                self._named.add(text.removeprefix("./").rstrip("/"))
            name = getattr(node, "attr", getattr(node, "id", ""))
            self._lists = self._lists or name in _LISTING

    def __contains__(self, file: Path) -> bool:
        path = file.as_posix()
        if any(fnmatch(path, pattern) and _as_deep(path, pattern) for pattern in self._named):
            return True
        folders = {parent.as_posix() for parent in file.parents} - {"."}
        return self._lists and bool(folders & self._named)


def _as_deep(path: str, pattern: str) -> bool:
    """Whether `*` stands for no slash, as for glob; but `**` may."""
    return "**" in pattern or path.count("/") == pattern.count("/")


def _launch(file: Path, called: str, *, is_installed: bool) -> LaunchDescription:
    data = read_bounded(file)
    if data is None or file.suffix not in (".py", ".xml"):  # YAML: Python alone does not read it
        return LaunchDescription(called, is_installed=is_installed, nodes=(ANYTHING,))
    fault, includes = "", False
    nodes: list[LaunchedNode] = []
    texts: list[str] = []
    if file.suffix == ".py":
        try:
            tree = parse(data, file.name)
        except SyntaxError as error:
            fault = f"it does not parse: {shown(str(error))}"
        else:
            fault = _fault(tree)
            nodes = list(_python_nodes(tree))
            includes = any(_called(each) == "IncludeLaunchDescription" for each in ast.walk(tree))
            texts = [e.value for e in ast.walk(tree) if _is_text(e)]  # type: ignore[attr-defined]
    else:
        entries = list(_written(data))
        nodes = [_node(attributes) for tag, attributes in entries if tag == "node"]
        includes = any(tag == "include" for tag, _ in entries)
        texts = [t for _, attributes in entries for t in attributes.values() if isinstance(t, str)]
        fault = "" if entries else "it names nothing to start"
    absolute = tuple(text for text in texts if _AT_HOME.fullmatch(text))
    return LaunchDescription(called, fault, is_installed, includes, absolute, tuple(nodes))


def _fault(tree: ast.Module) -> str:
    if not any(isinstance(n, ast.FunctionDef) and n.name == FUNCTION for n in tree.body):
        return f"it has no function {FUNCTION}"
    for call in ast.walk(tree):
        words = [k.arg for k in call.keywords] if isinstance(call, ast.Call) else []
        old = [word for word in words if word in OLD_WORDS]
        if old and _called(call) == "Node":
            return f"Node knows no {old[0]}, which has another name since ROS 2 Foxy"
    return ""


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _called(node: ast.AST) -> str:
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name
    return ""


def _python_nodes(tree: ast.Module) -> Iterator[LaunchedNode]:
    constants = Constants(tree)
    assigned = {
        target.id: node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    for call in ast.walk(tree):
        if not isinstance(call, ast.Call) or _called(call) != "Node":
            continue
        said = {keyword.arg: keyword.value for keyword in call.keywords}

        def text(key: str, said: dict[str | None, ast.expr] = said) -> str | None:
            value = constants.value(said[key]) if key in said else None
            return value if isinstance(value, str) else None

        names = _parameter_names(said.get("parameters"), assigned)
        yield LaunchedNode(text("package"), text("executable"), names)


def _parameter_names(
    node: ast.expr | None, assigned: dict[str, ast.expr]
) -> tuple[str, ...] | None:
    """The keys of the dicts in a list; None where something else may hold more."""
    if node is None:
        return ()
    match node:
        case ast.List(elts=items) | ast.Tuple(elts=items):
            each = [_parameter_names(item, assigned) for item in items]
            known = [names for names in each if names is not None]
            return tuple(n for names in known for n in names) if len(known) == len(each) else None
        case ast.Dict(keys=keys):
            texts = [key.value for key in keys if isinstance(key, ast.Constant)]
            return tuple(map(str, texts)) if len(texts) == len(keys) else None
        case ast.Name(id=name) if name in assigned:
            others = {key: value for key, value in assigned.items() if key != name}
            return _parameter_names(assigned[name], others)
    return None


def _written(data: bytes) -> Iterator[tuple[str, dict[str, Any]]]:
    """The tags of an XML launch file with their attributes, `param` as a list of names."""
    root = parse_xml(data)
    if root is None or isinstance(root, str):
        return
    for element in root.iter():
        names = [param.get("name") for param in element.findall("param")]
        yield element.tag, {**element.attrib, "param": names}


def _node(attributes: dict[str, Any]) -> LaunchedNode:
    def text(key: str) -> str | None:
        value = attributes.get(key)
        return value if isinstance(value, str) and "$" not in value else None

    names = attributes["param"]
    is_known = all(isinstance(name, str) and "$" not in name for name in names)
    return LaunchedNode(text("pkg"), text("exec"), tuple(names) if is_known else None)
