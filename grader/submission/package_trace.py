"""What looking at a package leaves: what it installs, what its launch files describe, its URDFs.

All of it comes from a process in which a stranger's code ran, and is evidence about that stranger's
package alone. Paths are those of the package, or begin with `/prefix`, where it was laid out as if
installed; what belongs to nobody's package is told as it is.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Annotated, ClassVar, Self

from grader.system.strict_json import STRANGERS, Made, from_json, to_json
from grader.text import strings
from grader.text.message import Message, msg

#: A description may have so many characters; all of a trace so many bytes.
LONGEST_TEXT = 2_000_000
MOST_BYTES = 16_000_000
#: A surface in base64: 2000 triangles.
LONGEST_SURFACE = 96_000
#: How the process that looks ends where it fails itself, rather than the package [exit code].
FAILED = 70
#: Where a package is laid out, in the paths of a trace.
PREFIX = "/prefix"
#: Where the packages of ROS are said to be, and the current folder of who launches.
ROS, EMPTY = "/opt/ros/jazzy", "/somewhere"


def shown(content: str) -> str:
    """A text of the submission's as it may stand in a sentence."""
    return strings.shown(content).rstrip(".")


@dataclass(frozen=True)
class Obstacle:
    """Something that ended an evaluation.

    Attributes:
        kind: `error` - what the package's own code raised; `limit` - it took too much;
            `argument` - a launch argument without a default; `unknown` - it uses what the grader
            does not know, which is no fault of the package.
        text: in a line.
        file, line: in the package's own files; '' and 0 where that is not known.
    """

    kind: str
    text: Message
    file: str = ""
    line: int = 0

    @property
    def described(self) -> Message:
        """What it says, in a sentence."""
        return self.text.map_texts(shown)

    @property
    def place(self) -> str | Message:
        """' (launch/display.launch.py, line 9)', with a blank before it; '' for no place."""
        if not self.file:
            return ""
        if not self.line:
            return f" ({self.file})"
        return msg(" ({file}, line {line})", file=self.file, line=self.line)

    def ends(self, file: str) -> Message:
        """'setup.py ends with NameError: ... (setup.py, line 3)', '... did not come to an end ...'.

        Args:
            file: whose evaluation it ended.
        """
        what = self.text.values.get("what")
        if self.kind == "limit" and isinstance(what, Message):
            return msg("{file} {what}", file=file, what=what.map_texts(shown))
        return msg(
            "{file} ends with {error}{place}", file=file, error=self.described, place=self.place
        )


@dataclass(frozen=True)
class InstalledScript:
    """A console script.

    Attributes:
        fault: why it could not be started, as what follows its name; nothing where it could.
        source: the file that it starts; '' for none.
        says: whether that file speaks of joint states.
    """

    name: str
    module: str
    function: str
    fault: Message
    source: str
    says: bool


@dataclass(frozen=True)
class Lacking:
    """Something that is named and not there.

    Attributes:
        kind: `file`, `package` or `executable`.
        name: as it was asked for: a path, a package, or package and program.
        source: the package's own file that was meant, as far as one is called the same; '' for
            none.
        by: the file that names it; '' where that is not known.
        line: of that file, which alone has the last part of the name; 0 where that is not known.
    """

    kind: str
    name: str
    source: str
    by: str
    line: int = 0


