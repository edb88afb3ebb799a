"""Reads what a submission imports from the files that its start loads; nothing of it is run."""

from __future__ import annotations

import ast
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from grader.submission import safe_files
from grader.submission.folder import read_bounded
from grader.submission.program import Program, Script
from grader.submission.python_source import parse
from grader.submission.start import Imports
from grader.text.strings import shown

#: What runs together with the statement that it stands in, once and in any case.
_ALWAYS: Final = (ast.Module, ast.ClassDef, ast.With, ast.AsyncWith)
_BODIES: Final = (ast.stmt, ast.ExceptHandler, ast.match_case)


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
    try:
        data = read_bounded(file)
        tree = parse(data or b"")
    except (OSError, SyntaxError):
        return
    pending: list[tuple[ast.AST, bool]] = [(tree, True)]
    while pending:
        node, always = pending.pop()
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            yield node, always
        inside = always and isinstance(node, _ALWAYS)
        children = [child for child in ast.iter_child_nodes(node) if isinstance(child, _BODIES)]
        pending += [(child, inside) for child in reversed(children)]


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
