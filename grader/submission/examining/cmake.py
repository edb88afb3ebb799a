"""What a CMakeLists.txt installs and generates, as far as its commands say it; it is not run."""

from __future__ import annotations

import fnmatch
import os
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice, pairwise
from pathlib import Path
from typing import NamedTuple

from grader.submission import safe_files
from grader.submission.examining.steps import Ended, attempt, it
from grader.submission.package_trace import Obstacle
from grader.text.message import msg

_COMMENT = re.compile(r"#\[\[.*?\]\]|#[^\n]*", re.DOTALL)
_KEPT = (
    *("find_package", "rosidl_generate_interfaces", "ament_python_install_package"),
    *("ament_package", "ament_auto_find_build_dependencies"),
)
_COMMAND = re.compile(
    rf"\b(project|set|list|file|install|{'|'.join(_KEPT)})\s*\(([^()]*)\)|\b(if|endif)\s*\(", re.I
)
#: The innermost loop: its head, and its body.
_LOOP = re.compile(
    r"\bforeach\s*\(([^()]*)\)((?:(?!\bforeach\s*\().)*?)\bendforeach\s*\([^()]*\)", re.I | re.S
)
_HERE = (
    *("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR"),
    "CMAKE_CURRENT_LIST_DIR",
)
FILE = "CMakeLists.txt"
_MOST_CHARACTERS, _MOST_FILES = 1_000_000, 20_000
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
    """What a set-up file installs, a CMakeLists.txt or a setup.py.

    Attributes:
        project: the name that it gives; '' where it tells none.
        files: (path below the prefix, file of the package).
        absent: what it installs, and is not there.
        programs: what is compiled and installed: 'lib/NAME/PROGRAM'.
        problems: what ended its evaluation; commands that nobody can follow here.
        calls: commands by which interfaces are generated, each with its words.
    """

    project: str
    files: list[tuple[str, str]]
    absent: list[str]
    programs: list[str]
    problems: list[Obstacle]
    calls: Sequence[list[str]] = ()


def read(folder: Path) -> Read:
    """What the CMakeLists.txt of a package says."""
    text = safe_files.read(folder / FILE, _MOST_CHARACTERS).decode("utf-8", "replace")
    variables = {**dict.fromkeys(_HERE, "."), "CMAKE_INSTALL_PREFIX": ""}
    made, calls = Read("", [], [], [], []), list[list[str]]()
    depth = 0  # of if()
    for found in _COMMAND.finditer(_unrolled(_COMMENT.sub("", text))):
        if found[3]:
            depth += 1 if found[3].lower() == "if" else -1
            continue
        words = [_filled(a or b, variables) for a, b in _WORD.findall(found[2])]
        if found[1].lower() in _KEPT:
            words = [each for word in words for each in word.split(";") if each]
            calls.append([found[1].lower(), *words])
            continue
        known = len(made.absent)
        try:
            attempt(partial(_follow, folder, found[1].lower(), words, variables, made))
        except Ended as ended:
            line = text[: text.find(found[0])].count("\n") + 1 if found[0] in text else 0
            made.problems.append(replace(ended.problem, file=FILE, line=line))
        if depth > 0:  # on a condition, mostly that it is there
            del made.absent[known:]
    return made._replace(project=variables.get("PROJECT_NAME", ""), calls=calls)


def module_folders(made: Read) -> Iterator[str]:
    """Yield where Python packages lie that are not in a folder of their name, as 'NAME=FOLDER'."""
    for call, *words in made.calls:
        given = dict(pairwise(words))
        if call == "ament_python_install_package" and "PACKAGE_DIR" in given:
            yield f"{words[0]}={given['PACKAGE_DIR']}"


def _follow(
    folder: Path, command: str, words: list[str], variables: dict[str, str], made: Read
) -> None:
    match command:
        case "project" if words:
            variables["PROJECT_NAME"] = words[0]
        case "set" if words:
            variables[words[0]] = ";".join(words[1:])[:_MOST_CHARACTERS]
        case "list" if len(words) > 2 and words[0].upper() == "APPEND":
            before = filter(None, [variables.get(words[1], "")])
            variables[words[1]] = ";".join([*before, *words[2:]])[:_MOST_CHARACTERS]
        case "file" if len(words) > 2 and words[0].upper() in ("GLOB", "GLOB_RECURSE"):
            variables[words[1]] = ";".join(_globbed(folder, words))
        case "install":
            _install(folder, words, made)


