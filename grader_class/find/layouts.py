"""What course systems export: the layouts of Gradescope, Moodle and Canvas, and git repositories.

The name of a file or folder tells whose it is; see `plain.py` for where no system has named it.
"""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Final

import yaml

from grader.submission import is_junk
from grader.text import NOTHING, Message, msg, one_line, shown
from grader_class.entry import Person
from grader_class.find.attempt import Attempt, Export, Item, Piece, add_note, person, read_time


class Layout:
    """How the hand-ins of a class lie in a folder.

    Attributes:
        title: as it follows 'Read as '.
        left_out: the note on items of other `{names}`.
    """

    title: ClassVar[Message]
    left_out: ClassVar[Message]

    def fits(self, item: Item) -> object:
        """Whether an item has such a name."""
        raise NotImplementedError

    def matches(self, items: Sequence[Item]) -> bool:
        """Whether there are items, and at least half of them fit."""
        return bool(items) and 2 * sum(bool(self.fits(item)) for item in items) >= len(items)

    def read(self, items: Sequence[Item]) -> Export:
        """Read the attempts in a folder."""
        notes: list[Message] = []
        attempts = self.attempts([item for item in items if self.fits(item)], notes)
        add_note(notes, self.left_out, (item.name for item in items if not self.fits(item)))
        return Export(self.title, attempts, notes)

    def attempts(self, items: Sequence[Item], notes: list[Message]) -> list[Attempt]:
        """Return the attempts in the items that fit; add notes for the teacher."""
        raise NotImplementedError


class Gradescope(Layout):
    """Gradescope's export: `submission_NUMBER/` folders, and a file with their students.

    A Ruby program writes `submission_metadata.yml`: its keys begin with colons, and a time may be a
    Ruby object. It is parsed into texts alone: no tag is followed, and `sid: 007` stays '007'.
    """

    title = msg("Gradescope's export of submissions")
    left_out = msg("Left out, since Gradescope does not name them so: {names}.")
    METADATA: Final = "submission_metadata.yml"
    #: It also holds all output of autograders.
    MAX_METADATA_BYTES: Final = 100_000_000
    _FOLDER: Final = re.compile(r"submission_(?P<number>\d+)")
    _NO_FILES: Final = msg("Gradescope's export holds no file of this submission.")

    def fits(self, item: Item) -> object:
        return item.is_folder and self._FOLDER.fullmatch(item.name)

    def matches(self, items: Sequence[Item]) -> bool:
        has_metadata = any(item.name == self.METADATA and item.path.is_file() for item in items)
        return has_metadata or super().matches(items)

    def read(self, items: Sequence[Item]) -> Export:
        notes: list[Message] = []
        lying = {item.name: item for item in items}
        metadata = self._metadata(lying.pop(self.METADATA, None), notes)
        attempts = [self._attempt(name, lying.pop(name, None), metadata[name]) for name in metadata]
        rest = super().read([*lying.values()])
        return Export(self.title, [*attempts, *rest.attempts], [*notes, *rest.notes])

    def attempts(self, items: Sequence[Item], notes: list[Message]) -> list[Attempt]:
        return [self._attempt(item.name, item, {}) for item in items]

    def _attempt(self, name: str, item: Item | None, data: Mapping[str, Any]) -> Attempt:
        match = self._FOLDER.fullmatch(name)
        people = tuple(_submitters(data.get(":submitters")))
        people = people or (person(match["number"] if match else name),)
        at = data.get(":created_at")  # or a Ruby object with the time in UTC
        return Attempt(
            "+".join(sorted(each.id for each in people)),
            people,
            () if item is None else (Piece(item.path, "" if item.is_folder else item.name),),
            at=read_time(_scalar(at.get("utc") if isinstance(at, dict) else at)),
            problem=self._NO_FILES if item is None else NOTHING,
            alone=True,
        )

    def _metadata(self, item: Item | None, notes: list[Message]) -> dict[str, dict[str, Any]]:
        """Return the metadata of each submission, by the name of its folder."""
        why = msg("there is no {file}", file=self.METADATA)
        if item is not None and item.path.is_file():
            try:
                return self._parsed(item)
            except (yaml.YAMLError, ValueError, RecursionError) as error:
                why = msg(
                    "{file} cannot be read ({why})",
                    file=self.METADATA,
                    why=one_line(Message.of(error)),
                )
        notes.append(msg("Names, ids and times are missing, since {why}.", why=why))
        return {}

    def _parsed(self, item: Item) -> dict[str, dict[str, Any]]:
        if item.path.stat().st_size > self.MAX_METADATA_BYTES:
            size = self.MAX_METADATA_BYTES / 1e6
            raise ValueError(msg("it has more than {size:g} MB", size=size))
        with item.path.open("rb") as file:
            found = yaml.load(file, Loader=getattr(yaml, "CBaseLoader", yaml.BaseLoader))
        if not isinstance(found, dict):
            raise ValueError(msg("it is empty"))
        return {
            name: data
            for name, data in found.items()
            if isinstance(name, str) and isinstance(data, dict)
        }


