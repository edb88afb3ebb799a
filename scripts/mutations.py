"""A seeded mutation check: what do the tests notice? For before and after a rewrite of the tests.

    python scripts/mutations.py choose --seed 23 --count 200 --out PLACES
    python scripts/mutations.py record --places PLACES --work FOLDER --out COVERED [-- FOR PYTEST]
    python scripts/mutations.py run --places PLACES --covered COVERED ... --work FOLDER --out RESULT
    python scripts/mutations.py report RESULT [BEFORE]

`choose` takes places of grader/ and turtlesim_py/ by chance; at each something is changed: a
comparison, a number or truth value, or a call whose value nobody uses goes. A place is found again
by its file, its function and its line, wherever that is by then; else it is `gone`, and not
counted. `record` runs the tests once and notes which of them come by which place, in started and
in confined processes as well. `run` changes one place after the other and runs the tests that come
by it, the quickest first, until one fails: at most five minutes for those without the mark MORE
(what `make test` runs), and as much for the others. It goes on where it was stopped.

All happens in clones of the last commit: FOLDER/0, FOLDER/1, ..., with a .venv and a temporary
folder each. FOLDER's path is to be short, as there are sockets below it. As root on Linux the tests
have processes, network and shared memory of their own, so that nothing of a changed program stays.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from importlib.util import find_spec
from itertools import count
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("grader", "turtlesim_py")
OURS = {*PACKAGES, "tests"}
#: Students' programs, and texts.
LEFT_OUT = {"starter", "reference", "right", "locale"}
#: What each comparison becomes.
SWAPPED: dict[type[ast.cmpop], tuple[str, str]] = {
    **{ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">")},
    **{ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.In: ("in", "not in")},
    **{ast.NotIn: (r"not\s+in", "in"), ast.Is: ("is", "is not"), ast.IsNot: (r"is\s+not", "is")},
}
#: Stands for the name of what has none.
MODULE = "(module)"
MOST_S = 300.0
#: Only a test that a change has made hang takes longer.
TEST_S = 100
#: The tests of a place run in so many processes: (tests at most, seconds they took together).
BATCHES = ((60, 5.0), (300, 20.0), (1500, 60.0), (1 << 30, 1e9))
#: Put into each file that is watched: one byte for each place, in memory that all processes share.
#: It is mapped before a process is confined, and where that comes first, see `LOOSENED`.
WATCH = """
import builtins
if not hasattr(builtins, "_hit_place"):
    def make():
        try:
            import ctypes, os
            fd = os.open({path!r}, os.O_RDWR | os.O_CLOEXEC)
            mmap = ctypes.CDLL(None).mmap
            mmap.restype = ctypes.c_void_p
            at = mmap(None, ctypes.c_size_t({size}), 3, 1, fd, ctypes.c_long(0))
            os.close(fd)
            seen = (ctypes.c_ubyte * {size}).from_address(at)
            seen[0]
        except Exception:
            return lambda place: None
        def hit(place):
            seen[place] = 1
        return hit
    builtins._hit_place = make()
"""
_FILESYSTEM = "grader/run/processes/sandbox/filesystem.py"
_SHOWN = """        _do(*step)
    os.makedirs(SITE + {folder!r}, exist_ok=True)
    linux.mount("", SITE + {folder!r}, linux.MS_BIND, source={folder!r})
