"""Fetches the files of an exercise from a git repository, as data: git checks nothing out.

One commit is fetched into an empty repository of ours, and its files are read from there. So no
hook, filter, submodule or link of a repository ever does anything, and what is written is what was
listed: ordinary files, so many and so large at most, and none that is hidden.
"""

from __future__ import annotations

import os
import resource
import signal
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final

from grader import content, linux, scratch
from grader.added.address import Address
from grader.added.pins import Origin
from grader.errors import UsageError
from grader.message import Message, msg

#: How much an exercise may be: files, and all their bytes; and one that is parsed as YAML.
MOST_FILES, MOST_BYTES, MOST_YAML_BYTES = 2_000, 20_000_000, 250_000
#: The longest path in it [characters].
LONGEST_PATH: Final = 200
#: How long git may take [s], the largest file that it may write, and its memory [bytes].
GIT_S, GIT_BYTES, GIT_MEMORY_BYTES = 300.0, 100_000_000, 4 * 2**30
#: git's modes of an ordinary file, and what others are.
_FILES: Final = (b"100644", b"100755")
_OTHERS: Final = {
    b"120000": msg("a symbolic link"),
    b"160000": msg("a submodule"),
}
#: How a file begins that stands for one of Git LFS:
#: https://github.com/git-lfs/git-lfs/blob/main/docs/spec.md
_LFS: Final = b"version https://git-lfs.github.com/spec/v1\n"
#: Nothing but these transports, no program of the repository's or of its host's choice, and no
#: question that nobody answers.
_SETTINGS: Final = (
    *("protocol.allow=never", "protocol.https.allow=always", "protocol.ssh.allow=always"),
    *("protocol.file.allow=always", "core.hooksPath=/dev/null", "core.fsmonitor=false"),
    *("fetch.recurseSubmodules=false", "submodule.recurse=false", "transfer.fsckObjects=true"),
    *("gc.auto=0", "maintenance.auto=false", "credential.interactive=false"),
)
_BATCH_SSH: Final = "ssh -o BatchMode=yes"
#: Of the variables of git those of the user's that say how, not what.
_KEPT: Final = ("GIT_SSL_", "GIT_SSH", "GIT_PROXY")
#: Words by which a repository would extend the grader.
_EXTENSIONS: Final = (b"grader.scenes", b"grader.reports", b"grader.inspections")
_PACKAGING: Final = ("pyproject.toml", "setup.cfg", "setup.py", "entry_points.txt")


@dataclass(frozen=True)
class Fetched:
    """The files of an exercise, and where they came from."""

    origin: Origin
    files: Mapping[str, bytes]

    def write(self, folder: Path) -> None:
        """Write the files into an empty folder, readable for all.

        Raises:
            OSError: they cannot be written.
        """
        for name, data in self.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)


def fetch(address: Address) -> Fetched:
    """Fetch an exercise.

    Raises:
        UsageError: git cannot fetch it; or what is there is not what an exercise may be.
    """
    with scratch.make_folder() as folder:
        git = _Git(folder)
        git.run("init", "--quiet", "--bare", "--template=")
        git.run(
            *("fetch", "--quiet", "--depth=1", "--no-tags", "--no-recurse-submodules"),
            *("--no-write-commit-graph", "--end-of-options"),
            *(address.repository, address.tag or "HEAD"),
        )
        commit = git.run("rev-parse", "--verify", "--quiet", "FETCH_HEAD^{commit}").decode().strip()
        files = _files(git, address, commit)
    hashes = {name: content.of_bytes(data) for name, data in files.items()}
    where = (address.repository, address.tag, address.folder)
    return Fetched(Origin(*where, commit, content.of_files(hashes)), files)


