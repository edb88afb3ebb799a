"""Reads a YAML file strictly, and reports every mistake in it with file and line."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from grader.errors import ExerciseError
from grader.system import strict_json
from grader.text.message import Message, joined, msg
from grader.text.strings import nearest

#: A file of data is an author's: its texts may be long.
_BOUNDS = strict_json.OURS._replace(entries=5000)
#: The keys that lead to a value in a file.
Keys = tuple[str, ...]


class Mistake(ExerciseError):
    """Something wrong with the value at some keys: 'limits: rest_s: expected ...'.

    Args:
        text: what is wrong, or the key of that sentence.
        values: those of the sentence.
    """

    def __init__(self, keys: Keys, text: str | Message, /, **values: Any) -> None:
        what = msg(text, **values) if isinstance(text, str) else text
        super().__init__(joined((*keys, what), ": "))
        self.keys = keys


@dataclass(frozen=True)
class YamlFile:
    """The content of a file.

    Attributes:
        name: of the file, without its folder.
        data: its content.
        lines: in which line the keys of the mappings stand, from 1.
    """

    name: str
    data: Any
    lines: Mapping[Keys, int] = field(default_factory=dict)

    def describe(self, mistake: Mistake) -> Message:
        """Describe a mistake with the file, and the line of the nearest key that stands in it."""
        keys = mistake.keys
        while keys and keys not in self.lines:
            keys = keys[:-1]
        if not keys:
            return joined([self.name, mistake.message], ": ")
        return msg(
            "{file}, line {line}: {what}",
            file=self.name,
            line=str(self.lines[keys]),
            what=mistake.message,
        )


def read_yaml(path: Path) -> YamlFile:
    """Read a file."""
    raw = path.read_bytes()
    try:
        text = raw.decode("utf-8-sig")
        data, lines = deepcopy(_parsed(text))
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise ExerciseError(
            "{name}, line {line}: it is not UTF-8", name=path.name, line=line
        ) from None
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise ExerciseError(
            "{file}, line {line}: {what}", file=path.name, line=str(line), what=error.problem
        ) from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        what = msg("the character {character}", character=repr(error.character))
        raise ExerciseError(
            "{name}, line {line}: {what} is not allowed", name=path.name, line=line, what=what
        ) from None
    except RecursionError:
        raise ExerciseError("{name}: it is nested too deeply", name=path.name) from None
    except (yaml.YAMLError, ValueError) as error:
        raise ExerciseError(joined([path.name, str(error).splitlines()[0]], ": ")) from None
    except ExerciseError as error:
        raise ExerciseError(joined([path.name, error.message], ", ")) from None
    return YamlFile(path.name, data, lines)


@lru_cache(maxsize=16)  # judging a class reads the same rubric for each of its submissions
def _parsed(text: str) -> tuple[Any, dict[Keys, int]]:
    """Parse the data and the lines of its keys."""
    loader = yaml.SafeLoader(text)
    root = loader.get_single_node()
    if root is None:
        return None, {}
    lines = dict(_lines(root, ()))  # finds keys that stand there twice
    return loader.construct_document(root), lines


def _lines(node: yaml.Node, above: Keys) -> Iterator[tuple[Keys, int]]:
    """Yield the keys of mappings with their lines; those in lists are only checked."""
    todo: list[tuple[yaml.Node, Keys]] = [(node, above)]
    seen: set[int] = set()  # an alias leads to the same node again, or into itself
    while todo:
        node, above = todo.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, yaml.SequenceNode):
            todo += [(item, (*above, "")) for item in node.value]
        if not isinstance(node, yaml.MappingNode):
            continue
        keys: set[Hashable] = set()
        for key, value in node.value:
            line = key.start_mark.line + 1
            if not isinstance(key, yaml.ScalarNode):
                continue
            if key.value in keys and not key.tag.endswith(":merge"):
                raise ExerciseError(
                    "line {line}: the key {value} stands here twice",
                    line=line,
                    value=repr(key.value),
                )
            keys.add(key.value)
            yield (*above, key.value), line
            todo.append((value, (*above, key.value)))


def expect(fits: object, keys: Keys, wanted: str, found: object, **values: Any) -> None:
    """Refuse a value at some keys that does not fit; `wanted` is a sentence about `{found}`.

    Raises:
        Mistake: it does not fit.
    """
    if not fits:
        raise Mistake(keys, wanted, found=repr(found), **values)


def decoded(kind: Any, value: Any, *keys: str) -> Any:
    """Decode the value at some keys by annotations; see `strict_json`.

    Raises:
        Mistake: it does not fit; its keys lead to the part that does not.
    """
    try:
        return strict_json.from_json(kind, value, _BOUNDS)
    except ValueError as error:
        what = str(error)
    while isinstance(value, dict) and (key := what.partition(": ")[0]) in value:
        keys, value, what = (*keys, key), value[key], what.partition(": ")[2]
    raise Mistake(keys, msg("{what}", what=what))


def check_known(
    given: Iterable[object], known: Collection[str], keys: Keys, *, are_checks: bool = False
) -> None:
    """Refuse an unknown name at some keys.

    Raises:
        Mistake: there is one.
    """
    for name in given:
        if name not in known:
            hint = did_you_mean(name, known)
            if are_checks:
                raise Mistake(keys, "no check is named {name}; {hint}", name=repr(name), hint=hint)
            raise Mistake(keys, "unknown {key}; {hint}", key=repr(name), hint=hint)


def did_you_mean(key: object, known: Iterable[object]) -> Message:
    """Suggest what an unknown key may have meant, and list those that there are."""
    names = [str(name) for name in known]
    there = {"names": ", ".join(names)}
    if near := nearest(str(key), names):
        return msg("did you mean {near}? There are {names}", near=repr(near[0]), **there)
    return msg("there are {names}", **there)
