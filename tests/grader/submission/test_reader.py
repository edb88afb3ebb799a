"""Whatever is handed in, reading it takes no more than its limits, and nothing of the grader's own.

Each of these has once taken minutes, gigabytes or the grader's process.
"""

import json
import os
import socket
import zipfile
from dataclasses import replace

import pytest

from grader.errors import GraderFailure, SubmissionError
from grader.run.opening import open_submission
from grader.submission import reader
from grader.submission.program import EntryPoint
from tests.files import lay
from tests.limited import printed_by
from tests.tiers import others_are_more

NODE = "def main():\n    pass\n"


@pytest.fixture(autouse=True)
def inspection():
    """Confined, as in a run: here it has to be."""


SETUP = (
    "from setuptools import setup\n"
    "setup(entry_points={{'console_scripts': ['turtle_controller = pkg.node:main']}}, x={})\n"
)
#: Opens what it is given, in a process that may itself take a second and 900 MB.
OPEN = """
import json, pathlib
from grader.errors import SubmissionError
from grader.run.opening import open_submission
from grader.submission import reader
limit(1, 900_000_000)  # the copy that reads has the memory of both
try:
    with open_submission(pathlib.Path(sys.argv[1])) as found:
        print(json.dumps(["found", str(found.found)]))
except SubmissionError as error:
    print(json.dumps(["refused", str(error)]))
"""


def opened(path):
    """How the reading of a submission ended: found or refused, and its sentence."""
    how, sentence = json.loads(printed_by(OPEN, path))
    return how, sentence


def inspected(path):
    """The same of a package, with its notes: what inspects it has limits of its own."""
    try:
        with open_submission(path) as found:
            return "found", "; ".join(map(str, (found.found, *found.notes)))
    except SubmissionError as error:
        return "refused", str(error)


def package(root, setup, **more):
    files = {"setup.py": setup, "pkg/__init__.py": "", "pkg/node.py": NODE}
    return lay(root, files | more)


def doubling(plus, times=60):
    lines = [f"a{i + 1} = {plus.format(f'a{i}')}\n" for i in range(times)]
    return "a0 = 'aa'\n" + "".join(lines) + SETUP.format(f"a{times}")


@pytest.mark.more("seconds; sums of sums stand for what takes memory")
def test_a_table_with_keys_of_keys_of_keys_takes_the_memory_of_a_step_alone(tmp_path):
    lay(tmp_path, {"pyproject.toml": ".".join(["a"] * 20_000) + " = 1\n", "node.py": NODE})
    how, sentence = inspected(tmp_path)
    assert (how, sentence.partition(";")[0]) == ("found", "function main of node.py")


@pytest.mark.parametrize(
    ("limit", "words"),
    [("cpu_s", "takes more than 1 s of a processor's time"), ("wall_s", "takes more than 1 s")],
)
def test_what_takes_too_long_is_refused_by_the_time_that_it_takes(
    tmp_path, monkeypatch, limit, words
):
    monkeypatch.setattr(reader, "LIMITS", replace(reader.LIMITS, **{limit: 1.0}))
    (tmp_path / "node.py").write_text("x = 1\n" * 150_000)
    how, sentence = inspected(tmp_path / "node.py")
    assert (how, f"{words}. " in sentence) == ("refused", True)


#: Set-up files that no parser takes.
UNREADABLE = {
    "parentheses": "(" * 400_000,
    "sums": SETUP.format("'a'" + "+'a'" * 200_000),
    "a coding": f"# coding: {'a' * 900_000}",
}
#: Set-up files whose values grow without end -> words of the note.
GROWING = {
    "sums of sums": (doubling("{0} + {0}"), "setup.py needed more memory"),
    "lists of lists": (doubling("[{0}, {0}]"), "console script"),
    "products": ("x = 'a' * 2 ** 40", "setup.py needed more memory"),
}
#: What stands behind a node that is hard to read.
HARD = {
    "a chain of comparisons": "<".join(["a"] * 100_000),
    "a package in a package": "import " + ".".join(["a"] * 100_000),
}
ONE_PARSER = "the same parser, another way to trouble it"


