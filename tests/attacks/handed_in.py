"""What is handed in: for most attacks a folder with a file; for some, the folder is the attack.

A function here makes a submission and returns what the grader is told to grade. It gets the
attack's folder, which is `attacker` in the class's, its program, and what that may know.
"""

import os
import shutil
import socket
import zipfile
from collections.abc import Mapping
from pathlib import Path

SUBMISSIONS = Path(__file__).with_name("submissions")
Known = Mapping[str, object]
EMPTY = "import rclpy\n"
#: What reads these may go to and fro; today's answer is at once, yesterday's took minutes.
MANY = 30_000


def folder(target: Path, program: str, known: Known) -> Path:
    """A folder with one program, beside it `tools` and `known`: where the canaries are."""
    target.mkdir()
    (target / "turtle_controller.py").write_text(program)
    shutil.copy(SUBMISSIONS / "tools.py", target)
    (target / "known.py").write_text("".join(f"{name} = {known[name]!r}\n" for name in known))
    return target


def as_second(target: Path) -> None:
    """Make a folder with one program a package whose launch file starts another before it."""
    shutil.copytree(SUBMISSIONS / "second", target, dirs_exist_ok=True)


def single(target: Path, program: str, known: Known) -> Path:
    """A single file, in the folder of all that was handed in."""
    path = target.parent / f"{target.name}.py"
    path.write_text(program)
    return path


def _folder_with(target: Path, text: str = EMPTY, **files: str) -> Path:
    target.mkdir()
    (target / "turtle_controller.py").write_text(text)
    for name, content in files.items():
        (target / name.replace("_dot_", ".")).write_text(content)
    return target


def does_not_parse(target: Path, program: str, known: Known) -> Path:
    """Does not parse, and says `__name__` all over."""
    return _folder_with(target, 'if (((__name__ == "' + "if __name__ " * MANY + "\n")


def is_nested(target: Path, program: str, known: Known) -> Path:
    """A setup.py so deep and so doubled that reading it takes all the memory."""
    deep = "x = " + "(" * 5000 + ")" * 5000 + "\n"
    doubled = "a0 = ['x'] * 10\n" + "".join(f"a{n + 1} = a{n} + a{n}\n" for n in range(60))
    setup = f"from setuptools import setup\n{doubled}setup(name=a60, entry_points=a60)\n"
    _folder_with(target, setup_dot_py=setup, package_dot_xml="<package><name>a</name></package>")
    (target / "deep.py").write_text(deep)
    (target / "chain.py").write_text("x = 0" + " < 0" * MANY)
    (target / "attributes.py").write_text("x = y" + ".z" * MANY)
    return target


def has_a_long_key(target: Path, program: str, known: Known) -> Path:
    """A pyproject.toml whose one key has 20,000 parts."""
    return _folder_with(
        target, pyproject_dot_toml="[project]\n" + ".".join(["a"] * 20_000) + " = 1\n"
    )


def holds_no_files(target: Path, program: str, known: Known) -> Path:
    """FIFOs, sockets, links to devices and to itself, deep folders, names that are no text."""
    _folder_with(target)
    for place in (target, target / "package"):
        place.mkdir(exist_ok=True)
        os.mkfifo(place / "setup.cfg")
        os.mkfifo(place / "a.py")
        (place / "setup.py").symlink_to("/dev/zero")
        (place / "package.xml").symlink_to("/dev/zero")
        (place / "pyproject.toml").symlink_to("pyproject.toml")
        (place / "loop").symlink_to(".")
        (place / "root").symlink_to("/")
    os.chdir(target / "package")
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind("s.py")
    Path(os.fsdecode(b"\xff\xfe\x9b31m\n.py")).write_text(EMPTY)
    Path("n" * 250 + ".py").write_text(EMPTY)
    for number in range(2000):
        Path(f"f{number}.py").touch()
    for _ in range(300):
        Path("d").mkdir()
        os.chdir("d")
    os.chdir("/")
    return target


def is_called_by_markup(target: Path, program: str, known: Known) -> Path:
    """Names that terminals, markup and CI systems obey."""
    (target / "[" / "b]").mkdir(parents=True)
    path = target / "[" / "b]" / "\033[31m::error::[red]\u202e.py"
    path.write_text("raise RuntimeError('[/b][bold]\\033[2J')\n")
    return path


def has_results_already(target: Path, program: str, known: Known) -> Path:
    """Where the results will be there is something already: links to what is not the student's."""
    _folder_with(target, "print('attacked')\n")
    out = target / "graded"
    out.mkdir()
    home = target.parents[1]
    for name in ("output.txt", "result.json", "report.html", "canvas.png"):
        (out / name).symlink_to(home / "notes.txt")
    (out / "recording").symlink_to(home / ".ssh")
    return target


def is_a_hostile_archive(target: Path, program: str, known: Known) -> Path:
    """Paths that lead out, links, a bomb, and more entries than anybody reads."""
    path = target.parent / f"{target.name}.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("turtle_controller.py", EMPTY)
        archive.writestr("../../.bash_login", "attacked")
        archive.writestr("/tmp/attack-unpacked", "attacked")
        link = zipfile.ZipInfo("link")
        link.external_attr = 0o120777 << 16
        archive.writestr(link, "../../..")
        archive.writestr("link/.bash_login", "attacked")
        archive.writestr("bomb.py", b"\0" * (64 << 20))
        for number in range(20_000):
            archive.writestr(f"e{number}", b"")
    return path