"""
_WRITTEN = 'if step[0] in ("copy", "scratch")]'
_LANDLOCK = "    version = min(abi(), max_abi)\n"
_CONTAINER = '    _make_devices(root / "dev")\n'
#: So that confined processes can map it: (file, what stands there, what comes in its place).
LOOSENED = (
    (_FILESYSTEM, "        _do(*step)\n", _SHOWN),
    (_FILESYSTEM, _WRITTEN, _WRITTEN + " + [{folder!r}]"),
    (
        "grader/run/processes/sandbox/landlock.py",
        _LANDLOCK,
        "    write = [*write, {folder!r}]\n" + _LANDLOCK,
    ),
    (
        "tests/attacks/container.py",
        _CONTAINER,
        _CONTAINER + '    _mount({folder!r}, root / {folder!r}[1:], "", MS_BIND)\n',
    ),
)
#: Processes, network and shared memory that end with the command.
BOX = ("unshare", "-m", "-p", "-f", "-n", "-i", "--mount-proc", "--kill-child")
BOXED = 'mount -t tmpfs -o mode=1777 none /dev/shm && "$@"; exit $?'


@dataclass(frozen=True)
class Place:
    """Where something is changed; `nth` of its function where the same stands more than once."""

    file: str
    function: str
    operator: str
    old: str
    new: str
    nth: int
    line: int

    def key(self) -> tuple[str, ...]:
        """What does not depend on where in the file it is."""
        return self.file, self.function, self.operator, self.old, self.new


@dataclass(frozen=True)
class Site:
    """A place in a text: bytes, what comes there, and the name of what runs at import, or ''."""

    place: Place
    start: int
    end: int
    text: str
    imported: str


class Source:
    """A file's tree, and where its nodes are in its bytes."""

    def __init__(self, file: str, text: str) -> None:
        self.file, self.bytes, self.tree = file, text.encode(), ast.parse(text)
        lines = self.bytes.splitlines(keepends=True)
        self._starts = [0, *(sum(map(len, lines[: n + 1])) for n in range(len(lines)))]

    def span(self, node: Any) -> tuple[int, int]:
        """Where a node begins and ends."""
        return (
            self._starts[node.lineno - 1] + node.col_offset,
            self._starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def nodes(
        self, top: ast.AST | None = None, scope: str = "", imported: str = MODULE
    ) -> Iterator[tuple[ast.AST, str, str]]:
        """All that is run, with its function, and with the name of what has it run at import."""
        for node in _parts(top or self.tree):
            inner, name, late = scope, imported, isinstance(top, ast.Lambda)
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                inner = f"{scope}.{node.name}".lstrip(".")
                name = imported and (node.name if imported == MODULE else imported)
            elif isinstance(node, ast.Assign | ast.AnnAssign) and imported == MODULE:
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                ids = (each for target in targets for each in ast.walk(target))
                stored = (n for n in ids if isinstance(getattr(n, "ctx", None), ast.Store))
                name = " ".join(getattr(each, "id", "") for each in stored) or MODULE
            if isinstance(top, ast.FunctionDef | ast.AsyncFunctionDef):
                late = late or any(node is each for each in top.body)
            yield node, scope, "" if late else name
            yield from self.nodes(node, inner, "" if late else name)

    def sites(self) -> list[Site]:
        """All places, in order."""
        found, seen = [], Counter[tuple[str, ...]]()
        for node, scope, imported in self.nodes():
            for operator, (start, end), text in self._changes(node):
                first = self.bytes.rfind(b"\n", 0, start) + 1
                last = (self.bytes + b"\n").index(b"\n", end)
                old = self.bytes[first:last].decode()
                new = (self.bytes[first:start] + text.encode() + self.bytes[end:last]).decode()
                line = self.bytes.count(b"\n", 0, start) + 1
                place = Place(self.file, scope, operator, old.strip(), new.strip(), 0, line)
                nth = seen[place.key()]
                seen[place.key()] += 1
                found.append(Site(replace(place, nth=nth), start, end, text, imported))
        return found

    def _changes(self, node: ast.AST) -> Iterator[tuple[str, tuple[int, int], str]]:
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in SWAPPED:
            (start, end), (after, last) = self.span(node.left), self.span(node.comparators[0])
            before, now = SWAPPED[type(node.ops[0])]
            between = re.sub(before, now, self.bytes[end:after].decode(), count=1)
            texts = (self.bytes[start:end].decode(), between, self.bytes[after:last].decode())
            yield "comparison", (start, last), "".join(texts)
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call | ast.Await):
            if _called(node.value) not in ("say", "debug", "info", "warning"):
                yield "call", self.span(node.value), "None"
        elif isinstance(node, ast.Constant) and type(node.value) in (bool, int, float):
            value: Any = node.value
            other = {bool: not value, int: value + 1, float: value * 2 or 1.0}[type(value)]
            yield "constant", self.span(node), repr(other)


