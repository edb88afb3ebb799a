"""In the container: canaries are set out, attacks are graded, and what has changed is told.

The observer is the container's first process: root of the container, if anybody is, out of reach
of signals, and the parent of all that nobody else waits for. Nothing that a submission says is
believed but that it has achieved something.
"""

from __future__ import annotations

import json
import os
import pwd
import re
import secrets
import select
import shutil
import socket
import stat
import subprocess
import sys
from collections.abc import Collection, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from grader.system import linux
from tests.attacks import bystander, handed_in, levels, runners
from tests.attacks.attacks import ATTACKS, EXERCISES, MOVES

ROOT = Path(__file__).parents[2]
PACKAGES = ("grader", "turtlesim_py", "turtlesim_challenge")
#: How often a process that does not answer is looked at [s].
LOOK_S = 0.05
#: The memory that a process of a grading may have at most, what its results may take [bytes],
#: and how many processes there may be.
MOST_MEMORY, MOST_RESULTS, MOST_PROCESSES = 1400 << 20, 32 << 20, 400
TOKENS = ("GITHUB_TOKEN", "AWS_SECRET_ACCESS_KEY", "CI_JOB_TOKEN", "COURSE_TOKEN", "GRADER_SECRET")
HONEST = (handed_in.SUBMISSIONS / "honest.py").read_text()


def observe(job: dict[str, Any], layer: int) -> list[dict[str, Any]]:
    """Grade attacks one after the other, and an honest submission before and after them.

    What is about that which is left behind is followed by an honest one at once.

    Args:
        job: `level`, a key of `levels.LEVELS`, or "unconfined": then the attacks are run by Python
            alone, and nothing is graded; and `attacks`, a list of keys of `ATTACKS`.
        layer: a folder in which all is that was written: see `container`.
    """
    place = _Place(levels.LEVELS.get(job["level"], levels.UNCONFINED))
    told = []
    for name in job["attacks"]:
        is_followed = name == job["attacks"][-1] or ATTACKS[name].kind == "leftovers"
        told.append(_Trial(place, name, layer).run(is_followed=is_followed))
        if told[-1]["harm"]:
            place.clear()
    told[-1]["harm"] += place.clear()
    return told


class NotWell(Exception):
    """An honest submission did not get its points; the text says how it ended."""