@pytest.mark.parametrize("name", others_are_more(ONE_PARSER, UNREADABLE, "parentheses", "a coding"))
def test_a_set_up_file_that_no_parser_takes_is_named_in_one_line(tmp_path, name):
    how, sentence = inspected(package(tmp_path, UNREADABLE[name]))
    assert how == "found"
    said = "function main of pkg/node.py; colcon would not build this: setup.py"
    assert sentence.startswith(said)
    assert sentence.isprintable()
    assert len(sentence) < 600


@pytest.mark.parametrize("name", others_are_more(ONE_PARSER, GROWING, "sums of sums"))
def test_values_that_grow_without_end_take_the_memory_of_a_step_alone(tmp_path, name):
    setup, words = GROWING[name]
    how, sentence = inspected(package(tmp_path, setup))
    assert how == "found"
    assert words in sentence


@pytest.mark.parametrize("name", others_are_more(ONE_PARSER, HARD, "a chain of comparisons"))
def test_a_node_that_is_hard_to_read_is_found_or_refused_and_takes_nothing_of_ours(tmp_path, name):
    (tmp_path / "node.py").write_text(NODE + HARD[name])
    how, sentence = opened(tmp_path / "node.py")
    assert "node.py" in sentence
    assert how == "found" or "node.py cannot be read: that takes more than" in sentence


def test_whether_a_file_that_does_not_parse_starts_itself_is_guessed_in_one_go(tmp_path):
    (tmp_path / "a.py").write_text("if " + "__name__ '__main' " * 50_000 + "\n(")
    code = """
from pathlib import Path
from grader.submission.python_source import read_source
limit(2, 2_000_000_000)
print(read_source(Path(sys.argv[1])).has_guard)
"""
    assert printed_by(code, tmp_path / "a.py") == "False\n"


def test_600_000_members_are_refused_before_any_is_looked_at(tmp_path):
    archive = tmp_path / "a.zip"
    name = b"a/"
    entry = b"PK\x01\x02" + bytes(24) + len(name).to_bytes(2, "little") + bytes(16) + name
    size = 600_000 * len(entry)
    end = b"PK\x05\x06" + bytes(4) + b"\xff" * 4 + size.to_bytes(4, "little") + bytes(4) + bytes(2)
    archive.write_bytes(entry * 600_000 + end)
    assert opened(archive) == (
        "refused",
        "a.zip cannot be unpacked as a zip file: its list has more than 6 MB. Pack your .py "
        "file or package folder into a new .zip and hand that in.",
    )


def test_a_member_below_32_000_folders_is_refused(tmp_path):
    archive = tmp_path / "a.zip"
    with zipfile.ZipFile(archive, "w") as packed:
        for number in range(50):
            packed.writestr("a/" * 32_000 + str(number), "")
    how, sentence = opened(archive)
    assert (how, "a name of 64,001 characters" in sentence) == ("refused", True)
    assert len(sentence) < 600


def test_a_name_that_is_near_thousands_of_others_is_compared_with_some(tmp_path):
    package(tmp_path, SETUP.format("1").replace("pkg.node", "ab" * 45))
    for number in range(1_000):
        bits = "".join("ab"[number >> bit & 1] for bit in range(12))
        (tmp_path / f"{bits * 7}.py").write_text(NODE)
    how, sentence = inspected(tmp_path)
    assert how == "refused"
    assert "but there is no file " in sentence


def test_what_is_no_file_is_passed_over(tmp_path):
    package(tmp_path, SETUP.format("1"))
    os.mkfifo(tmp_path / "setup.cfg")
    os.mkfifo(tmp_path / "pkg" / "pipe.py")
    (tmp_path / "pyproject.toml").symlink_to("/dev/zero")
    (tmp_path / "pkg" / "zero.py").symlink_to("/dev/zero")
    (tmp_path / "loop").symlink_to("loop")
    with socket.socket(socket.AF_UNIX) as listening:
        os.chdir(tmp_path / "pkg")  # a socket's path is short
        try:
            listening.bind("s.py")
        finally:
            os.chdir("/")
    (tmp_path / os.fsdecode(b"\xff[b]\n::error::x.py")).write_text(NODE)
    how, sentence = inspected(tmp_path)
    assert how == "found"
    assert sentence.startswith("console script turtle_controller in setup.py")