def _called(node: ast.AST) -> str:
    function = getattr(node, "func", None)
    return str(getattr(function, "id", getattr(function, "attr", "")))


def _parts(node: ast.AST) -> Iterator[ast.AST]:
    """What is in a node and run, without types, decorators, patterns and what is said."""
    left_out = {"annotation", "returns", "decorator_list", "pattern"}
    if isinstance(node, ast.JoinedStr) or _called(node) == "say":
        return  # the places in an f-string are right from Python 3.12 on only
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        left_out.add("body")
    if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) in ("__all__", "__slots__"):
        return
    for name, value in ast.iter_fields(node):
        if name not in left_out:
            for each in value if isinstance(value, list) else [value]:
                if isinstance(each, ast.AST):
                    yield each


def sources(tree: Path) -> dict[str, Source]:
    """The files that are looked at."""
    paths = sorted(path for name in PACKAGES for path in (tree / name).rglob("*.py"))
    files = {str(path.relative_to(tree)): path for path in paths}
    return {
        file: Source(file, path.read_text(encoding="utf-8"))
        for file, path in files.items()
        if not LEFT_OUT & set(path.relative_to(tree).parts)
    }


def find(places: Sequence[Place], files: dict[str, Source]) -> dict[int, Site]:
    """Where places are now: number -> site; those that are gone are not in it."""
    there: dict[tuple[str, ...], list[Site]] = defaultdict(list)
    for file in {place.file for place in places} & files.keys():
        for site in files[file].sites():
            there[site.place.key()].append(site)
    return {
        number: there[place.key()][min(place.nth, len(there[place.key()]) - 1)]
        for number, place in enumerate(places)
        if there[place.key()]
    }


def watched(files: dict[str, Source], sites: dict[int, Site], seen: Path) -> dict[str, str]:
    """The texts of files that tell when a place is come by.

    What runs at import is come by wherever its name is used, or a function of its file is called.
    """
    marks: dict[str, set[tuple[int, int, int]]] = defaultdict(set)
    names: dict[str, set[int]] = defaultdict(set)
    homes: dict[str, set[int]] = defaultdict(set)
    for number, site in sites.items():
        marks[site.place.file].add((site.start, site.end, number))
        if site.imported:
            for name in site.imported.split():
                names[name].add(number)
            homes[site.place.file].add(number)
    for file, source in files.items():
        for node, _, _ in source.nodes():
            wrapped: Any = node
            numbers: set[int] = set()
            if isinstance(getattr(node, "ctx", None), ast.Load):
                numbers = names.get(str(getattr(node, "id", getattr(node, "attr", ""))), numbers)
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and file in homes:
                wrapped = next(filter(None, map(_first_value, node.body)), None)
                numbers = homes[file] if wrapped else numbers
            marks[file].update((*source.span(wrapped), number) for number in numbers)
    code = WATCH.format(path=str(seen), size=seen.stat().st_size)
    texts = {}
    for file, wanted in marks.items():
        source, cuts = files[file], []
        for start, end, number in wanted:
            cuts.append((start, 1, -end, f"(_hit_place({number}) or ("))
            cuts.append((end, 0, -start, "))"))
        future = [each for each in source.tree.body if getattr(each, "module", "") == "__future__"]
        if wanted:
            # nothing may stand before these, and before a file's docstring
            after = future[-1] if future else source.tree.body[0]
            cuts.append((source.span(after)[1], 0, 0, f"; exec({code!r}, {{}})"))
            text, last = b"", 0
            for at, _, _, more in sorted(cuts):
                text, last = text + source.bytes[last:at] + more.encode(), at
            texts[file] = (text + source.bytes[last:]).decode()
    return texts


