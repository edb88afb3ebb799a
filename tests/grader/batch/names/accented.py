"""A class with a student of an accented name wherever a name can be, and a search for it."""

from __future__ import annotations

import hashlib
import json
import re
import unicodedata
import zipfile
from collections.abc import Iterator
from html.entities import codepoint2name
from pathlib import Path
from urllib.parse import quote

from grader.recording import bag
from grader.reports.csv import table
from tests.grader.batch.classes import ROOT

AT = "2026-11-01T12:00Z"
ZOE, GROUPED, ZOE_ID = "Zoë Müller", "Jürgen Größe", "zm4711"
CONTROLLER = (ROOT / "tests" / "submissions" / "square_controller.py").read_text(encoding="utf-8")

PACKAGE = """<package format="3">
  <name>{folder}</name>
  <version>0.0.1</version>
  <description>by {name}</description>
  <maintainer email="{login}@uni.example">{name}</maintainer>
  <author>
    {name}
  </author>
  <license>MIT</license>
  <export><build_type>ament_python</build_type></export>
</package>
"""
SETUP = """from setuptools import setup

setup(
    name="{folder}",
    version="0.0.1",
    packages=["{folder}"],
    maintainer="{name}",
    maintainer_email="{login}@uni.example",
    author="{nick}",
    entry_points={{"console_scripts": ["square = {folder}.{module}:main"]}},
)
"""
#: The node tells its author's name as programs do: printed, escaped, in names and in messages.
SAYS = """
import html, json, unicodedata, urllib.parse
from std_msgs.msg import String

NAME = "{name}"


def tell(node):
    for text in (NAME, unicodedata.normalize("NFD", NAME), json.dumps(NAME), NAME.upper()):
        print(text, flush=True)
    print(urllib.parse.quote(NAME), html.escape(NAME).encode("ascii", "xmlcharrefreplace"))
    print(NAME.encode("utf-8"), "written by {nick} <{login}@uni.example>", __file__)
    node.get_logger().info(f"hello from {{NAME}}")
    node.told = node.create_publisher(String, "/{ascii}_says", 1)
    node.told.publish(String(data=NAME))
"""


def ascii_of(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name.replace("ß", "ss"))
    return "".join(c for c in plain if c.isascii() and c != " ").lower()


def nick_of(name: str) -> str:
    return f"night{ascii_of(name)[::-1]}77"


def package(into: Path, name: str, more: str = "") -> None:
    """Write a hand-in with the name of its author in all that one can write it into."""
    first = ascii_of(name.split()[0])
    words = {"name": name, "login": ascii_of(name), "ascii": first}
    words |= {"folder": f"{first}_square", "module": f"{ascii_of(name)}_node"}
    words["nick"] = nick_of(name)
    inside = into / words["folder"]
    inside.mkdir(parents=True)
    (into / "package.xml").write_text(PACKAGE.format(**words), "utf-8")
    (into / "setup.py").write_text(SETUP.format(**words), "utf-8")
    (into / "resource").mkdir()
    (into / "resource" / words["folder"]).touch()
    (inside / "__init__.py").touch()
    made = "        self.corners = None\n"
    text = CONTROLLER.replace(made, f"{made}        tell(self)\n", 1)
    text = text.replace('super().__init__("square")', f'super().__init__("{first}_square")')
    text = text.replace("SIDE = 2.0", SAYS.format(**words) + "\n\nSIDE = 2.0")
    (inside / f"{words['module']}.py").write_text(f"# by {name}\n{more}{text}", "utf-8")
    notes = into / f"{unicodedata.normalize('NFD', name)}.txt"
    notes.write_text(f"author: {name}\n", "utf-8")
    git = into / ".git"
    (git / "logs").mkdir(parents=True)
    config = f"[user]\n\tname = {name}\n\temail = {words['login']}@uni.example\n"
    (git / "config").write_text(config, "utf-8")
    log = f"{'0' * 40} {'0' * 40} {name} <{words['nick']}@home.example> 1 +0100\tcommit\n"
    (git / "logs" / "HEAD").write_text(log, "utf-8")


