"""Packages as nobody hands them in: real ones with lines, names, sizes and links as they fall.

`packages` is a strategy of Hypothesis. What it draws is a list of changes to one of the packages
that there are, so that a failing case is shrunk to the one line that matters.
"""

from __future__ import annotations

import os
import shutil
import socket
import stat
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hypothesis import strategies as st

from grader.exercise.loading import load_exercise
from grader.testing.solutions import read_solutions
from tests.grader_robots.packages import FOLDER

_INSTALLED = ("description_package", "thymio_package", "state_publisher")
#: Whole packages that are right, each a folder.
BASES = (
    *(read_solutions(load_exercise(name))[0].path for name in _INSTALLED),
    *(FOLDER / name for name in ("r2d2_tutorial", "urdf_to_package")),
)


#: A file beside a package, to which links lead.
OUTSIDE, SAYS = "outside.yaml", "name: outside\n"


@dataclass(frozen=True)
class Change:
    """One change to a package, by a function of this module; numbers are counted around."""

    kind: str
    file: int
    line: int
    other: int  # what else the kind needs to choose
    text: str
    end: str  # how the names of files end that it is for


@dataclass(frozen=True)
class Mangled:
    base: int
    changes: tuple[Change, ...]

    def lay_out(self, folder: Path) -> Path:
        """Make it; where it lies. What lies outside, beside it, is never written to."""
        base = BASES[self.base]
        root = folder / base.name
        (folder / OUTSIDE).write_text(SAYS, encoding="ascii")
        shutil.copytree(base, root, ignore=shutil.ignore_patterns("__pycache__"))
        for change in self.changes:
            files = sorted(each for each in root.rglob("*") if _is_plain(each))
            fitting = [each for each in files if each.name.endswith(change.end)] or files
            if fitting:
                _KINDS[change.kind](fitting[change.file % len(fitting)], change, files)
        return root


def _is_plain(path: Path) -> bool:
    """Whether writing to it writes to it, and to nothing that it leads to."""
    return stat.S_ISREG(path.lstat().st_mode)


# Kinds of changes ---------------------------------------------------------------------------------


def _with_lines(path: Path, change: Callable[[list[bytes]], None]) -> None:
    lines = path.read_bytes().split(b"\n")
    change(lines)
    path.write_bytes(b"\n".join(lines))


def _dropped(path: Path, change: Change, _: list[Path]) -> None:
    _with_lines(path, lambda lines: lines.__delitem__(change.line % len(lines)))


def _doubled(path: Path, change: Change, _: list[Path]) -> None:
    _with_lines(path, lambda lines: lines.insert(at := change.line % len(lines), lines[at]))


def _swapped(path: Path, change: Change, files: list[Path]) -> None:
    """A line of another file, or of the same, in the place of one."""
    beside = files[change.other % len(files)].read_bytes().split(b"\n")
    taken = beside[change.other % len(beside)]
    _with_lines(path, lambda lines: lines.__setitem__(change.line % len(lines), taken))


def _added(path: Path, change: Change, files: list[Path]) -> None:
    text = change.text.encode("utf-8", "surrogatepass")
    _with_lines(path, lambda lines: lines.insert(change.line % (len(lines) + 1), text))


def _written(path: Path, change: Change, _: list[Path]) -> None:
    path.write_bytes(change.text.encode("utf-8", "surrogatepass"))