class _Git:
    """git in a repository of ours, without any question to a user."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        kept = {
            name: value
            for name, value in os.environ.items()
            if name.startswith(_KEPT) or not name.startswith("GIT_")
        }
        ssh = os.environ.get("GIT_SSH_COMMAND", _BATCH_SSH)
        self._env = {**kept, "GIT_TERMINAL_PROMPT": "0", "GIT_SSH_COMMAND": ssh, "LC_ALL": "C"}
        self._env["GIT_DIR"] = str(folder / "repository")

    def run(self, *words: str, given: bytes = b"") -> bytes:
        """Run a command, and return what it prints.

        Raises:
            UsageError: there is no git, or it fails, or takes too long.
        """
        settings = [word for each in _SETTINGS for word in ("-c", each)]
        asked, printed, said = (self._folder / name for name in ("asked", "printed", "said"))
        asked.write_bytes(given)
        # into files, which are bounded: a small tree may list what has no end
        with asked.open("rb") as stdin, printed.open("wb") as out, said.open("wb") as errors:
            try:
                process = subprocess.Popen(
                    ["git", *settings, *words],
                    stdin=stdin,
                    stdout=out,
                    stderr=errors,
                    cwd=self._folder,
                    env=self._env,
                    process_group=0,
                    preexec_fn=_limit,
                )
            except OSError as error:
                raise UsageError(
                    "git cannot be started, by which exercises are fetched: {why}", why=str(error)
                ) from None
        try:
            code = process.wait(GIT_S)
        except subprocess.TimeoutExpired:
            raise UsageError("git took more than {seconds:g} s", seconds=GIT_S) from None
        finally:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        if code:
            with said.open("rb") as file:
                lines = file.read(10_000).decode("utf-8", "replace").splitlines()
            told = " ".join(filter(None, map(str.strip, lines)))
            raise UsageError("git cannot fetch it: {why}", why=told[:500] or f"exit code {code}")
        return printed.read_bytes()


def _limit() -> None:
    linux.lower_limit(resource.RLIMIT_FSIZE, GIT_BYTES, GIT_BYTES)
    linux.lower_limit(resource.RLIMIT_AS, GIT_MEMORY_BYTES, GIT_MEMORY_BYTES)


def _files(git: _Git, address: Address, commit: str) -> dict[str, bytes]:
    """Read the files of a commit, or of a folder in it."""
    tree = f"{commit}:{address.folder}"
    try:
        listed = git.run("ls-tree", "-r", "-z", "--long", "--full-tree", "--end-of-options", tree)
    except UsageError:
        raise UsageError(
            "there is no folder {folder!r} in {repository}, commit {commit}",
            folder=address.folder,
            repository=address.repository,
            commit=commit,
        ) from None
    found: dict[str, tuple[str, int]] = {}
    for line in filter(None, listed.split(b"\0")):
        facts, _, name = line.partition(b"\t")
        if any(part.startswith(b".") for part in name.split(b"/")):
            continue  # .gitignore, .github/...: of the repository, not of the exercise
        mode, _, number, size = facts.split()
        path = _path(name)
        if mode not in _FILES:
            raise _no_ordinary_file(path, _OTHERS.get(mode, msg("no file")))
        found[path] = number.decode(), int(size)
    _check_size({path: size for path, (_, size) in found.items()})
    numbers = [number for number, _ in found.values()]
    objects = _blobs(git.run("cat-file", "--batch", given="\n".join([*numbers, ""]).encode()))
    files = dict(zip(found, objects, strict=True))
    for path, data in files.items():
        if data.startswith(_LFS):
            raise _no_ordinary_file(path, msg("a pointer of Git LFS"))
    _check_is_exercise(files)
    return files


def _no_ordinary_file(path: str, what: Message) -> UsageError:
    return UsageError(
        "{path} is {what}: an exercise holds ordinary files alone", path=path, what=what
    )


def _blobs(data: bytes) -> list[bytes]:
    """Divide what `cat-file --batch` prints: NUMBER TYPE SIZE, the content, a line end."""
    found, at = [], 0
    while at < len(data):
        head = data.index(b"\n", at)
        end = head + 1 + int(data[at:head].split()[2])
        found.append(data[head + 1 : end])
        at = end + 1
    return found


def _path(name: bytes) -> str:
    """Return the path of a file in a tree.

    Raises:
        UsageError: it would lie elsewhere, or no file here can be called so.
    """
    path = name.decode("utf-8", "replace")
    parts = PurePosixPath(path).parts
    is_plain = path.isprintable() and "\ufffd" not in path and "\\" not in path
    if not is_plain or len(path) > LONGEST_PATH or "/" in parts:
        raise UsageError("the exercise has a file of an odd name: {path!r}", path=path[:100])
    return path


def _check_size(sizes: Mapping[str, int]) -> None:
    for path, size in sizes.items():
        if path.endswith((".yaml", ".yml")) and size > MOST_YAML_BYTES:
            raise UsageError(
                "{path} has {size:,} bytes; expected {most:,} at most",
                path=path,
                size=size,
                most=MOST_YAML_BYTES,
            )
    total = sum(sizes.values())
    if len(sizes) > MOST_FILES or total > MOST_BYTES:
        raise UsageError(
            "the exercise has {files:,} files of {size:,} bytes; expected {most_files:,} files and "
            "{most:,} bytes at most",
            files=len(sizes),
            size=total,
            most_files=MOST_FILES,
            most=MOST_BYTES,
        )


def _check_is_exercise(files: Mapping[str, bytes]) -> None:
    if "exercise.yaml" not in files:
        those = (PurePosixPath(name) for name in files)
        folders = sorted(str(each.parent) for each in those if each.name == "exercise.yaml")
        raise UsageError(
            "there is no exercise.yaml in it. {hint}",
            hint=msg("Folders with one, for #FOLDER: {folders}", folders=", ".join(folders[:20]))
            if folders
            else msg("An exercise is a folder with an exercise.yaml"),
        )
    for name, data in files.items():
        if PurePosixPath(name).name in _PACKAGING and any(word in data for word in _EXTENSIONS):
            raise UsageError(
                "{name} has entry points of the grader. Scenes, reports and inspections come "
                "through pip only: they would run in the grader's own process",
                name=name,
            )


def changed(before: Mapping[str, str], after: Mapping[str, str]) -> Sequence[str]:
    """Return how files differ from others, by their hashes: '+ new', '- gone', '~ other'."""
    signs = {
        name: "+" if name not in before else "-" if name not in after else "~"
        for name in sorted({*before, *after})
        if before.get(name) != after.get(name)
    }
    return [f"{sign} {name}" for name, sign in signs.items()]