def _submitters(value: object) -> Iterator[Person]:
    for each in value if isinstance(value, list) else ():
        if isinstance(each, dict):
            name, sid, email = (_scalar(each.get(key)) for key in (":name", ":sid", ":email"))
            if id := sid or email or name:
                yield person(id, name, {"SID": sid, "Email": email})


def _scalar(value: object) -> str:
    return value if isinstance(value, str) and value not in ("~", "null") else ""


class Moodle(Layout):
    """Moodle's "Download all submissions", in folders or not.

    Each student's files have the prefix `NAME_NUMBER_assignsubmission_file`, where the number is
    the participant's in this assignment, a group's in one for groups, and is missing for those in
    no group (`mod/assign/classes/downloader.php`; underscores in names become spaces there). Older
    releases end it with an underscore. The zip does not contain the times of submission: its dates
    are those of the download.
    """

    title = msg("what Moodle's “Download all submissions” makes")
    left_out = msg("Left out, since Moodle does not name them so: {names}.")
    _PREFIX: Final = re.compile(
        r"(?P<name>.*?)(?:_(?P<number>\d+))?_assignsubmission_"
        r"(?P<kind>[a-z0-9]+)(?:_(?P<filename>.*))?",
        re.DOTALL,
    )
    _ONLY_TEXT: Final = msg("Only a text was handed in online, and no file.")

    def fits(self, item: Item) -> re.Match[str] | None:
        return self._PREFIX.fullmatch(item.name)

    def attempts(self, items: Sequence[Item], notes: list[Message]) -> list[Attempt]:
        pieces: dict[tuple[str, str], list[Piece]] = {}
        for item, match in ((item, self.fits(item)) for item in items):
            assert match is not None
            filename = match["filename"] or ""
            submitted = pieces.setdefault((match["name"], match["number"] or ""), [])
            if match["kind"] == "file" and not is_junk(filename or "a"):
                submitted.append(Piece(item.path, "" if item.is_folder else filename))
        of_groups = any(not number for _, number in pieces)  # only then are numbers missing
        return [
            Attempt(
                f"{name}_{number}",
                (
                    person(
                        number or name,
                        "" if name == "Participant" else name,
                        # in the form of grading worksheets
                        {"Identifier": "" if of_groups else f"Participant {number}"},
                    ),
                ),
                tuple(found),
                problem=NOTHING if found else self._ONLY_TEXT,
                alone=True,
            )
            for (name, number), found in pieces.items()
        ]


