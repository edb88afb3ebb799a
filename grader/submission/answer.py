"""What an inspection answers: what set-ups install, and what a package would launch.

It is asked before anything of a package is started, and comes from a process in which a stranger's
code ran: a claim, which whoever uses it holds against the files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grader.submission import package_trace
from grader.submission.package_trace import LaunchFile, Obstacle, PackageTrace
from grader.submission.program import Program


@dataclass(frozen=True)
class DataFiles:
    """Files, and the folder that they come into."""

    folder: str
    files: tuple[str, ...]


@dataclass(frozen=True)
class SetUpFacts:
    """What a set-up says.

    Attributes:
        name: of the package; '' where it gives none.
        data_files: what it installs beside Python's packages.
        scripts: lines such as 'talker = pkg.talker:main'.
        plain_scripts: files that are programs.
        packages: Python's; None where nothing lists them.
        package_folders: where they lie, as 'NAME=FOLDER'; without a name, all others.
        scripts_folder: where programs are installed, without `$base/`; '' where nothing says so.
        has_commands: whether classes of its own install it.
    """

    name: str = ""
    data_files: tuple[DataFiles, ...] = ()
    scripts: tuple[str, ...] = ()
    plain_scripts: tuple[str, ...] = ()
    packages: tuple[str, ...] | None = None
    package_folders: tuple[str, ...] = ()
    scripts_folder: str = ""
    has_commands: bool = False


@dataclass(frozen=True)
class SetUp:
    """The set-up files of one folder.

    Attributes:
        folder: where they lie in what was handed in; '.' for its top.
        problem: what ended their evaluation; None where it came to its end.
        installed: path below the prefix -> file of the folder, as far as both are known.
    """

    folder: str
    told: SetUpFacts = field(default_factory=SetUpFacts)
    problem: Obstacle | None = None
    installed: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class LaunchOrder:
    """What a launch file starts, and when.

    Attributes:
        path: of the file, in what was handed in.
        programs: in the order in which it starts them; a script that a command runs is a path in
            what was handed in.
        included: the submission's own launch files that it includes.
        ignored: actions and options that are not followed, by their names.
    """

    path: str = ""
    programs: tuple[Program, ...] = ()
    included: tuple[str, ...] = ()
    ignored: tuple[str, ...] = ()


@dataclass(frozen=True)
class Inspection:
    """All of it.

    Attributes:
        set_ups: in the order in which they were asked for.
        package: the folder of the package that is likely to be started; '' for none.
        trace: what was found of that package; its launch files at least.
        launches: of this package, and of those beside it.
        orders: of those that came to their end, by their names.
    """

    set_ups: tuple[SetUp, ...] = ()
    package: str = ""
    trace: PackageTrace = field(default_factory=PackageTrace)
    launches: tuple[LaunchFile, ...] = ()
    orders: Mapping[str, LaunchOrder] = field(default_factory=dict)


def decode(data: bytes) -> Inspection:
    """The inspection that bytes mean."""
    made = package_trace.read(Inspection, data)
    package_trace.must_agree(made.trace)
    return made