@dataclass(frozen=True)
class Setup:
    """What the package says of itself, and installs.

    Attributes:
        name: of the package, by package.xml; by its set-up where that says none.
        told: the name that the set-up gives, setup() or project(); '' where it gives none.
        folder: where it lies in what was handed in; '' for its top.
        build_type: "ament_python", "ament_cmake", ...; '' where none is told.
        manifest: what is wrong with package.xml, if anything.
        depends: all packages that it names as dependencies, of whatever kind; with those of the
            packages beside it, where these have the launch files and it has none.
        problem: what ended its setup.py; None where it came to its end.
        absent: what it lists to be installed, and is not there.
        folders: folders that it lists as if they were files.
        scripts: its console scripts.
        scripts_folder: where these are installed, as 'lib/NAME'.
        installed: the files below the prefix: 'share/NAME/urdf/a.urdf'.
        sources: of each of these, the file that it is of.
        left: files of urdf, meshes, launch, rviz, ... that nothing installs.
    """

    name: str
    told: str
    folder: str
    build_type: str
    manifest: Message
    depends: tuple[str, ...]
    problem: Obstacle | None
    absent: tuple[str, ...]
    folders: tuple[str, ...]
    scripts: tuple[InstalledScript, ...]
    scripts_folder: str
    installed: tuple[str, ...]
    sources: tuple[str, ...]
    left: tuple[str, ...]

    @property
    def file(self) -> str:
        """What installs its files."""
        is_python = self.build_type in ("", "ament_python")
        return "setup.py" if is_python else "CMakeLists.txt"

    @property
    def place(self) -> str:
        """Where that file lists them."""
        return "data_files" if self.file == "setup.py" else "install(DIRECTORY launch …)"

    @property
    def programs(self) -> list[str]:
        """The names of the programs that it installs for `ros2 run`, sorted."""
        below = f"lib/{self.name}/"
        files = (path.removeprefix(below) for path in self.installed if path.startswith(below))
        return sorted({*(script.name for script in self.scripts), *files})


@dataclass(frozen=True)
class Parameter:
    """A parameter of a launched node.

    Attributes:
        value: as YAML writes it, in a line; '' for a text that is long.
        text: the number of the text that it is; -1 for all that is short.
        wrapped: whether it was said to be a text (ParameterValue, value_type=str), or is one.
    """

    name: str
    value: str
    text: int
    wrapped: bool


@dataclass(frozen=True)
class LaunchedNode:
    """A node that a launch file starts.

    Attributes:
        later: whether it starts only when something else happens.
        file, line: where a launch file says so; 0 where the line is not known.
        condition: on which, in words; '' for none of its own.
    """

    package: str
    executable: str
    name: str
    namespace: str
    arguments: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    remappings: tuple[str, ...]
    later: bool
    file: str = ""
    line: int = 0
    condition: str = ""


@dataclass(frozen=True)
class Skipped:
    """A node that a launch file does not start with its default arguments; see `LaunchedNode`."""

    package: str
    executable: str
    file: str
    line: int
    condition: str


@dataclass(frozen=True)
class Include:
    """A launch file of another package that is included: its package, path in it, and arguments."""

    package: str
    file: str
    arguments: tuple[str, ...]


@dataclass(frozen=True)
class LaunchFile:
    """A launch file, evaluated.

    Attributes:
        file: its source in the package; 'NAME/FILE' for one of a package beside it.
        problem: what ended it; None where it came to its end.
        nodes, processes, includes: what it starts, with its default arguments.
        declared: the names of its arguments.
        packages: other packages that it asks for.
        lacking: what it names and is not there.
        remarks: what works, and need not.
        moved: what is otherwise where the package is installed in another place; '' for nothing.
        skipped: nodes whose own condition is not met.
    """

    file: str
    problem: Obstacle | None
    nodes: tuple[LaunchedNode, ...] = ()
    processes: tuple[str, ...] = ()
    includes: tuple[Include, ...] = ()
    declared: tuple[str, ...] = ()
    packages: tuple[str, ...] = ()
    lacking: tuple[Lacking, ...] = ()
    remarks: tuple[Message, ...] = ()
    moved: str = ""
    skipped: tuple[Skipped, ...] = ()


@dataclass(frozen=True)
class NamedMesh:
    """A file that a description names.

    Attributes:
        state: `found`; `left` - it is in the package, and nothing installs it there; `missing`;
            `case` - there is one in other letters; `foreign` - of another package, whose files
            nobody knows here; `package` - of a package that is not there; `scheme` - no viewer
            resolves such a name.
        path: what was looked for; of `case` and `left`, what is there.
        is_mesh: whether it is a mesh, and no texture.
        surface: the number of its triangles among the surfaces; -1 where nobody has read them.
    """

    uri: str
    state: str
    path: str
    is_mesh: bool
    surface: int = -1