class Canvas(Layout):
    """Canvas's "Download Submissions": files in one folder, with the students in their names.

    `NAME[_LATE]_USER_FILE_FILENAME`, where the name is the sortable one in small letters and
    without what is no letter, USER is the student's id in Canvas, and FILE that of the file.
    Anonymous ones are `[LATE_]anon_CODE_FILE_FILENAME`; a text entered online ends in
    `_USER_text.html`, a link in `_USER_link.html` (`lib/content_zipper.rb`). A file that a student
    hands in again gets `-1`, `-2` before its suffix. The export contains no times.
    """

    title = msg("what Canvas's “Download Submissions” makes")
    left_out = msg("Left out, since Canvas does not name them so: {names}.")
    _NAME: Final = re.compile(
        r"(?:(?P<late>LATE)_)?(?:anon_(?P<code>[A-Za-z0-9]+)|"
        r"(?P<name>.+?)(?:_(?P<late_too>LATE))?_(?P<user>\d+))"
        r"_(?:(?P<file>\d+)_(?P<filename>.+)|(?P<typed>text|link)\.html)",
        re.DOTALL,
    )
    #: `node-2.tar.gz`: the same file handed in again, for the second time.
    _AGAIN: Final = re.compile(r"(?P<stem>.+)-(?P<times>[1-9]\d?)(?P<ending>(?:\.[A-Za-z0-9]+)+)")
    _ONLY_TEXT: Final = msg("Only a text or a link was handed in, and no file.")

    def fits(self, item: Item) -> re.Match[str] | None:
        return None if item.is_folder else self._NAME.fullmatch(item.name)

    def attempts(self, items: Sequence[Item], notes: list[Message]) -> list[Attempt]:
        files: dict[tuple[str, str], list[tuple[Item, str]]] = defaultdict(list)
        people: dict[tuple[str, str], Person] = {}
        for item, match in ((item, self.fits(item)) for item in items):
            assert match is not None
            name, user = match["name"] or "", match["user"] or ""
            whose = (user or match["code"], name)
            columns = {"ID": user} if user else {}
            if match["typed"] and user:  # where there is no file, Canvas's id is read from this
                columns["Exported as"] = item.name
            if match["late"] or match["late_too"]:
                columns["Late"] = "yes"
            people[whose] = person(whose[0], name, columns)
            submitted = files[whose]
            if match["file"] and not is_junk(match["filename"]):
                submitted.append((item, match["filename"]))
        if len({id for id, _ in files}) < len(files):  # a student may be named like that: ann_12
            notes.append(
                msg("Some ids stand there with several names; look at these hand-ins yourself.")
            )
        return [self._attempt("_".join(key), people[key], files[key]) for key in files]

    def _attempt(self, whose: str, student: Person, files: Sequence[tuple[Item, str]]) -> Attempt:
        if files:  # Canvas assigns a feedback file to the student by this
            columns = {**student.columns, "Exported as": files[0][0].name}
            student = replace(student, columns=columns)
        again = [self._AGAIN.fullmatch(name) for _, name in files]
        names = [f"{m['stem']}{m['ending']}" if m else files[at][1] for at, m in enumerate(again)]
        number = 1
        if len(set(names)) == len(names):
            number += max((int(match["times"]) for match in again if match), default=0)
        else:  # part-1.py, part-2.py: the student called them so
            names = [name for _, name in files]
        pieces = tuple(Piece(item.path, name) for (item, _), name in zip(files, names, strict=True))
        problem = NOTHING if pieces else self._ONLY_TEXT
        late = "Late" in student.columns
        return Attempt(whose, (student,), pieces, number, problem=problem, is_marked_late=late)


class Repositories(Layout):
    """A folder of git repositories, as `gh teacher download` and `gh classroom clone` make it.

    Classroom 50 calls them `CLASSROOM-ASSIGNMENT-USER`, GitHub Classroom `ASSIGNMENT-USER`. The
    common prefix, up to a hyphen, is left out; with a roster the user is the longest end of a name
    that is in it. Nothing in a repository is read: anybody can make its commits say any time. `gh
    teacher download` also writes `scores.csv`: who had to hand in something, and when they did
    (`roster.py`).
    """

    title = msg("a folder of git repositories")
    left_out = msg("Left out, since they are no repositories: {names}.")
    _MARKS: Final = (".git", ".classroom50.yml")

    def fits(self, item: Item) -> object:
        return item.is_folder and any((item.path / mark).exists() for mark in self._MARKS)

    def attempts(self, items: Sequence[Item], notes: list[Message]) -> list[Attempt]:
        prefix = ""
        if len(items) > 1:
            names = [item.name for item in items]
            shared = os.path.commonprefix(names)  # noqa: RUF071  of letters: they are no paths
            prefix = shared[: shared.rfind("-") + 1]
        if prefix:
            notes.append(
                msg(
                    "All begin with {prefix}, which is left out of their ids.", prefix=shown(prefix)
                )
            )
        return [_of_repository(item, prefix) for item in items]


def _of_repository(item: Item, prefix: str) -> Attempt:
    user = person(item.name.removeprefix(prefix) or item.name)
    ends = [0, *(at + 1 for at, sign in enumerate(item.name) if sign == "-")]
    keys = tuple(item.name[end:] for end in ends)
    return Attempt(item.name, (user,), (Piece(item.path),), keys=keys)


#: The first that a folder matches is used; a plain folder matches none.
LAYOUTS: Final[tuple[Layout, ...]] = (Gradescope(), Moodle(), Canvas(), Repositories())