#: id, name, group, number in Moodle, handed in
MEMBERS = (
    (ZOE_ID, ZOE, "", "101"),
    ("bs4712", "Bob Sternberg", "", "102"),
    ("cw4713", "Carla Weiss", "", "103"),
    ("dk4714", "Dan Kowalski", "Team Nord", "104"),
    ("jg4715", GROUPED, "Team Nord", "105"),
    ("ef4716", "Eve Fontaine", "", "106"),
)


def hand_in(folder: Path) -> None:
    """Write the export of a course system, and its roster."""
    folder.mkdir(parents=True)
    columns = ("Identifier", "ID number", "Full name", "Email address", "Group", "at")
    rows = [
        (f"Participant {number}", id, name, f"{ascii_of(name)}@uni.example", group, AT)
        for id, name, group, number in MEMBERS
    ]
    (folder / "roster.csv").write_text(table([columns, *rows]), "utf-8")

    def place(name: str, number: str) -> Path:
        decomposed = unicodedata.normalize("NFD", name)
        return folder / f"{decomposed}_{number}_assignsubmission_file"

    package(place(ZOE, "101"), ZOE)
    package(place("Bob Sternberg", "102"), ZOE)  # the same files
    package(place("Carla Weiss", "103"), GROUPED, f"# thanks to {ZOE}\n")
    package(place("Team Nord", "200"), GROUPED, f"# thanks to {ZOE}\n")


# The search -------------------------------------------------------------------------------------


def forms_of(name: str, *ids: str) -> list[bytes]:
    """All that a search for a student looks for: names, parts, spellings, escapes, hashes."""
    parts = [name, *name.split(), *ids]
    plain = [ascii_of(part) for part in parts]
    two = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss"})
    german = [part.translate(two) for part in parts]
    found: set[bytes] = set()
    for text in {*parts, *plain, *german, name.upper(), name.lower()}:
        for form in ("NFC", "NFD"):
            spelled = unicodedata.normalize(form, text)
            data = spelled.encode()
            escaped = (quote(spelled), json.dumps(spelled)[1:-1], repr(data)[2:-1])
            html_ones = spelled.encode("ascii", "xmlcharrefreplace").decode()
            named = "".join(map(named_in_html, spelled))
            found |= {data, *(each.encode() for each in (*escaped, html_ones, named))}
            for algorithm in ("md5", "sha1", "sha256"):
                digest = hashlib.new(algorithm, data).hexdigest()
                found |= {digest.encode(), digest[:8].encode()}
    return sorted({each.lower() for each in found if len(each) > 2})


def named_in_html(sign: str) -> str:
    name = codepoint2name.get(ord(sign))
    return f"&{name};" if name and not sign.isascii() else sign


#: Pictures in a page: any three letters occur in so many characters.
BASE64 = re.compile(rb"base64,[A-Za-z0-9+/=]+")
#: As few letters as that are found in packed bytes by chance.
BY_CHANCE = 5


def found_in(folder: Path, looked_for: list[bytes]) -> dict[str, list[bytes]]:
    """Which files of a folder have something in their names or contents, packed ones too."""
    hits: dict[str, list[bytes]] = {}
    known: dict[int, list[bytes]] = {}  # by inode: recordings are linked into several folders
    long = [each for each in looked_for if len(each) > BY_CHANCE]
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        there = [each for each in looked_for if each in name.lower().encode()]
        if path.is_file():
            inode = path.stat().st_ino
            if inode not in known:
                data = BASE64.sub(b"", b"\n".join(contents(path)).lower())
                raw = path.read_bytes().lower()
                found = {each for each in looked_for if each in data}
                known[inode] = sorted(found.union(each for each in long if each in raw))
            there += known[inode]
        if there:
            hits[name] = there
    return hits


def contents(path: Path) -> Iterator[bytes]:
    if path.suffix == ".zip":
        with zipfile.ZipFile(path) as archive:
            for member in archive.namelist():
                yield member.encode()
                yield archive.read(member)
    elif path.suffix == ".mcap":
        for channel in bag.read_channels(path):
            yield f"{channel.topic} {channel.msgtype}".encode()
            if not channel.msgtype.endswith("/Image"):  # two megabytes each, of pixels
                yield from channel.messages()
    elif path.suffix != ".png":
        yield path.read_bytes()