@dataclass(frozen=True)
class Description:
    """A robot's description.

    Attributes:
        text: its number among the texts.
        by: the launch file that hands it to a robot_state_publisher, or the file that it is from.
        is_launched: whether a launch file hands it to one.
        source: the URDF or xacro that it is from, as far as that is known.
        problem: why there is none, of a file that no launch file uses.
        meshes: the files that it names.
        is_xml: whether it can be read for these.
    """

    text: int
    by: str
    is_launched: bool
    source: str
    problem: Obstacle | None
    meshes: tuple[NamedMesh, ...]
    is_xml: bool


@dataclass(frozen=True)
class Varied:
    """A description with one number of its xacro doubled.

    Attributes:
        of: the number of the description among the descriptions.
        name: of the property or argument.
        text: among the texts; -1 where xacro refused it.
    """

    of: int
    name: str
    text: int


@dataclass(frozen=True)
class PackageTrace:
    """A package that was looked at; no clock ran.

    Attributes:
        setup: of the package that is judged; None where nobody got so far.
        others: the names of packages beside it in what was handed in.
        launches: its launch files.
        descriptions: the robots that it describes.
        varied: with other numbers.
        texts: what the numbers of texts stand for.
        surfaces: of meshes, for pictures: nine float32 for each triangle, in base64.
    """

    duration_ns: ClassVar = 0
    ticks: ClassVar = 0

    setup: Setup | None = None
    others: tuple[str, ...] = ()
    launches: tuple[LaunchFile, ...] = ()
    descriptions: tuple[Description, ...] = ()
    varied: tuple[Varied, ...] = ()
    texts: Annotated[tuple[str, ...], STRANGERS._replace(characters=LONGEST_TEXT)] = ()
    surfaces: Annotated[tuple[str, ...], STRANGERS._replace(characters=LONGEST_SURFACE)] = ()

    @classmethod
    def of(cls, trace: object) -> Self:
        """A recording's trace as what it is.

        Raises:
            TypeError: it is another scene's.
        """
        if not isinstance(trace, cls):
            raise TypeError(f"expected a trace of a package, found a {type(trace).__name__}")
        return trace

    def sha256(self) -> str:
        """A hash of all of it; equal hashes mean equal findings."""
        data = to_json(self, STRANGERS._replace(write=str))  # sentences in English
        return hashlib.sha256(json.dumps(data, sort_keys=True).encode("ascii")).hexdigest()


def encode(made: object) -> bytes:
    """Serialise a trace, or what holds one, as JSON; equal ones give the same bytes."""
    return json.dumps(to_json(made), sort_keys=True).encode("ascii")


def decode(data: bytes) -> PackageTrace:
    """The trace that bytes mean."""
    trace = read(PackageTrace, data)
    must_agree(trace)
    return trace


def read(kind: type[Made], data: bytes) -> Made:
    """The dataclass that bytes mean."""
    if len(data) > MOST_BYTES:
        raise ValueError(f"a trace of {len(data)} bytes; expected {MOST_BYTES} at most")
    try:
        return from_json(kind, json.loads(data.decode("ascii")))
    except (TypeError, LookupError, RecursionError) as error:
        raise ValueError(f"no trace of a package: {type(error).__name__}: {error}") from None


def must_agree(trace: PackageTrace) -> None:
    """Numbers of texts are of texts that there are."""
    values = (p for launch in trace.launches for node in launch.nodes for p in node.parameters)
    numbers = [
        *(each.text for each in values),
        *(each.text for each in trace.descriptions),
        *(each.text for each in trace.varied),
    ]
    if any(not -1 <= number < len(trace.texts) for number in numbers):
        raise ValueError("it names a text that is not there")
    meshes = (mesh for each in trace.descriptions for mesh in each.meshes)
    if any(not -1 <= each.surface < len(trace.surfaces) for each in meshes):
        raise ValueError("it names a surface that is not there")
    if any(not 0 <= each.of < len(trace.descriptions) for each in trace.varied):
        raise ValueError("it names a description that is not there")
    if trace.setup and len(trace.setup.installed) != len(trace.setup.sources):
        raise ValueError("installed files and their sources are not equally many")