def _first_value(node: ast.AST) -> ast.AST | None:
    """The first value that a statement computes, if it is no docstring."""
    if isinstance(node, ast.Try):
        return next(filter(None, map(_first_value, node.body)), None)
    if isinstance(node, ast.With):
        return node.items[0].context_expr
    for name in ("test", "iter", "subject", "value", "exc"):
        value = getattr(node, name, None)
        is_text = isinstance(node, ast.Expr) and isinstance(value, ast.Constant)
        if isinstance(value, ast.AST) and not is_text:
            return value
    return None


class Workspace:
    """A clone with a .venv, in which things are changed and tests are run."""

    def __init__(self, work: Path, number: int) -> None:
        self.tree, self.tmp = work.resolve() / str(number), work.resolve() / f"t{number}"
        self.is_boxed = sys.platform == "linux" and os.geteuid() == 0
        self._stamps = count(int(time.time()) // 2)
        work.mkdir(parents=True, exist_ok=True)
        if not self.tree.exists():
            _do("git", "clone", "-q", str(ROOT), str(self.tree))
        _do("git", "fetch", "-q", str(ROOT), "HEAD", cwd=self.tree)
        _do("git", "checkout", "-q", "-f", "--detach", "FETCH_HEAD", cwd=self.tree)
        _do("make", "tools", cwd=self.tree)
        self._site = next((self.tree / ".venv").glob("lib/python*/site-packages"))
        self.restore()
        if self.is_boxed:
            self.is_boxed = not subprocess.run([*BOX, "true"], stderr=subprocess.DEVNULL).returncode

    def restore(self) -> None:
        """Have everything as it was committed, installed as well."""
        _do("git", "checkout", "-q", "-f", "--", ".", cwd=self.tree)
        for name in PACKAGES:
            for path in (self.tree / name).rglob("*.py"):
                copy = self._site / path.relative_to(self.tree)
                if copy.exists() and copy.read_bytes() != path.read_bytes():
                    shutil.copyfile(path, copy)

    def change(self, file: str, text: str) -> None:
        """Write a file, and its installed copy, as of a time that no other was: for Python."""
        stamp = next(self._stamps)
        for path in (self.tree / file, self._site / file):
            if path.exists():
                path.write_text(text, encoding="utf-8")
                os.utime(path, (stamp, stamp))

    def test(
        self, words: Sequence[str], only: Sequence[str] | None = None, most_s: float | None = None
    ) -> tuple[list[dict[str, Any]], int | None]:
        """Run tests; what was told of each, and pytest's exit code, None if it took too long."""
        told, wanted = self.tmp.with_suffix(".told"), self.tmp.with_suffix(".only")
        told.write_text("")
        wanted.write_text(json.dumps(only))
        shutil.rmtree(self.tmp, ignore_errors=True)
        self.tmp.mkdir(exist_ok=True)  # a killed test may leave what cannot be removed
        python = str(self.tree / ".venv" / "bin" / "python")
        command = [python, __file__, "pytest", str(told), str(wanted), *words]
        if self.is_boxed:
            command = [*BOX, "sh", "-c", BOXED, "sh", *command]
        env = {**os.environ, "TMPDIR": str(self.tmp)}
        with self.tmp.with_suffix(".log").open("wb") as log:
            process = subprocess.Popen(
                command, cwd=self.tree, env=env, stdout=log, stderr=log, start_new_session=True
            )
            code: int | None = None
            with suppress(subprocess.TimeoutExpired):
                code = process.wait(most_s)
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        if not self.is_boxed:
            self._sweep()
        shutil.rmtree(self.tmp, ignore_errors=True)
        lines = told.read_text(encoding="utf-8").splitlines()
        return [json.loads(line) for line in lines if line.endswith("}")], code

    def _sweep(self) -> None:
        """End what is left of processes of this workspace."""
        ours = (f"TMPDIR={self.tmp}\0".encode(), f"{self.tree}/.venv/bin/python".encode())
        for folder in Path("/proc").glob("[0-9]*"):
            with suppress(OSError):
                words = [(folder / name).read_bytes() for name in ("cmdline", "environ")]
                if any(mark in b"\0".join(words) for mark in ours):
                    os.kill(int(folder.name), signal.SIGKILL)


def _do(*words: str, cwd: Path = ROOT) -> None:
    subprocess.run(words, cwd=cwd, check=True, stdout=subprocess.DEVNULL)


def _load(path: Path) -> list[Place]:
    return [Place(**each) for each in json.loads(path.read_text(encoding="utf-8"))]


def _save(path: Path, what: Any) -> None:
    beside = path.with_suffix(".new")
    beside.write_text(json.dumps(what, indent=1) + "\n", encoding="utf-8")
    beside.replace(path)


def choose(options: argparse.Namespace) -> None:
    """Take places by chance, and save them."""
    places = [site.place for source in sources(ROOT).values() for site in source.sites()]
    print(len(places), "places:", dict(Counter(place.operator for place in places)))
    chosen = random.Random(options.seed).sample(places, options.count)
    chosen.sort(key=lambda place: (place.file, place.line))
    _save(options.out, [asdict(place) for place in chosen])
    print("chosen:", dict(Counter(place.operator for place in chosen)))


def record(options: argparse.Namespace) -> None:
    """Run all tests, or some, and note which of them come by the places."""
    workspace = Workspace(options.work, options.job)
    files = sources(workspace.tree)
    places = _load(options.places)
    folder = workspace.tree / ".seen"
    folder.mkdir(exist_ok=True)
    seen = folder / "places"
    seen.write_bytes(bytes(max(4096, len(places))))
    seen.chmod(0o666)  # a confined process may be another user's
    for file, text in watched(files, find(places, files), seen).items():
        workspace.change(file, text)
    for file, before, after in LOOSENED:
        path = workspace.tree / file
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        if text.count(before) != 1:
            print(f"{file} has changed: what happens in confined processes may be missed")
        else:
            workspace.change(file, text.replace(before, after.format(folder=str(folder))))
    told, code = workspace.test([f"--seen={seen}", f"--more={options.more}", *options.words])
    print("pytest ended with", code, "after", len(told), "tests")
    workspace.restore()
    shutil.rmtree(folder)
    tests = {each.pop("test"): each for each in told}
    failed = [name for name, each in tests.items() if each["outcome"] == "failed"]
    # those that do not like to be watched
    again = {each["test"]: each for each in workspace.test([], failed)[0]} if failed else {}
    for name in failed:
        told_again = again.get(name, tests[name])
        tests[name] |= {each: told_again[each] for each in ("outcome", "seconds")}
    print(len(failed), "failed;", sum(tests[n]["outcome"] == "failed" for n in failed), "again:")
    print(*(name for name in failed if tests[name]["outcome"] == "failed"), sep="\n")
    _save(options.out, tests)


def _covered(paths: Sequence[Path]) -> dict[str, dict[str, Any]]:
    """What was recorded. None is quicker than those of its module are on average.

    It may have found done what it would have to do itself, were it alone.
    """
    tests: dict[str, dict[str, Any]] = {}
    modules: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for path in paths:
        tests.update(json.loads(path.read_text(encoding="utf-8")))
    for name, each in tests.items():
        modules[name.partition("::")[0]].append(each)
    for those in modules.values():
        mean = sum(each["seconds"] for each in those) / len(those)
        for each in those:
            each["seconds"] = max(each["seconds"], mean)
    return tests


def _order(number: int, tests: dict[str, dict[str, Any]], place: Place) -> list[str]:
    """The tests that may notice it: its own before others of their modules, and quick ones first.

    Others: what a fixture does for several tests is seen in any of them.
    """
    own = {name for name, each in tests.items() if number in each["hits"]}
    ways = {(name.partition("::")[0], way) for name in own for way in tests[name]["shared"]}
    near = [
        name
        for name, each in tests.items()
        if name in own or any((name.partition("::")[0], way) in ways for way in each["shared"])
    ]
    stem = f"test_{Path(place.file).stem}"

    def effort(name: str) -> tuple[bool, float]:
        is_about = stem in name.partition("::")[0]
        return name not in own, float(tests[name]["seconds"]) * (0.1 if is_about else 1.0)

    return sorted(near, key=effort)


def _passes(told: dict[str, Any]) -> bool:
    return bool(told["outcome"] == "passed")


def _batches(names: Sequence[str], tests: dict[str, dict[str, Any]]) -> Iterator[list[str]]:
    """In each those of a module are together: they share what its fixtures make."""
    rest = list(names)
    for most, seconds in BATCHES:
        batch: list[str] = []
        taken = 0.0
        while rest and len(batch) < most and (not batch or taken < seconds):
            taken += tests[rest[0]]["seconds"]
            batch.append(rest.pop(0))
        first = {name.partition("::")[0]: n for n, name in reversed(list(enumerate(batch)))}
        if batch:
            yield sorted(batch, key=lambda name: first[name.partition("::")[0]])


class Trial:
    """A place that is changed in a workspace, and the tests' answer."""

    def __init__(self, workspace: Workspace, site: Site, tests: dict[str, dict[str, Any]]) -> None:
        self._workspace, self._site, self._tests = workspace, site, tests
        text = (workspace.tree / site.place.file).read_bytes()
        self._text = (text[: site.start] + site.text.encode() + text[site.end :]).decode()
        #: what failed without the change as well
        self.unsound: list[str] = []

    def run(self, names: Sequence[str]) -> dict[str, Any]:
        """Whether one of these tests fails, and which."""
        began, late = time.monotonic(), 0.0
        left = [name for name in names if _passes(self._tests[name])]
        for batch in _batches(left, self._tests):
            wanted = list(batch)
            while wanted:
                room = MOST_S - (time.monotonic() - began - late)
                self._workspace.change(self._site.place.file, self._text)
                told, code = self._workspace.test(["-x", f"--timeout={TEST_S}"], wanted, room)
                self._workspace.restore()
                used = round(time.monotonic() - began - late, 1)
                failed = next((each["test"] for each in told if each["outcome"] == "failed"), "")
                if not failed and code is None:
                    return {"how": "no more time", "by": "", "seconds": used}
                if not failed and code is not None and (code in (2, 3, 4) or not 0 <= code < 128):
                    return {"how": "no start", "by": "", "seconds": used}
                if not failed:
                    break
                at = time.monotonic()
                again, _ = self._workspace.test([], [failed])
                late += time.monotonic() - at
                if any(map(_passes, again)):
                    return {"how": "killed", "by": failed, "seconds": used}
                self.unsound.append(failed)
                # those before it have passed
                wanted = wanted[wanted.index(failed) + 1 :] if failed in wanted else []
        used = round(time.monotonic() - began - late, 1)
        return {"how": "survived" if left else "not covered", "by": "", "seconds": used}


def run(options: argparse.Namespace) -> None:
    """Change one place after the other; what the tests say to each."""
    places, tests = _load(options.places), _covered(options.covered)
    before = json.loads(options.first.read_text(encoding="utf-8")) if options.first else {}
    done = json.loads(options.out.read_text(encoding="utf-8")) if options.out.exists() else {}
    lock, left = threading.Lock(), [n for n in range(len(places)) if str(n) not in done]
    random.Random(0).shuffle(left)  # so that the first tell what the rest will be
    workspaces = [Workspace(options.work, options.job + n) for n in range(options.jobs)]
    sites = find(places, sources(workspaces[0].tree))

    def answer(workspace: Workspace, number: int) -> dict[str, Any]:
        told: dict[str, Any] = {**asdict(places[number]), "tiers": []}
        past = before.get(str(number), {"tiers": []})["tiers"]
        if number not in sites:
            return told
        if past and options.skip_survivors and not any(map(_is_kill, past)):
            return told | {"tiers": past}
        names = _order(number, tests, places[number])
        killers = [each["by"] for each in past if each["by"] in tests]
        trial = Trial(workspace, sites[number], tests)
        for is_more in (False, True):
            asked = dict.fromkeys([*killers, *names])
            chosen = [name for name in asked if tests[name]["more"] is is_more]
            if chosen or not is_more:
                told["tiers"].append(trial.run(chosen))
            if _is_kill(told["tiers"][-1]):
                break
        return told | {"unsound": trial.unsound}

    def work(workspace: Workspace) -> None:
        while True:
            with lock:
                if not left:
                    return
                number = left.pop()
            told = answer(workspace, number)
            with lock:
                done[str(number)] = told
                _save(options.out, done)
                last = told["tiers"][-1] if told["tiers"] else {"how": "gone"}
                print(f"{len(done)}/{len(places)}", _line(told), *last.values(), flush=True)

    threads = [threading.Thread(target=work, args=(each,)) for each in workspaces]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    report(argparse.Namespace(result=options.out, before=options.first))


def _is_kill(tier: dict[str, Any]) -> bool:
    return tier["how"] in ("killed", "no start")


def _line(told: dict[str, Any]) -> str:
    return f"{told['file']}:{told['line']} {told['operator']}: {told['old'].splitlines()[0]}"


def report(options: argparse.Namespace) -> None:
    """Print how many places the tests notice, of both tiers and of the first alone."""
    result = json.loads(options.result.read_text(encoding="utf-8"))
    there = {number: told for number, told in result.items() if told["tiers"]}
    print(len(there), "places,", len(result) - len(there), "gone")
    for operator in ("", "comparison", "call", "constant"):
        kind = [told["tiers"] for told in there.values() if operator in ("", told["operator"])]
        for name, rows in (("first tier", [tiers[:1] for tiers in kind]), ("both", kind)):
            killed = sum(any(map(_is_kill, tiers)) for tiers in rows)
            print(f"{operator or 'all':12}{name:12}{killed:4} of {len(rows):4}", end="")
            print(f"{100 * killed / max(1, len(rows)):7.1f} %")
    alive = {n: told for n, told in there.items() if not any(map(_is_kill, told["tiers"]))}
    before = json.loads(options.before.read_text(encoding="utf-8")) if options.before else {}
    past = {n for n, told in before.items() if any(map(_is_kill, told["tiers"]))}
    for title, numbers in (("survivors", alive.keys()), ("killed before", alive.keys() & past)):
        print(f"\n{title}:")
        for number in sorted(numbers, key=int):
            print(f"  {_line(alive[number])} -> {alive[number]['tiers'][-1]['how']}")


class Telling:
    """In pytest: writes a line for each test, and runs those that are wanted, in that order."""

    def __init__(self, out: Path, wanted: list[str] | None, seen: Path | None, more: str) -> None:
        self._out = out.open("w", encoding="utf-8")
        self._wanted = None if wanted is None else {name: n for n, name in enumerate(wanted)}
        self._seen = seen.open("r+b", buffering=0) if seen else None
        self._more = more
        self._now: dict[str, Any] = {}
        self._hits: set[int] = set()
        self._made: dict[Path, set[int]] = defaultdict(set)
        self._caches: list[Any] = []

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """After all others."""
        if (wanted := self._wanted) is not None:
            items[:] = [item for item in items if item.nodeid in wanted]
            items.sort(key=lambda item: wanted[item.nodeid])

    def pytest_collection_finish(self) -> None:
        """While it is watched, no test finds done what another has computed.

        What `tests.once` keeps is kept, and whoever asks for it comes by what its maker came by.
        """
        if not self._seen:
            return
        ours = [each for name, each in sys.modules.items() if name.split(".")[0] in OURS]
        values = {id(value): value for each in ours for value in list(vars(each).values())}
        self._caches = [each for each in values.values() if hasattr(type(each), "cache_clear")]
        if once := sys.modules.get("tests.once"):
            make_or_find = once.folder

            def folder(make: Any, *key: object) -> Path:
                before, self._hits = self._hits | self._take(), set()
                path: Path = make_or_find(make, *key)
                self._made[path] |= self._hits | self._take()
                self._hits = before | self._made[path]
                return path

            setattr(once, "folder", folder)  # noqa: B010  # mypy: it is a module's

    def _take(self) -> set[int]:
        """What has been come by since the last time: what is not 0."""
        if not self._seen:
            return set()
        self._seen.seek(0)
        data = self._seen.read()
        self._seen.seek(0)
        self._seen.write(bytes(len(data)))
        return {n for n, byte in enumerate(data) if byte}

    def pytest_runtest_logstart(self) -> None:
        """Before its fixtures."""
        for each in self._caches:
            each.cache_clear()

    def pytest_runtest_setup(self, item: Any) -> None:
        """Its mark is only known here, and which fixtures, but for pytest's, others use as well."""
        self._now["more"] = item.get_closest_marker(self._more) is not None
        fixtures = [each[-1] for each in item._fixtureinfo.name2fixturedefs.values()]
        self._now["shared"] = [f.argname for f in fixtures if f.scope != "function" and f.baseid]

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Setting up and clearing away are parts of a test."""
        self._now["seconds"] = round(self._now.get("seconds", 0.0) + report.duration, 3)
        says = report.when == "call" or not report.passed
        if says and self._now.get("outcome") != "failed":
            self._now["outcome"] = report.outcome

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """Tell of it."""
        hits = sorted(self._hits | self._take())
        plain = {"test": nodeid, "outcome": "failed", "seconds": 0.0, "hits": hits}
        print(json.dumps(plain | self._now), file=self._out, flush=True)
        self._now, self._hits = {}, set()


def in_pytest(words: list[str]) -> int:
    """Run tests in this process, that of a workspace's Python."""
    told, wanted, *rest = words
    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("--seen", type=Path)
    parser.add_argument("--more", default="more")
    options, rest = parser.parse_known_args(rest)
    only: list[str] | None = json.loads(Path(wanted).read_text(encoding="utf-8"))
    if only is not None:
        rest += dict.fromkeys(name.partition("::")[0] for name in only)
    if find_spec("xdist"):
        rest += ["-n0"]
    if find_spec("pytest_randomly"):
        rest += ["-p", "no:randomly"]
    import pytest

    # a shell in the background has them ignored, and each test's programs would inherit that
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    _raise_loopback()
    sys.path[0] = str(Path.cwd())  # as `python -m pytest` has it
    telling = Telling(Path(told), only, options.seen, options.more)
    # both tiers, whatever the project's options choose
    return int(pytest.main(["-m", "", "-p", "no:cacheprovider", *rest], plugins=[telling]))


def _raise_loopback() -> None:
    """In a network of one's own it is down; elsewhere this changes nothing, or is refused."""
    import fcntl
    import socket
    import struct

    with suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, 0x8914, struct.pack("16sh14x", b"lo", 0x41))