def _word(path: Path, change: Change, _: list[Path]) -> None:
    """Another word in the place of one between quotes."""
    parts = path.read_bytes().split(b'"')
    if len(parts) > 2:
        at = 1 + 2 * (change.line % (len(parts) // 2))
        parts[at] = change.text.encode("utf-8", "surrogatepass")
        path.write_bytes(b'"'.join(parts))


def _renamed(path: Path, change: Change, _: list[Path]) -> None:
    names = (
        *(b"a" * 255, b"two\nlines.launch.py", b"\xff\xfe.urdf", b"-rf.xacro", b" .stl", b"**"),
        *("ü.launch.py".encode(), b"CMakeLists.txt", b"setup.py", b"package.xml", b"${X}.xacro"),
        *(b"launch.xml", b"__init__.py", b"con", b"*.launch.yaml", b"%s.urdf", b"'\".xml"),
    )
    path.replace(path.parent / os.fsdecode(names[change.other % len(names)]))


def _resized(path: Path, change: Change, _: list[Path]) -> None:
    data = path.read_bytes()
    sizes = (b"", data[: change.line % (len(data) + 1)], data * 3, b"a" * 2_000_000, b"\n" * 90_000)
    path.write_bytes(sizes[change.other % len(sizes)])


def _encoded(path: Path, change: Change, _: list[Path]) -> None:
    data = path.read_bytes()
    text = data.decode("utf-8", "replace")
    at = change.line % (len(data) + 1)
    kinds = (
        text.encode("utf-16"),
        b"\xef\xbb\xbf" + data,
        text.encode("utf-32"),
        data[:at] + b"\0" + data[at:],
        data[:at] + b"\xff\xfe" + data[at:],
        data.replace(b"utf-8", b"no-such-code"),
        data.replace(b"\n", b"\r"),
    )
    path.write_bytes(kinds[change.other % len(kinds)])


def _nested(path: Path, change: Change, _: list[Path]) -> None:
    if path.suffix in (".xml", ".xacro", ".urdf"):
        depth = (10, 300, 5000)[change.other % 3]
        data = path.read_bytes()
        path.write_bytes(data.replace(b"</", b"<a>" * depth + b"</a>" * depth + b"</", 1))
        return
    folder = path.parent
    for _number in range(300):
        folder = folder / "d"
    folder.mkdir(parents=True, exist_ok=True)
    path.replace(folder / path.name)


def _linked(path: Path, change: Change, files: list[Path]) -> None:
    other = files[change.line % len(files)]
    path.unlink()
    match change.other % 9:
        case 0:
            path.symlink_to(path.name)
        case 1:
            path.symlink_to("..")
        case 2:
            path.symlink_to(
                next(each for each in path.parents if (each / OUTSIDE).exists()) / OUTSIDE
            )
        case 3:
            path.symlink_to("nothing/there")
        case 4:
            path.symlink_to("/dev/zero")
        case 5 if other.exists():
            os.link(other, path)
        case 6:
            os.mkfifo(path)
        case 7:
            path.mkdir()
        case _:
            _bind_a_socket(path)


def _bind_a_socket(path: Path) -> None:
    before = os.open(".", os.O_RDONLY)
    os.chdir(path.parent)  # a socket's path is short
    try:
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(path.name[:90])
    finally:
        os.fchdir(before)
        os.close(before)


_KINDS: dict[str, Callable[[Path, Change, list[Path]], None]] = {
    each.__name__: each
    for each in (
        *(_dropped, _doubled, _swapped, _added, _written, _word, _renamed, _resized, _encoded),
        *(_nested, _linked),
    )
}

# A grammar of each kind of file -------------------------------------------------------------------


def _listed(words: str) -> list[str]:
    return words.split()


_WORDS = _listed(r"""
. .. / ./ ** meshes/**.stl *** * [ [! ${ ${X} ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_NAME} a;b urdf
$<BUILD_INTERFACE:a> urdf/ launch share/${PROJECT_NAME} share/a /share ../../../etc ~ - package.xml
setup.py package:// package://a/b.stl file:///dev/zero $( $) $(dirname)/a ü 1e999 nan -0 0x ' " \ <
& &amp; &a; ]]> <!-- % {} {0}
""")
_SUBSTITUTIONS = (
    *("$(find-pkg-share a)", "$(find a)", "$(arg a)", "$(eval 1/0)", "$(var x)", "$(env HOME)"),
    "$(command 'xacro a')",
)
_ODD = ("", " ", "\0", "\ud800", "\u202e", "9" * 400, "a" * 300, "a" * 2500, "a/" * 2000)
_ALL = [*_WORDS, *_SUBSTITUTIONS, *_ODD]
words = st.integers(0, len(_ALL) - 1).map(lambda n: _ALL[n])  # not to be shown as a whole
_KEYS = _listed("""
GLOB GLOB_RECURSE RELATIVE CONFIGURE_DEPENDS DESTINATION FILES PATTERN DIRECTORY PROGRAMS TARGETS
EXCLUDE FILES_MATCHING RENAME IN LISTS
""")
_some = st.lists(words, min_size=1, max_size=3).map(" ".join)
_cmake = st.one_of(
    st.builds("file({} found {})".format, st.sampled_from(["GLOB", "GLOB_RECURSE"]), _some),
    st.builds(
        "install({} {} DESTINATION {})".format,
        st.sampled_from(["FILES", "DIRECTORY", "PROGRAMS", "TARGETS"]),
        _some | st.just("${found}"),
        words,
    ),
    st.builds("set(found {})\nforeach(X IN LISTS found)".format, _some),
    st.builds(
        "{}({})".format,
        st.sampled_from(_listed("file install set foreach endforeach if endif project")),
        st.lists(words | st.sampled_from(_KEYS), max_size=6).map(" ".join),
    ),
)
_values = st.recursive(
    words.map(repr) | st.sampled_from(["None", "0", "-1", "1.5", "b'a'", "object()", "...", "[]"]),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4).map(lambda each: f"[{', '.join(each)}]"),
        st.lists(inner, max_size=3).map(lambda each: f"({', '.join([*each, ''])})"),
        st.builds("{{{}: {}}}".format, words.map(repr), inner),
        inner.map("glob({})".format),
        inner.map("str({})".format),
        st.builds("{} + {}".format, inner, inner),
    ),
    max_leaves=8,
)
_setup = st.builds(
    "    {}={},".format,
    st.sampled_from(["data_files", "scripts", "packages", "name", "entry_points", "version", "x"]),
    _values,
)
_python = st.builds(
    "{}{}".format,
    st.sampled_from(["", "    ", "        "]),
    st.one_of(
        st.builds("x = {}".format, _values),
        st.builds("Node(package={}, executable={}),".format, _values, _values),
        st.builds("return {}".format, _values),
        st.builds("raise SystemExit({})".format, _values),
        st.builds("import {}".format, st.sampled_from(["nothing", "os as sys", "launch.x", "."])),
        st.just("def generate_launch_description(): return generate_launch_description()"),
        st.just("class E(Exception): __str__ = None\nraise E"),
        st.just("class E(Exception):\n  def __str__(self): raise self\nraise E"),
        st.just("raise BaseExceptionGroup('a', [KeyboardInterrupt()])"),
    ),
)
_TAGS = _listed("""
name export build_type depend node param arg include group let launch robot link joint mesh origin
xacro:include xacro:macro xacro:property xacro:if xacro:arg visual geometry material a
""")
_ATTRIBUTES = _listed("""
name filename file pkg exec value if unless default type xyz from ns args link version format to
""")
_xml = st.builds(
    lambda tag, attributes, end: f"<{tag} {' '.join(attributes)}{end}",
    st.sampled_from(_TAGS),
    st.lists(st.builds('{}="{}"'.format, st.sampled_from(_ATTRIBUTES), words), max_size=4),
    st.sampled_from(["/>", ">", "></a>"]),
)
_SETUP = """from glob import glob
from setuptools import find_packages, setup
setup(name={0}, packages=find_packages(), data_files={1}, scripts={2}, entry_points={3})
"""
_LAUNCH = """from glob import glob
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, IncludeLaunchDescription
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("a", default_value={0}),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": Command({1})}}, {2}], arguments={3}),
        Node(package={2}, executable={3}, name=LaunchConfiguration("a"), condition={0}),
        ExecuteProcess(cmd={2}), IncludeLaunchDescription({3}, launch_arguments={1}),
        PathJoinSubstitution({2}),
    ])
"""
_ROBOT = "<robot name='a' xmlns:xacro='http://www.ros.org/wiki/xacro'>{}</robot>"
_element = st.recursive(
    _xml,
    lambda inner: st.builds(
        lambda tag, within: f"<{tag}>{''.join(within)}</{tag}>",
        st.sampled_from(_TAGS),
        st.lists(inner, max_size=4),
    ),
    max_leaves=6,
)
#: How the names of files end -> lines for them, and what they may be as a whole.
_GRAMMARS: dict[str, tuple[st.SearchStrategy[str], st.SearchStrategy[str]]] = {
    "CMakeLists.txt": (_cmake, st.lists(_cmake, max_size=8).map("\n".join)),
    "setup.py": (_setup, st.builds(_SETUP.format, words.map(repr), _values, _values, _values)),
    "launch.py": (_python, st.builds(_LAUNCH.format, _values, _values, _values, _values)),
    "launch.xml": (_xml, _element.map("<launch>{}</launch>".format)),
    "package.xml": (_xml, _element.map("<package format='3'>{}</package>".format)),
    ".xacro": (_xml, _element.map(_ROBOT.format)),
    ".urdf": (_xml, _element.map(_ROBOT.format)),
}


@st.composite
def packages(draw: st.DrawFn) -> Mangled:
    """A package with up to six changes, half of them from its files' grammars."""
    base = draw(st.integers(0, len(BASES) - 1))
    names = [each.name for each in BASES[base].rglob("*") if each.is_file()]
    fitting = [end for end in _GRAMMARS if any(name.endswith(end) for name in names)]
    numbers = st.integers(0, 300)
    added = st.tuples(st.sampled_from(fitting), st.integers(0, 1)).flatmap(
        lambda which: st.builds(
            Change,
            st.just(("_added", "_written")[which[1]]),
            *(numbers, numbers, numbers),
            _GRAMMARS[which[0]][which[1]],
            st.just(which[0]),
        )
    )
    others = st.builds(
        Change, st.sampled_from(sorted(_KINDS)), numbers, numbers, numbers, words, st.just("")
    )
    return Mangled(base, tuple(draw(st.lists(added | others, min_size=1, max_size=6))))
