"""JavaScript modules as one script, for a page that has no server to ask for them.

They are written with the few forms of import and export that are read here; a page that is served
loads the same files as they are.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

_IMPORT = re.compile(r'^import \{ ([\w, ]+) \} from "\./(\w+)\.js";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async function|function|class|const) (\w+))", re.MULTILINE)


def joined(entry: str, folders: Sequence[Path]) -> str:
    """A script that runs the module of this name, after all that it imports.

    Args:
        folders: where modules are looked for, one after another.

    Raises:
        ValueError: a module is in none of them, or written otherwise.
    """
    parts = ['"use strict";', "const modules = {};"]
    _add(entry, folders, parts, [])
    return "\n".join(parts)


def _add(name: str, folders: Sequence[Path], parts: list[str], known: list[str]) -> None:
    if name in known:
        return
    known.append(name)
    file = next((f for folder in folders if (f := folder / f"{name}.js").is_file()), None)
    if file is None:
        raise ValueError(f"no module {name}.js in {', '.join(map(str, folders))}")
    text = file.read_text(encoding="utf-8")
    for imported in _IMPORT.finditer(text):
        _add(imported[2], folders, parts, known)
    exported = ", ".join(_EXPORT.findall(text))
    text = _EXPORT.sub("", _IMPORT.sub(r"const { \1 } = modules.\2;\n", text))
    other = re.search(r"^(import|export)\b.*", text, re.MULTILINE)
    if other or "</" in text or "<!--" in text:
        raise ValueError(f"{file}: cannot be joined: {other[0] if other else 'it has HTML in it'}")
    parts.append(f"modules.{name} = (() => {{\n{text}\nreturn {{ {exported} }};\n}})();")