def main() -> int:
    """Do what the command line says."""
    if sys.argv[1:2] == ["pytest"]:
        return in_pytest(sys.argv[2:])
    at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    verbs = parser.add_subparsers(dest="verb", required=True)
    chooses, records = verbs.add_parser("choose"), verbs.add_parser("record")
    chooses.add_argument("--seed", type=int, default=23)
    chooses.add_argument("--count", type=int, default=200)
    runs, reports = verbs.add_parser("run"), verbs.add_parser("report")
    for each in (records, runs):
        each.add_argument("--places", type=Path, required=True)
        each.add_argument("--work", type=Path, required=True, help="where the clones are")
        each.add_argument("--job", type=int, default=0, help="the first clone to use")
    for each in (chooses, records, runs):
        each.add_argument("--out", type=Path, required=True)
    records.add_argument("--more", default="more", help="the mark of the second tier")
    runs.add_argument("--covered", type=Path, nargs="+", required=True)
    runs.add_argument("--jobs", type=int, default=1)
    runs.add_argument("--first", type=Path, help="an earlier result: its killers are tried first")
    runs.add_argument("--skip-survivors", action="store_true", help="count those of --first so")
    reports.add_argument("result", type=Path)
    reports.add_argument("before", type=Path, nargs="?")
    options = parser.parse_args(sys.argv[1:at])
    options.words = sys.argv[at + 1 :]
    {"choose": choose, "record": record, "run": run, "report": report}[options.verb](options)
    return 0


if __name__ == "__main__":
    sys.exit(main())
