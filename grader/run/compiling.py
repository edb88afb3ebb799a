"""Compiles interfaces for a run in real time, where DDS itself carries their messages.

The generators of ROS and a compiler work in a process that is confined as a submission's is, and
what it leaves is decoded strictly. It is kept for later runs, in a folder that submissions cannot
write into; where nothing keeps them from it, for one run.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import shutil
import sys
import sysconfig
import threading
from collections.abc import Mapping
from contextlib import suppress
from importlib import metadata
from pathlib import Path
from typing import Final

from grader.errors import GraderFailure
from grader.recording.recording import OwnInterfaces
from grader.ros import compiler
from grader.run import handover, run_context
from grader.run.limits import CpuBudget
from grader.run.run_context import RunContext
from grader.run.sandbox.confinement import LANDLOCK, NAMESPACES
from grader.submission.start import Submission
from grader.system import scratch, strict_json
from grader.system.removal import remove
from grader.text.message import NOTHING, msg

#: The program that compiles.
PROGRAM: Final = Path(compiler.__file__).with_name("building.py")
#: Its processor time, and how long it may take on a busy machine [s].
CPU_S, LONGEST_S = 120.0, 900.0
#: What it leaves [bytes].
BUILT_BYTES: Final = 32_000_000
#: So many sets of interfaces are kept: those used last.
MOST_KEPT: Final = 100
#: Why nothing was run.
NOT_COMPILED: Final = msg(
    "in real time the interfaces of {packages} have to be compiled, and {why}. In virtual time "
    "they need not: have one program graded, without --time real, and take out what virtual time "
    "cannot follow, which a remark names"
)
UNLIKE: Final = msg(
    "they are not the exercise's, so that DDS would take the messages of one for those of the "
    "other: {difference}"
)
_MODULE: Final = re.compile(r"([a-z][a-z0-9_]*)/((msg|srv|action)/)?_*[a-z][a-z0-9_]*\.py")
_lock: Final = threading.Lock()
#: What this process has compiled in vain: each grading has several runs.
_failed: Final[dict[str, NotCompiled]] = {}


class NotCompiled(GraderFailure):
    """Interfaces could not be compiled; the message says why nothing was run."""


def compile_all(
    theirs: Mapping[str, str], own: OwnInterfaces, context: RunContext
) -> tuple[Path | None, Path | None]:
    """Return where the simulator's process finds interfaces in a run, and where the submission's.

    Args:
        theirs: the exercise's: a type, `my_interfaces/msg/Num` -> its definition.
        own: the submission's.

    Raises:
        NotCompiled: there is no compiler, it fails, or the two would mistake each other's messages.
        GraderFailure: its process could not be started.
    """
    try:
        if unlike := next(iter(own.unlike.values()), NOTHING):
            raise NotCompiled(UNLIKE.given(difference=unlike))
        ours, others = (
            _compiled(texts, context) if texts else None for texts in (theirs, own.importable)
        )
        return ours, others
    except NotCompiled as error:
        names = sorted({name.partition("/")[0] for name in {**theirs, **own.texts}})
        words = {"packages": ", ".join(names), "why": error.message}
        raise NotCompiled(NOT_COMPILED.given(**words)) from error


def importing(place: Path | None, context: RunContext) -> dict[str, str]:
    """Return the environment variable that has a process search a folder for modules first."""
    path = [str(place), *filter(None, [context.env.get("PYTHONPATH")])]
    return {"PYTHONPATH": os.pathsep.join(path)} if place else {}


def _compiled(texts: Mapping[str, str], context: RunContext) -> Path:
    """Return a folder with the packages of definitions, which nobody can change."""
    if missing := compiler.missing():
        raise NotCompiled("{names} is missing here", names=", ".join(missing))
    is_apart = context.level.level in (NAMESPACES, LANDLOCK)
    home = scratch.home() if is_apart else context.folder
    facts = [sorted(texts.items()), context.isolation, *_versions()]
    key = hashlib.sha256(json.dumps(facts).encode()).hexdigest()
    place = home / f"interfaces-{key[:32]}"
    with _lock:
        if key in _failed:  # another run of the same grading was first
            raise _failed[key]
        if not place.is_dir():
            try:
                _keep(*_built(texts), {name.partition("/")[0] for name in texts}, place)
            except NotCompiled as error:
                _failed[key] = error
                raise
    with suppress(FileNotFoundError):  # another grader has removed an old one
        os.utime(place)
        kept = sorted(home.glob("interfaces-*"), key=lambda each: each.stat().st_mtime)
        for each in kept[:-MOST_KEPT]:
            remove(each)
    return place


def _versions() -> list[str]:
    """Return what the result depends on beside the definitions."""
    found = Path(shutil.which(os.environ.get("CC", "gcc")) or "").resolve()
    ours = [PROGRAM.read_text("utf-8"), PROGRAM.with_name("dispatch.c").read_text("utf-8")]
    return [
        *(str(found), str(found.stat().st_mtime_ns), *ours, sys.version, sys.prefix),
        *(metadata.version("numpy"), metadata.version("rosidl-generator-py")),
        os.environ.get("ROS_DISTRO", ""),
    ]


def _built(texts: Mapping[str, str]) -> tuple[dict[str, str], bytes]:
    """Compile definitions in a process of its own; return the modules and the library it leaves."""
    with run_context.open_context(CpuBudget(CPU_S)) as context:
        nothing = context.folder / "interfaces"
        nothing.mkdir()
        order = {"texts": dict(texts), "leaves": context.recording}
        command = [sys.executable, str(PROGRAM), json.dumps(order)]
        _, process = context.start(
            Submission(nothing.name, nothing, (), NOTHING),
            *(lambda _: command, (context.recording,), {}),
        )
        with process.ended_at_exit(gently=False):
            code = process.wait(LONGEST_S)
        if code is None or process.excess:
            raise NotCompiled(msg("that takes more time or memory than is allowed"))
        if code:
            lines = [line for line in process.output().splitlines() if "rror: " in line]
            raise NotCompiled("the compiler says: {line}", line=lines[0][:300] if lines else code)
        try:
            data = handover.read_bounded(context.recording, BUILT_BYTES)
            left = strict_json.from_json(dict[str, str], json.loads(data), strict_json.OURS)
            library = base64.b64decode(left.pop("", ""), validate=True)
        except (OSError, ValueError, RecursionError) as error:
            raise NotCompiled(
                "it left nothing that can be read: {why}", why=str(error)[:200]
            ) from error
        return left, library


def _keep(modules: Mapping[str, str], library: bytes, packages: set[str], place: Path) -> None:
    """Write what was built to a place, at once."""
    with scratch.make_folder() as folder:
        whole = folder / "built"
        suffix = sysconfig.get_config_var("EXT_SUFFIX")
        for path, text in modules.items():
            found = _MODULE.fullmatch(path)
            if found is None or found[1] not in packages:
                raise NotCompiled("it left a module {path}", path=path[:100])
            (whole / path).parent.mkdir(parents=True, exist_ok=True)
            (whole / path).write_text(text, encoding="utf-8")
        (whole / f"own{suffix}").write_bytes(library)
        for package in packages:
            link = whole / package / f"{package}_s__rosidl_typesupport_c{suffix}"
            link.symlink_to(f"../own{suffix}")
        try:
            whole.rename(place)
        except OSError:
            if not place.is_dir():  # no other grader was first
                raise