def test_300_levels_and_names_of_250_bytes_are_not_gone_through(tmp_path):
    here = os.open(tmp_path, os.O_RDONLY)
    for _ in range(300):
        os.mkdir("d" * 250, dir_fd=here)
        below = os.open("d" * 250, os.O_RDONLY, dir_fd=here)
        os.close(here)
        here = below
    os.close(here)
    try:
        how, sentence = opened(tmp_path)
        # the first folder that the system does not reach by a path, or a file that would be in it
        too_long = "File name too long. Shorten its name" in sentence
        assert how == "refused"
        assert too_long or "no Python file that could be the node" in sentence
        (tmp_path / "node.py").write_text(NODE)
        if not too_long:
            assert opened(tmp_path) == ("found", "function main of node.py")
    finally:
        os.system(f"rm -rf '{tmp_path}'")  # Python's own way down is one of paths


@pytest.mark.parametrize("name", ["setup.py", "setup.cfg", "pkg/node.py", "launch/a.launch.py"])
def test_a_link_to_a_place_outside_is_not_read(tmp_path, name):
    secret = tmp_path / "secret"
    secret.write_text("password = hunter2\n")
    handed_in = package(tmp_path / "in", SETUP.format("1"), **{"launch/README": ""})
    (handed_in / name).unlink(missing_ok=True)
    (handed_in / name).symlink_to(secret)
    how, sentence = inspected(handed_in)
    assert how == "refused"
    assert f"{name} is a link to a place outside of in" in sentence
    assert "hunter2" not in sentence


HOSTILE = ["[/b]", "\x1b[31m", "\n::error::boo", os.fsdecode(b"\xff"), "\u202e", "a" * 250]


@pytest.mark.parametrize("name", HOSTILE)
def test_a_name_is_shown_in_one_line_without_controls(tmp_path, name):
    lay(tmp_path, {f"{name}1/a.txt".replace("/b", "b"): "", "b.txt": ""})
    (tmp_path / f"{name[:200].replace('/', '')}.md").touch()
    how, sentence = inspected(tmp_path)
    assert how == "refused"
    assert sentence.isprintable()


def test_a_console_script_s_name_is_shown_in_one_line(tmp_path):
    entries = "['a\\n::error::x\\x1b[31m = pkg.node:main', 'b = pkg.node:main']"
    head = "from setuptools import setup\n"
    package(tmp_path, f"{head}setup(entry_points={{'console_scripts': {entries}}})")
    how, sentence = inspected(tmp_path)
    assert (how, sentence.isprintable()) == ("refused", True)
    assert "a : :error::x, b" in sentence


def test_folders_that_cannot_be_are_no_fault_of_ours(tmp_path):
    package(tmp_path, SETUP.format("1, package_dir={'': '\\0', 'pkg': 'loop/pkg'}"))
    (tmp_path / "loop").symlink_to("loop")
    assert inspected(tmp_path)[0] == "refused"


def test_a_copy_that_dies_is_no_fault_of_the_submission_s(tmp_path, monkeypatch):
    (tmp_path / "node.py").write_text(NODE)
    monkeypatch.setattr(reader, "find", lambda *_: os._exit(7))
    with pytest.raises(GraderFailure, match="exit code 7"), open_submission(tmp_path / "node.py"):
        pass
    monkeypatch.undo()
    with open_submission(tmp_path / "node.py") as found:
        assert found.entry == EntryPoint("node", "main")


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b'{"name": 1}\n',
        b'{"found": {"name": "", "root": "", "found": "", "start": {"x": 1}}}\n',
        b'{"whose": "grader", "refused": ""}\n',
        b'{"failed": "Traceback"}\n',
        b"[" * 100_000 + b"\n",
    ],
)
def test_an_answer_that_makes_no_sense_is_the_grader_s_failure(answer):
    with pytest.raises(GraderFailure):
        reader.decoded(answer).submission()
