"""What a CMakeLists.txt installs, as far as its install() commands say it; it is not run."""

from __future__ import annotations

import fnmatch
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

_COMMENT = re.compile(r"#\[\[.*?\]\]|#[^\n]*", re.DOTALL)
_COMMAND = re.compile(r"\b(project|set|install|ament_python_install_package)\s*\(([^()]*)\)", re.I)
_WORD = re.compile(r'"((?:[^"\\]|\\.)*)"|(\S+)', re.DOTALL)
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_KINDS = ("DIRECTORY", "FILES", "PROGRAMS", "TARGETS")
_OPTIONS = (
    *("DESTINATION", "PATTERN", "FILES_MATCHING", "REGEX", "EXCLUDE", "PERMISSIONS", "RENAME"),
    *("USE_SOURCE_PERMISSIONS", "OPTIONAL", "COMPONENT", "RUNTIME", "ARCHIVE", "LIBRARY", "EXPORT"),
    *("CONFIGURATIONS", "INCLUDES", "FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS", "TYPE"),
    *("MESSAGE_NEVER", "EXCLUDE_FROM_ALL", "NAMELINK_SKIP", "BUNDLE", "PUBLIC_HEADER"),
)


class Read(NamedTuple):
    """What a CMakeLists.txt says.

    Attributes:
        project: its name; '' where it tells none.
        files: (folder below the prefix, file of the package).
        absent: what it installs, and is not there.
        programs: what is compiled and installed: 'lib/NAME/PROGRAM'.
    """

    project: str
    files: list[tuple[str, str]]
    absent: list[str]
    programs: list[str]


def read(folder: Path) -> Read:
    """What the CMakeLists.txt of a package says."""
    text = (folder / "CMakeLists.txt").read_text(encoding="utf-8", errors="replace")
    variables: dict[str, str] = {"CMAKE_CURRENT_SOURCE_DIR": ".", "CMAKE_SOURCE_DIR": "."}
    files: list[tuple[str, str]] = []
    absent: list[str] = []
    programs: list[str] = []
    for found in _COMMAND.finditer(_COMMENT.sub("", text)):
        words = [_filled(a or b, variables) for a, b in _WORD.findall(found[2])]
        match found[1].lower():
            case "project" if words:
                variables["PROJECT_NAME"] = words[0]
            case "set" if words:
                variables[words[0]] = ";".join(words[1:])
            case "install":
                _install(folder, words, files, absent, programs)
    return Read(variables.get("PROJECT_NAME", ""), files, absent, programs)


def _filled(word: str, variables: dict[str, str]) -> str:
    for _ in range(5):
        word = _VARIABLE.sub(lambda found: variables.get(found[1], ""), word)
    return word


def _install(
    folder: Path,
    words: list[str],
    files: list[tuple[str, str]],
    absent: list[str],
    programs: list[str],
) -> None:
    if not words or words[0].upper() not in _KINDS or "DESTINATION" not in words[:-1]:
        return
    where = words[words.index("DESTINATION") + 1].strip("/")
    end = next((n for n, word in enumerate(words[1:], 1) if word in _OPTIONS), len(words))
    named = [each for word in words[1:end] for each in word.split(";") if each]
    if words[0].upper() == "TARGETS":
        programs += [f"{where}/{name}" for name in named]
        return
    is_kept = _patterns(words)
    for name in named:
        source = folder / name
        if words[0].upper() == "DIRECTORY":
            if not source.is_dir():
                absent.append(name.rstrip("/"))
                continue
            # with a slash at its end what is in it is installed, without one the folder itself
            base = source if name.endswith("/") else source.parent
            for at, _, names in sorted(os.walk(source)):
                for each in sorted(names):
                    path = Path(at, each)
                    if is_kept(path.relative_to(source).as_posix(), each):
                        below = path.relative_to(base).parent.as_posix()
                        to = f"{where}/{below}" if below != "." else where
                        files.append((to, os.path.relpath(path, folder)))
        elif source.is_file():
            files.append((where, os.path.relpath(source, folder)))
        else:
            absent.append(name)


def _patterns(words: list[str]) -> Callable[[str, str], bool]:
    """Whether a file of a folder is installed, by FILES_MATCHING, PATTERN and EXCLUDE."""
    wanted: list[str] = []
    refused: list[str] = []
    for n, word in enumerate(words[:-1]):
        if word == "PATTERN":
            is_out = words[n + 2 : n + 3] == ["EXCLUDE"]
            (refused if is_out else wanted).append(words[n + 1])
    matching = "FILES_MATCHING" in words

    def is_kept(path: str, name: str) -> bool:
        parts = path.split("/")
        if any(fnmatch.fnmatch(part, each) for each in refused for part in parts):
            return False
        return not matching or any(fnmatch.fnmatch(name, each) for each in wanted)

    return is_kept