class _Place:
    """Who grades, where, and what lies there in all trials.

    Attributes:
        uid, user: who grades.
        path: the home of that user.
        class_: the folder of a class.
        tree: a checkout of the grader.
        secrets: canaries that are the same in all trials.
    """

    def __init__(self, level: levels.Level) -> None:
        self.level = level
        self.uid = level.uid if os.getuid() == 0 else os.getuid()
        self.user = self._name_of_user()
        self.path = Path(pwd.getpwuid(self.uid).pw_dir)
        self.class_, self.tree = self.path / "class", self.path / "checkout"
        self.secrets = {"environment": _secret("environment")}
        self._runner: runners.Runner | None = None

    def _name_of_user(self) -> str:
        with suppress(KeyError):
            return pwd.getpwuid(self.uid).pw_name
        name = levels.NAMES[self.uid]
        with Path("/etc/passwd").open("a") as file:
            file.write(f"{name}:x:{self.uid}:{self.uid}::/home/{name}:/bin/sh\n")
        Path("/home", name).mkdir(parents=True, exist_ok=True)
        return name

    def give_to_user(self) -> None:
        """All that lies in the user's home is the user's."""
        if os.getuid() == 0 and self.uid:
            for each in (self.path, *self.path.rglob("*")):
                os.chown(each, self.uid, self.uid, follow_symlinks=False)

    def runner(self, apart: Collection[int] = ()) -> runners.Runner:
        """Who runs submissions: as before, unless that has ended.

        Args:
            apart: processes that are not its own and no submission's.

        Raises:
            NotWell: it fails an honest submission, which is the first.
        """
        if self._runner is not None and self._runner.is_spent:
            self._end()
        if self._runner is None:
            self._runner = self._start(apart)
        self._runner.apart = set(apart)
        return self._runner

    def clear(self) -> list[str]:
        """What lies about is not for the next one; what was left by who has run submissions."""
        left = self._end()
        for each in Path("/tmp").glob("turtlesim-grader*"):
            with suppress(OSError):
                shutil.rmtree(each) if each.is_dir() and not each.is_symlink() else each.unlink()
        shutil.rmtree(self.tree, ignore_errors=True)
        return left

    def _end(self) -> list[str]:
        left = self._runner.close() if self._runner else []
        self._runner = None
        return [f"left running by the grader itself: {line}" for line in left]

    def _start(self, apart: Collection[int]) -> runners.Runner:
        if self.level == levels.UNCONFINED:
            return runners.Python(self.level, self.uid, self._environment())
        for package in PACKAGES:
            shutil.copytree(ROOT / package, self.tree / package, dirs_exist_ok=True)
        self.class_.mkdir(exist_ok=True)
        started = runners.Grader(
            *(self.level, self.uid, self._environment(), self.tree, self.class_)
        )
        started.apart = set(apart)
        try:
            self.grade_honest(started)
        except NotWell:
            started.close()
            raise
        return started

    def grade_honest(self, runner: runners.Runner) -> None:
        """Have an honest submission graded, which gets its points and leaves nothing.

        Raises:
            NotWell: it does not.
        """
        files = {"honest.py": HONEST, "honest.yaml": "exercise: turtlesim_challenge\n" + MOVES}
        for name, text in files.items():
            (self.class_ / name).write_text(text)
        self.give_to_user()
        out = self.class_ / "graded" / "honest"
        words = ["run", "honest.py", "--exercise", "honest.yaml", "--out", str(out)]
        graded = {**runner.run(words, self.class_), **_result(out)}
        if (graded["code"], graded["score"]) != (0, 100):
            raise NotWell(_short(graded))

    def _environment(self) -> dict[str, str]:
        kept = (
            ("ROS_", "AMENT_", "PYTHONPATH", "LD_LIBRARY_PATH")
            if "ROS_DISTRO" in os.environ
            else ()
        )
        return {
            **{name: value for name, value in os.environ.items() if name.startswith(kept)},
            **dict.fromkeys(TOKENS, self.secrets["environment"]),
            "HOME": str(self.path),
            "USER": self.user,
            "PATH": "/usr/local/bin:/usr/bin:/bin",
            "PYTHONDONTWRITEBYTECODE": "1",
            "TERM": "xterm",
        }