def _unrolled(text: str) -> str:
    """A text with its loops over words, and over lists of words, written out."""

    def listed(variable: str) -> list[str]:
        found = re.search(rf"\bset\s*\(\s*{re.escape(variable)}\s([^()]*)\)", text)
        return found[1].split() if found else []

    def written_out(loop: re.Match[str]) -> str:
        name, *items = loop[1].split() or [""]
        kind = [each.upper() for each in items[:2]]
        if kind[:1] == ["RANGE"]:
            return ""
        if kind == ["IN", "LISTS"]:
            items = [word for each in items[2:] for word in listed(each)]
        else:
            items = items[2:] if kind == ["IN", "ITEMS"] else items
            items = [word for each in items for word in listed(each[2:-1]) or [each]]
        return "\n".join(loop[2].replace(f"${{{name}}}", each) for each in items[:100])

    for _ in range(5):
        text = _LOOP.sub(written_out, text)[:_MOST_CHARACTERS]
    return text


def _globbed(folder: Path, words: list[str]) -> list[str]:
    """The files that patterns match: `*` within a name; of GLOB_RECURSE in folders below, too.

    Without RELATIVE they are absolute paths, as ${CMAKE_CURRENT_SOURCE_DIR} is: ./NAME here.
    """
    patterns = [each for each in words[2:] if each.upper() != "CONFIGURE_DEPENDS"]
    here = "./"
    if patterns[:1] == ["RELATIVE"]:
        here = ""
        if patterns[1:2] != ["."]:
            return []
        patterns = patterns[2:]
    found: set[str] = set()
    names = list(islice(_files_below(folder), _MOST_FILES))
    for pattern in patterns:
        parts = [each for each in pattern.split("/") if each not in ("", ".")]
        if pattern.startswith("/") or ".." in parts or not parts:
            continue
        for name in names:
            whole = name.split("/")
            if words[0].upper() == "GLOB_RECURSE" and len(whole) > len(parts):
                whole = [*whole[: len(parts) - 1], whole[-1]]
            if len(whole) == len(parts) and all(map(fnmatch.fnmatchcase, whole, parts)):
                found.add(here + name)
    return sorted(found)


def _files_below(folder: Path) -> Iterator[str]:
    for at, folders, names in os.walk(folder):
        folders.sort()
        for name in sorted(names):
            path = Path(at, name)
            if safe_files.is_file(path):
                yield path.relative_to(folder).as_posix()


def _filled(word: str, variables: dict[str, str]) -> str:
    """A word with its variables put in; those that nobody knows stay as they are."""
    for _ in range(5):
        word = _VARIABLE.sub(lambda found: variables.get(found[1], found[0]), word)
        word = word[:_MOST_CHARACTERS]
    return word


def _install(folder: Path, words: list[str], made: Read) -> None:
    files, absent, programs = made.files, made.absent, made.programs
    if not words or words[0].upper() not in _KINDS or "DESTINATION" not in words[:-1]:
        return
    where = words[words.index("DESTINATION") + 1].strip("/")
    end = next((n for n, word in enumerate(words[1:], 1) if word in _OPTIONS), len(words))
    named = [each for word in words[1:end] for each in word.split(";") if each]
    unknown = [each for each in (where, *named) if "${" in each or "$<" in each]
    if unknown:
        raise Ended(Obstacle("unknown", it(msg("installs {name}", name=unknown[0][:200]))))
    if words[0].upper() == "TARGETS":
        programs += [f"{where}/{name}" for name in named]
        return
    is_kept, renamed = _patterns(words), dict(pairwise(words)).get("RENAME")
    for name in named:
        source = Path(os.path.normpath(folder / name))
        if not source.resolve().is_relative_to(folder.resolve()):
            raise Ended(Obstacle("unknown", it(msg("installs {name}", name=name[:200]))))
        if words[0].upper() == "DIRECTORY":
            if not safe_files.is_folder(source):
                absent.append(name.rstrip("/"))
                continue
            # with a slash at its end what is in it is installed, without one the folder itself
            base = source if name.endswith("/") else source.parent
            for at, _, names in sorted(os.walk(source)):
                for each in sorted(names):
                    path = Path(at, each)
                    if is_kept(path.relative_to(source).as_posix(), each) and (
                        len(files) < _MOST_FILES
                    ):
                        to = f"{where}/{path.relative_to(base).as_posix()}"
                        files.append((to, os.path.relpath(path, folder)))
        elif safe_files.is_file(source):
            files.append((f"{where}/{renamed or source.name}", os.path.relpath(source, folder)))
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
