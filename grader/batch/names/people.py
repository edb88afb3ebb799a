"""The names of a person in the forms that people and programs give them, and what else tells who.

A part of a name counts by itself where it has three letters, and is no word that the grader, its
exercise, ROS or Python use: `Green` of `Mark Green` is a colour. The whole name counts in all
forms, unless it is made of nothing but such words and numbers: `Mark Green` and `Turtle 1` count as
they stand there, with the blank, since a program may have a topic `/turtle1` or `mark_green`.
"""

from __future__ import annotations

import builtins
import json
import keyword
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from importlib.resources import files
from itertools import islice
from pathlib import Path
from typing import Final

from grader.batch.entry import Person
from grader.batch.names.replacing import STRONG, literal
from grader.batch.names.spelling import folded, is_unspaced, words_of
from grader.exercise.exercise import Exercise
from grader.recording.subject import CAST_SCENE, load_subject
from grader.submission.folder import MAX_ENTRIES

#: A part of a name has so many letters at least, and a number that tells who somebody is so many
#: digits.
LEAST: Final = 3
LEAST_DIGITS: Final = 5
#: Titles of the columns that tell who somebody is, folded and without blanks and signs.
_TELLING: Final = re.compile(
    r".*(mail|user|login|anmelde|identit|courriel|github).*|sid|id|sis.*id|idnumber|idnummer"
    r"|student|.*(number|nummer)|.*name|vorname|nom|prenom|netid|matrikel.*"
)
#: Titles like these that do not.
_OTHERS: Final = re.compile(r".*(filename|participant|group|team|gruppe|phone).*")
#: German and Scandinavian letters in two letters.
_IN_TWO: Final = str.maketrans(
    {"ä": "ae", "ö": "oe", "ü": "ue", "å": "aa"} | {"Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "Å": "Aa"}
)
#: What stands in a package that nobody has filled in, and in addresses.
_USUAL: Final = (
    "todo maintainer author user root student anonymous unknown email mail example com org net edu "
    "www http https your name none gmail outlook github gitlab noreply users home university "
    "description license apache bsd mit copyright resource launch test tests src build install "
    "urdf meshes rviz config params setup package init pep257 flake8 xacro mesh solution exercise "
    "homework final version subscriber subscription minimum lifecycle component composition "
    "executable namespace remap remapping reliability durability history transform broadcaster "
    "buffer listener talker sender receiver controller"
)
#: Modules whose words are values in a recording.
_RECORDED: Final = (
    ("grader.recording", "observations.py"),
    ("grader.recording", "recording.py"),
    ("grader.inspection", "trace.py"),
    ("grader.cast", "trace.py"),
    ("grader.scenes.turtlesim", "messages.py"),
    ("turtlesim_py.world", "events.py"),
)
_EMAIL: Final = re.compile(r"([\w.+-]+)@[\w-]+(?:\.[\w-]+)+")


def names_of(person: Person) -> list[str]:
    """Return all texts that tell who a person is: the id, the name, telling columns."""
    found = [person.name, person.id]
    for title, value in person.columns.items():
        short = re.sub(r"[\W_]", "", folded(title))
        if _TELLING.fullmatch(short) and not _OTHERS.fullmatch(short):
            found.append(value)
    first, last = (_column(person, titles) for titles in (_FIRST, _LAST))
    if first and last:
        found.append(f"{first} {last}")
    return [text for text in dict.fromkeys(found) if text.strip()]


_FIRST: Final = ("firstname", "givenname", "vorname", "prenom")
_LAST: Final = ("lastname", "surname", "familyname", "nachname", "nomdefamille", "nom")


def _column(person: Person, titles: tuple[str, ...]) -> str:
    by_title = {re.sub(r"[\W_]", "", folded(t)): v for t, v in person.columns.items()}
    return next((by_title[title] for title in titles if by_title.get(title)), "")


def forms(texts: Iterable[str], instead: str, known: frozenset[str]) -> dict[str, str]:
    """Return the forms of names: folded words with blanks between them -> what stands for them.

    Parts of a name get numbers, so that what was different stays different.

    Args:
        texts: names, ids, addresses.
        instead: stands for a whole name.
        known: words that do not count by themselves.
    """
    whole: dict[str, str] = {}
    parts: dict[str, str] = {}
    literals: dict[str, str] = {}
    for text in texts:
        address = _EMAIL.fullmatch(text.strip())
        if _is_usual(address[1] if address else text, known):
            if address or len(text.split()) > 1:
                literals[literal(text)] = instead
            continue
        for words in _spellings(address[1] if address else text):
            for order in _orders(words):
                whole.setdefault(" ".join(order), instead)
                if len(together := "".join(order)) >= STRONG:
                    whole.setdefault(together, instead)
            for number, word in enumerate(words):
                parts.setdefault(word, f"{instead}x{number + 2}")
    made = {name: stands for name, stands in whole.items() if " " in name or _counts(name, known)}
    return {name: at for name, at in parts.items() if _counts(name, known)} | made | literals


def _is_usual(text: str, known: frozenset[str]) -> bool:
    """Whether a name is made of nothing but known words and short numbers, as `Turtle 1`.

    Short words count in a login: `s17` and `kb4712` are names, if nothing else is called so.
    """
    is_login = len(_plain_words(text)) == 1
    if is_login and not _counts(_plain_words(text)[0], known):
        return True
    return all(
        len(word) < LEAST_DIGITS
        if word.isdigit()
        else word in known and (not is_login or len(word) >= LEAST)
        for word in words_of(text)
    )


def _counts(word: str, known: frozenset[str]) -> bool:
    """Whether a word by itself tells who somebody is."""
    if word.isdigit():
        return len(word) >= LEAST_DIGITS
    return word not in known and (len(word) >= LEAST or (is_unspaced(word) and len(word) > 1))


def _spellings(text: str) -> Iterator[list[str]]:
    """Yield the words of a name as it is spelled without accents, and with ü as ue."""
    made = [text.replace("_", " ")]
    if (other := made[0].translate(_IN_TWO)) != made[0]:
        made.append(other)
    seen = set()
    for each in made:
        for words in (_plain_words(each), words_of(each)):
            if words and tuple(words) not in seen:
                seen.add(tuple(words))
                yield words


def _plain_words(text: str) -> list[str]:
    """Return the words as they stand: `McKay` and `zmueller2` are one."""
    return re.findall(r"[^\W_]+", folded(text))


def _orders(words: list[str]) -> Iterator[list[str]]:
    """Yield a name in the orders in which people write it."""
    yield words
    if len(words) > 1:
        yield [*words[-1:], *words[:-1]]
        yield [*words[1:], words[0]]
        if len(words) > 2:
            yield [words[0], words[-1]]
            yield [words[-1], words[0]]
        first, last = words[0], words[-1]
        if first.isalpha() and last.isalpha() and len(last) + 1 >= STRONG:
            yield [first[0] + last]
            yield [last + first[0]]


def known_words(exercise: Exercise | None = None) -> frozenset[str]:
    """Return the words that the grader, an exercise and Python use."""
    if exercise is None:
        return _known_words(None, CAST_SCENE)
    return _known_words(exercise.folder, exercise.scene)


@lru_cache(maxsize=4)  # a worker of a cluster has each exercise in another folder
def _known_words(exercise: Path | None, scene: str) -> frozenset[str]:
    catalogue = json.loads((files("grader") / "languages" / "fr.json").read_text("utf-8"))
    texts = [*catalogue, _USUAL, *keyword.kwlist, *dir(builtins), *sys.stdlib_module_names]
    for package, file in _RECORDED:
        texts.append((files(package) / file).read_text("utf-8"))
    for name, definition in load_subject(scene).message_definitions().items():
        texts += [name, definition]
    for path in sorted(exercise.rglob("*")) if exercise else ():
        texts.append(path.name)
        if path.is_file() and path.stat().st_size < 200_000:
            texts.append(path.read_bytes().decode("utf-8", "replace"))
    found = {word for text in texts for word in words_of(text)}
    return frozenset(found | {word for text in texts for word in _plain_words(text)})


def of_all(
    people: Mapping[str, Iterable[str]], known: frozenset[str], shared: str
) -> dict[str, str]:
    """Return the forms of many people.

    Args:
        people: what stands for each -> the texts that tell who it is.
        shared: stands for what several have in common.
    """
    made: dict[str, str] = {}
    whose: dict[str, str] = {}
    for instead, texts in people.items():
        for name, stands in forms(texts, instead, known).items():
            if whose.setdefault(name, instead) != instead:
                stands = shared
            made[name] = stands
    return made


# What a hand-in says of its author ----------------------------------------------------------------

#: A line of a file that names somebody, and what stands in it behind that.
_FIELD: Final = re.compile(
    r"(?im)^[ \t#*/\"'<{\[,(.@\\-]*(?:__)?(?:authors?|maintainers?|contributors?"
    r"|developers?|e-?mails?|author_e?mail|maintainer_email"
    r"|created[ _]by|written[ _]by|signed-off-by)"
    r"(?:__)?[\"']?\s*(?:[:=>(\[]|(?<=by)\s)(.*)$"
)
#: The same in a package.xml, over several lines.
_ELEMENT: Final = re.compile(r"(?is)<(?:author|maintainer)\b([^>]*)>([^<]*)<")
_QUOTED: Final = re.compile(r"""(["'])(.*?)\1""")
#: Git's own: `name = ...` of a config, a line of a log, the head of a commit.
_GIT: Final = re.compile(
    r"(?m)^(?:\s*(?:name|email)\s*=\s*(.*)|[0-9a-f]{40} [0-9a-f]{40} (.*> )"
    r"|(?:author|committer) (.*>) )"
)
_MOST_BYTES: Final = 200_000
_MOST_WORDS: Final = 12
_TEXTS: Final = (".py", ".xml", ".cfg", ".toml", ".md", ".txt", ".rst", ".yaml", ".yml", ".cpp")
_TEXTS_MORE: Final = (".hpp", ".h", ".c", ".json", ".urdf", ".xacro", "")


def said_in(folder: Path, git: Iterable[str] = ()) -> list[str]:
    """Return what the files of a hand-in say of their authors: names, and addresses.

    Args:
        folder: its private copy.
        git: texts of its repository.
    """
    found: list[str] = []
    for path in _below(folder):
        if path.suffix.lower() not in (*_TEXTS, *_TEXTS_MORE) or path.is_symlink():
            continue
        if path.is_file() and path.stat().st_size <= _MOST_BYTES:
            found += _said(path.read_bytes().decode("utf-8", "replace"))
    for text in git:
        values = (value for match in _GIT.finditer(text) for value in match.groups())
        found += [value for value in values if value]
    return [
        text
        for value in dict.fromkeys(found)
        for text in (_EMAIL.sub(" ", value), *_EMAIL.findall(value))
        if len(words_of(text)) <= _MOST_WORDS
    ]


def _below(folder: Path) -> list[Path]:
    """Return what is in a folder and below; of a file, the file."""
    return sorted(islice(folder.rglob("*"), MAX_ENTRIES)) if folder.is_dir() else [folder]


def _said(text: str) -> Iterator[str]:
    for match in _ELEMENT.finditer(text):
        yield match[2]
        yield from (quoted[1] for quoted in _QUOTED.findall(match[1]))
    for match in _FIELD.finditer(text):
        quoted = [each[1] for each in _QUOTED.findall(match[1])]
        yield from quoted or [match[1]]
    yield from (match[0] for match in _EMAIL.finditer(text))


def called_in(folder: Path, name: str, known: frozenset[str]) -> list[str]:
    """Return the words in names of files and folders of a hand-in that are not usual ones."""
    names = [name, *(path.name for path in _below(folder))]
    words = {word for each in names for word in words_of(each)}
    return sorted(word for word in words if _counts(word, known) and not word.isdigit())