class _Trial:
    """One attack, with canaries of its own."""

    def __init__(self, place: _Place, name: str, layer: int) -> None:
        self._place, self._name, self._layer = place, name, layer
        self._attack = ATTACKS[name]
        self._secrets = dict(place.secrets)
        self._harm: list[str] = []

    def run(self, *, is_followed: bool) -> dict[str, Any]:
        """Grade it, and perhaps an honest one after it."""
        with ExitStack() as held:
            self._bystander = self._start_bystander(held)
            self._runner = self._place.runner([self._bystander.pid])
            self._set_out(held)
            submission = self._hand_in()
            self._place.give_to_user()
            before = self._files()
            out = (submission if self._attack.out else self._place.class_ / "graded") / (
                self._attack.out or "attacker"
            )
            graded = self._grade(submission, out)
            self._look(before, out, graded)
            if is_followed and self._place.level != levels.UNCONFINED:
                self._harm += self._grade_another(before)
            self._clear()
        return {"attack": self._name, "harm": sorted(set(self._harm)), **graded}

    def _grade_another(self, before: dict[str, Any]) -> Iterator[str]:
        """An honest submission; what it suffers from the one before."""
        try:
            # another grader, if the attack has ended the former
            self._place.grade_honest(self._place.runner([self._bystander.pid]))
        except NotWell as why:
            yield f"the next submission: {why}"
        for harm in self._changed(before):
            if harm not in self._harm:
                yield f"later: {harm}"

    # -- what is there --------------------------------------------------------------------------

    def _secret(self, where: str) -> str:
        return self._secrets.setdefault(where, _secret(where))

    def _write(self, path: Path, text: str) -> Path:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        self._canaries.append(path)
        return path

    def _set_out(self, held: ExitStack) -> None:
        home = self._place.path
        shutil.rmtree(home / "class", ignore_errors=True)
        self._canaries: list[Path] = []
        for name in (".netrc", ".ssh/id_ed25519", "notes.txt"):
            self._write(home / name, self._secret("home"))
        neighbour = self._secret("neighbour")
        self._write(home / "class/neighbour/turtle_controller.py", f"SOLUTION = {neighbour!r}\n")
        self._write(home / "class/neighbour.py", f"SOLUTION = {neighbour!r}\n")
        self._write(home / "class/graded/neighbour/result.json", f'"{self._secret("results")}"')
        exercise = f"# {self._secret('exercise')}\nexercise: turtlesim_challenge\n"
        self._write(home / "class/exercise.yaml", exercise + EXERCISES[self._attack.exercise])
        self._tcp = held.enter_context(socket.create_server(("127.0.0.1", 0)))
        self._udp = held.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self._udp.bind(("0.0.0.0", 0))
        self._path = home / "service.sock"
        self._abstract = f"service-{secrets.token_hex(4)}"
        self._unix = []
        self._path.unlink(missing_ok=True)
        for address in (str(self._path), f"\0{self._abstract}"):
            listener = held.enter_context(socket.socket(socket.AF_UNIX))
            listener.bind(address)
            listener.listen()
            self._unix.append(listener)
        for listener in (self._tcp, self._udp, *self._unix):
            listener.setblocking(False)
        self._path.chmod(0o666)

    def _start_bystander(self, held: ExitStack) -> subprocess.Popen[str]:
        words = [sys.executable, "-I", "-S", bystander.__file__, "bystander", self._secret("args")]
        process = held.enter_context(
            subprocess.Popen(
                words,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                env={"COURSE_TOKEN": self._secret("environ")},
                preexec_fn=lambda: levels.become(self._place.level),
            )
        )
        held.callback(process.kill)
        self._address = int(process.stdout.readline())
        return process

    def _hand_in(self) -> Path:
        home, target = self._place, self._place.class_ / "attacker"
        for left in (target.with_suffix(".py"), target.with_suffix(".zip")):
            left.unlink(missing_ok=True)
        known = {
            "HOME": str(home.path),
            "CLASS": str(home.class_),
            "NEIGHBOUR": str(home.class_ / "neighbour/turtle_controller.py"),
            "NEIGHBOURS_RESULT": str(home.class_ / "graded/neighbour/result.json"),
            "OUT": str(home.class_ / "graded/attacker"),
            "SOURCE": str(target / "turtle_controller.py"),
            "EXERCISE": str(home.class_ / "exercise.yaml"),
            "TREE": str(home.tree),
            "TEMP": "/tmp",
            "USER": home.user,
            "UID": home.uid,
            "BYSTANDER": self._bystander.pid,
            "BYSTANDER_ADDRESS": self._address,
            "TCP": self._tcp.getsockname()[1],
            "UDP": self._udp.getsockname()[1],
            "ADDRESS": "127.0.0.1",
            "UNIX": str(self._path),
            "ABSTRACT": self._abstract,
            "TERMINAL": self._runner.terminal.name,
        }
        make = getattr(handed_in, self._attack.make)
        submission: Path = make(target, self._attack.program, known)
        if self._attack.is_second:
            handed_in.as_second(submission)
        if self._attack.beside:
            (submission / self._attack.beside).touch()
        return submission

    # -- a grading ------------------------------------------------------------------------------

    def _grade(self, submission: Path, out: Path) -> dict[str, Any]:
        """Call the real command line, as the user."""
        folder = self._place.class_
        if self._place.level == levels.UNCONFINED:
            words = [str(submission / "turtle_controller.py")]
        else:
            words = ["run", str(submission), "--exercise", "exercise.yaml", "--out", str(out)]
            words += ["--time", self._attack.time]
        return {**self._runner.run(words, folder), **_result(out)}

    # -- what has changed -----------------------------------------------------------------------

    def _look(self, before: dict[str, Any], out: Path, graded: dict[str, Any]) -> None:
        harm = self._harm
        harm += [f"left running: {line}" for line in graded.pop("left")]
        if graded["hung"]:
            harm.append("the grading never ended")
        elif graded["code"] not in self._attack.codes:
            harm.append(f"the grader failed: {_short(graded)}")
        said = graded["said"].encode() + b"".join(
            each.read_bytes() for each in out.rglob("*") if each.is_file() and not each.is_symlink()
        )
        # where nothing could be graded the folder is what was handed in
        links = [str(each) for each in out.rglob("*") if each.is_symlink() and graded["code"] != 2]
        harm += [f"a link among the results: {link}" for link in links]
        harm += [
            f"told a secret: {where}" for where, it in self._secrets.items() if it.encode() in said
        ]
        with suppress(OSError):
            graded["printed"] = (out / "output.txt").read_text(errors="replace")[:4000]
        harm += achieved(said)
        if "\033" in graded["said"] or "\x9b" in graded["said"]:
            harm.append("an escape on the grader's own streams")
        for name, most in (("most_memory", MOST_MEMORY), ("most_processes", MOST_PROCESSES)):
            if graded[name] > most:
                harm.append(f"took too much: {name} {graded[name]}")
        if graded.get("size", 0) > MOST_RESULTS:
            harm.append(f"results of {graded['size']} bytes")
        harm += self._heard()
        harm += self._changed(before)
        if text := self._runner.terminal.written():
            harm.append(f"wrote to the terminal: {text!r}")
        if text := self._runner.terminal.typed():
            harm.append(f"typed into the terminal: {text!r}")
        harm += self._asked_bystander()

    def _heard(self) -> Iterator[str]:
        for name, listener in (("TCP", self._tcp), *(("unix", each) for each in self._unix)):
            with suppress(BlockingIOError):
                listener.accept()[0].close()
                yield f"a service was reached: {name}"
        with suppress(BlockingIOError):
            yield f"a service was told by UDP: {self._udp.recv(100)!r}"

    def _asked_bystander(self) -> Iterator[str]:
        """Whether it still answers: what was sent to it may reach it after the grading's end."""
        process = self._bystander
        with suppress(BrokenPipeError):
            os.write(process.stdin.fileno(), b"?\n")
        while not select.select((process.stdout,), (), (), LOOK_S)[0]:
            if (found := linux.process_stat(process.pid)).is_stopped:
                yield f"another process was ended or stopped: {found.state}"
                process.kill()
                return
        answer = process.stdout.readline().strip()
        if not answer:  # it has closed its end, and so has come to its own
            yield f"another process was ended or stopped: {process.wait()}"
        elif answer != "True []":
            yield f"another process was changed or signalled: {answer}"

    def _files(self) -> dict[str, Any]:
        """Everything that was written in this container, and what lies in shared memory."""
        found: dict[str, Any] = {}
        layers = Path(f"/proc/self/fd/{self._layer}")
        tops = [(layer / "upper", "/" + layer.name.replace("!", "/")) for layer in layers.iterdir()]
        for base, top in (*tops, (Path("/dev/shm"), "/dev/shm")):
            for folder, folders, files in os.walk(base):
                place = top + folder[len(str(base)) :]
                for name in (*files, *folders):
                    with suppress(OSError):
                        entry = os.lstat(f"{folder}/{name}")
                        kind = stat.S_IFMT(entry.st_mode)
                        same = (entry.st_mtime_ns, entry.st_size) if not stat.S_ISDIR(kind) else ()
                        found[f"{place}/{name}"] = (kind, entry.st_mode, entry.st_uid, *same)
        found.update({str(each): () for each in Path("/").iterdir()})
        for kind in ("shm", "sem", "msg"):
            with suppress(OSError):
                for line in Path(f"/proc/sysvipc/{kind}").read_text().splitlines()[1:]:
                    found[f"{kind} {line.split()[0]}"] = ()
        with suppress(OSError):
            found.update({f"queue {each.name}": () for each in Path("/dev/mqueue").iterdir()})
        return found

    def _changed(self, before: dict[str, Any]) -> list[str]:
        after = self._files()
        changed = {
            path for path in before.keys() | after.keys() if before.get(path) != after.get(path)
        }
        return [f"changed: {path}" for path in sorted(changed) if not self._is_ours(path, after)][
            :40
        ]

    def _is_ours(self, path: str, after: dict[str, Any]) -> bool:
        """Whether a grading may leave this: results, and empty files for locks."""
        class_ = self._place.class_
        ours = [f"{class_}/graded/attacker", f"{class_}/graded/honest"]
        ours.append("/dev/shm/lttng-ust-wait-")  # of every process with rclpy in it
        if self._attack.out:
            ours.append(f"{class_}/attacker/{self._attack.out}")
        if path.startswith(tuple(ours)) or path in (f"{class_}/honest.py", f"{class_}/honest.yaml"):
            return True
        parts = Path(path).parts
        if parts[:2] == ("/", "tmp") and len(parts) > 2 and parts[2].startswith("turtlesim-grader"):
            kind = after.get(path, (stat.S_IFREG,))[0]
            if len(parts) == 3:
                return bool(kind == stat.S_IFDIR)
            return kind == stat.S_IFDIR or (kind == stat.S_IFREG and path.endswith(".lock"))
        return False

    def _clear(self) -> None:
        """What lies about is not for the next trial."""
        for place in ("/dev/shm", "/tmp", "/var/tmp", "/run"):
            for each in Path(place).glob("*attack*"):
                with suppress(OSError):
                    each.unlink() if not each.is_dir() or each.is_symlink() else shutil.rmtree(each)
        with suppress(OSError):
            each_home = self._place.path
            for name in (".bash_login", "attacked", "owned", ".ssh2", "pictures"):
                shutil.rmtree(each_home / name, ignore_errors=True)
                (each_home / name).unlink(missing_ok=True)
        subprocess.run(["ipcrm", "--all"], check=False, capture_output=True)


