"""Reads what the source of a program imports, and has on the graph, as far as names can be read.

Of imports it is what its start loads. Nothing of it is run.
"""

from __future__ import annotations

import ast
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Final

from grader.recording.subject import Role, RoleKind
from grader.submission import safe_files
from grader.submission.folder import read_bounded
from grader.submission.program import Program, Script
from grader.submission.python_source import last, parse
from grader.submission.start import Imports
from grader.text.strings import shown

#: What runs together with the statement that it stands in, once and in any case.
_ALWAYS: Final = (ast.Module, ast.ClassDef, ast.With, ast.AsyncWith)
_BODIES: Final = (ast.stmt, ast.ExceptHandler, ast.match_case)

#: What makes an end: which one, and where it gets its name, the place and the keyword.
_MADE_BY: Final[Mapping[str, tuple[RoleKind, int, str]]] = {
    "create_publisher": ("publisher", 1, "topic"),
    "create_subscription": ("subscription", 1, "topic"),
    "create_service": ("service", 1, "srv_name"),
    "create_client": ("client", 1, "srv_name"),
    "ActionServer": ("action", 2, "action_name"),
    "ActionClient": ("action_client", 2, "action_name"),
    "declare_parameter": ("parameter", 0, "name"),
}
#: Classes of tf2_ros, with the end that each makes.
_OF_TF: Final = {
    "TransformBroadcaster": Role("publisher", "/tf"),
    "StaticTransformBroadcaster": Role("publisher", "/tf_static"),
    "TransformListener": Role("subscription", "/tf"),
}
_ANY: Final = "*"


def read_imports(
    root: Path,
    programs: Iterable[Program],
    only: Path | None = None,
    beside: Sequence[Path] = (),
) -> Imports:
    """Read what is started, and what of the submission that imports in turn.

    A file that cannot be read or parsed is skipped: the run shows what is wrong with it. So is a
    name in a string that is given to importlib.

    Args:
        root: of the submission.
        only: the one file that is the submission, if it is one: its neighbours are no part of it.
        beside: folders of other packages in it.
    """

    def files(module: str, base: Path) -> list[tuple[Path, str, Path]]:
        places = (base, *beside)
        found = ((*each, place) for place in places for each in _files(place, module))
        return [each for each in found if only is None or each[0] == only]

    found = Imports()
    pending: deque[tuple[Path, str, Path, bool]] = deque()  # file, package, root, surely loaded
    for each in programs:
        if isinstance(each.entry, Script):
            pending.append((each.entry.path, "", each.root, True))
        elif each.entry is not None:
            pending.extend((*file, True) for file in files(each.entry.module, each.root))
    seen: set[tuple[Path, bool]] = set()
    while pending:
        file, package, base, is_loaded = pending.popleft()
        if (file, True) in seen or (file, is_loaded) in seen:
            continue
        seen.add((file, is_loaded))
        for node, always in _statements(file):
            surely = is_loaded and always
            for module in _modules(node, package):
                pending.extend((*loaded, surely) for loaded in files(module, base))
                top = module.partition(".")[0]
                if not files(top, base):
                    called = file.relative_to(root) if file.is_relative_to(root) else file.name
                    where = f"{called}, line {node.lineno}"
                    names = found.surely if surely else found.perhaps
                    names.setdefault(top, shown(where))
    return replace(found, files=tuple(sorted({file for file, _ in seen})))


def _statements(file: Path) -> Iterator[tuple[ast.Import | ast.ImportFrom, bool]]:
    """Yield the imports in a file, in order, and whether each is run whenever the file is."""
    pending: list[tuple[ast.AST, bool]] = [(_tree(file), True)]
    while pending:
        node, always = pending.pop()
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            yield node, always
        inside = always and isinstance(node, _ALWAYS)
        children = [child for child in ast.iter_child_nodes(node) if isinstance(child, _BODIES)]
        pending += [(child, inside) for child in reversed(children)]


def _tree(file: Path) -> ast.Module:
    """The syntax tree of a file; an empty one where it cannot be read or parsed."""
    try:
        return parse(read_bounded(file) or b"")
    except (OSError, SyntaxError):
        return parse(b"")


def _modules(node: ast.Import | ast.ImportFrom, package: str) -> list[str]:
    """Return the full names of all that an import statement may load."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    origin = node.module or ""
    if node.level:
        parents = package.split(".") if package else []
        if node.level > len(parents):
            return []  # Python refuses it
        parents = parents[: len(parents) - node.level + 1]
        origin = ".".join([*parents, *([origin] if origin else [])])
    return [origin, *(f"{origin}.{alias.name}" for alias in node.names if alias.name != "*")]


def _files(root: Path, module: str) -> list[tuple[Path, str]]:
    """Return the submission's files that an import of a module loads, each with its package."""
    files = []
    folder, package = root, ""
    for part in module.split("."):
        inner = f"{package}.{part}" if package else part
        candidates = ((folder / part / "__init__.py", inner), (folder / f"{part}.py", package))
        files += [candidate for candidate in candidates if safe_files.is_file(candidate[0])][:1]
        folder, package = folder / part, inner
        if not safe_files.is_folder(folder):
            break
    return files


# On the graph -----------------------------------------------------------------------------------


def roles_in(files: Iterable[Path]) -> set[Role]:
    """Return what some files have; `*` in a name stands for what a run alone shows."""
    found = set[Role]()
    for file in files:
        tree = _tree(file)
        texts = _texts(tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.Call):
                found |= _made(node, texts)
    return found


def is_among(role: Role, found: Iterable[Role]) -> bool:
    """Whether a role is one of those that were found."""
    return any(
        each.kind == role.kind and each.name.strip("/*") and fnmatchcase(role.name, each.name)
        for each in found
    )


def _made(call: ast.Call, texts: Mapping[str, str]) -> set[Role]:
    called = last(call.func)
    if called in _OF_TF:
        return {_OF_TF[called]}
    if called not in _MADE_BY:
        return set()
    kind, place, keyword = _MADE_BY[called]
    given = [*call.args[place : place + 1], *(k.value for k in call.keywords if k.arg == keyword)]
    if not given:
        return set()
    name = _text(given[0], texts)
    if kind == "parameter" or name.startswith("/"):
        return {Role(kind, name)}
    return {Role(kind, f"/{_ANY if name.startswith('~') else ''}{name.removeprefix('~')}")}


def _texts(tree: ast.Module) -> dict[str, str]:
    """Return the texts that names and attributes are given, by their last parts."""
    found: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant | ast.JoinedStr):
            for target in node.targets:
                name, text = last(target), _text(node.value, {})
                found[name] = _ANY if found.get(name, text) != text else text
    return found


def _text(node: ast.expr, texts: Mapping[str, str]) -> str:
    match node:
        case ast.Constant(value=str(text)):
            return text
        case ast.JoinedStr(values=parts):
            return "".join(_text(each, texts) for each in parts)
        case ast.FormattedValue(value=value):
            return _text(value, texts)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return _text(left, texts) + _text(right, texts)
        case ast.Name() | ast.Attribute():
            return texts.get(last(node), _ANY)
    return _ANY