def achieved(said: bytes) -> list[str]:
    """What an attack says that it has achieved, in whatever was printed or written."""
    lines = (re.sub(rb"^\[\S+\] ", b"", line) for line in said.split(b"\n"))
    lines = (line for line in lines if line.startswith(b"ACHIEVED "))
    lines = (line for line in lines if b"&#" not in line)  # the page says it again
    return [
        f"achieved: {line.decode(errors='replace')[:160]}"
        for line in sorted({b" ".join(line.split(b" ")[1:8]) for line in lines})[:40]
        if not line.startswith((b"environment", b"getenv", b"None"))
    ]


def _result(out: Path) -> dict[str, Any]:
    """What the result file says; `size` is that of all files."""
    nothing: dict[str, Any] = {"score": None, "passed": [], "outcome": "", "isolation": ""}
    path = out / "result.json"
    if path.is_symlink() or not path.is_file():
        return nothing
    try:
        result = json.loads(path.read_text())
        run = result["run"]
        return {
            "score": result["score"],
            "passed": [each["check"] for each in result["verdicts"] if each["status"] == "passed"],
            "outcome": run["outcome"],
            "isolation": run["isolation"],
            "size": sum(each.stat().st_size for each in out.rglob("*") if each.is_file()),
        }
    except (ValueError, KeyError) as error:
        return {**nothing, "outcome": f"no result: {error!r}"}


def _secret(where: str) -> str:
    return f"CANARY-{where}-{secrets.token_hex(8)}"


def _short(graded: dict[str, Any]) -> str:
    words = [f"{name} {graded[name]}" for name in ("code", "score", "hung")]
    return f"{', '.join(words)}: {graded['said'][-600:]}"
