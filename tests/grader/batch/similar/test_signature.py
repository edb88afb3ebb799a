"""What strangers hand in is read within limits, never run, and what is kept of it is read back."""

import os

import pytest

from grader.batch.similar import signature, sources
from grader.batch.similar.signature import Signature
from tests.grader.batch.similar.classes import hand_in, text
from tests.grader.driving import Spiral, drive


def read(entry):
    found = signature.read(entry.folder)
    assert found is not None
    return found


HOSTILE = {
    "nul": b"x = 1\0\n",
    "latin_1_undeclared": "# d\xe9j\xe0\nx = 'é'\n".encode("latin-1"),
    "parentheses": b"(" * 100_000 + b")" * 100_000,
    "brackets_and_minus": b"x = " + b"-" * 300_000 + b"1\n",
    "not_python": os.urandom(5000),
    "blocks": "\n".join(" " * n + "if x:" for n in range(200)).encode(),
    "unterminated": b"x = '''" + b"a" * 500_000,
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_what_cannot_be_parsed_is_told_and_what_lies_beside_it_is_compared(tmp_path, kind):
    files = {"bad.py": HOSTILE[kind], "good.py": text("functions")}
    found = read(hand_in(tmp_path / "out", "mallory", files))
    problems = {file.name: bool(file.problem) for file in found.files}
    assert problems == {"bad.py": True, "good.py": False}
    assert {found.files[each.file].name for each in found.prints} == {"good.py"}


def test_a_file_in_a_declared_encoding_is_read(tmp_path):
    data = "# -*- coding: latin-1 -*-\ndef f(a):\n    return a + len('é') * 2 + len(a) - 1\n"
    found = read(hand_in(tmp_path / "out", "rené", {"a.py": data.encode("latin-1")}))
    assert found.prints and not found.files[0].problem


def test_what_is_too_much_is_left_out_and_counted(tmp_path):
    files = {f"f{n}.py": f"x = {n}\n" for n in range(sources.MOST_FILES + 5)}
    files["large.py"] = "x = 1\n" * 2_000_000
    found = read(hand_in(tmp_path / "out", "mallory", files))
    assert (len(found.files), found.left_out) == (sources.MOST_FILES, 6)


def test_a_source_of_very_many_words_has_a_bounded_signature(tmp_path):
    lines = "\n".join(f"f{n}(a.b{n}, {n}, [c{n}])" for n in range(8_000))
    entry = hand_in(tmp_path / "out", "mallory", {"a.py": lines})
    assert len(read(entry).prints) <= signature.MOST_PRINTS
    assert (entry.folder / signature.NAME).stat().st_size < 500_000


def test_after_some_that_take_too_much_no_more_are_tried(tmp_path, monkeypatch):
    def endless(tree, modules):
        while True:
            pass

    monkeypatch.setattr(signature, "units", endless)
    monkeypatch.setattr(signature, "PARSING", signature.Limits(cpu_s=0.2))
    files = {f"f{n}.py": "x = 1\n" for n in range(5)}
    found = read(hand_in(tmp_path / "out", "mallory", files))
    assert [file.problem[:9] for file in found.files] == ["parsing i"] * 2 + ["not tried"] * 3


def test_nothing_is_run(tmp_path):
    trap = tmp_path / "ran"
    hand_in(tmp_path / "out", "mallory", {"a.py": f"open({str(trap)!r}, 'w')\n"})
    assert not trap.exists()


def test_a_link_out_of_what_was_handed_in_is_not_followed(tmp_path):
    secret = tmp_path / "secret.py"
    secret.write_text("x = 1\n")
    copy = tmp_path / "copy"
    copy.mkdir()
    (copy / "a.py").symlink_to(secret)
    sources.keep(copy, tmp_path / "source")
    assert sources.kept(tmp_path / "source") == []


def test_names_that_a_system_may_not_take_are_changed_and_none_is_lost(tmp_path):
    copy = tmp_path / "copy"
    copy.mkdir()
    for name in ("a b.py", "a_b.py", "-rf.py", "é\n.py", "A_B.py"):
        (copy / name).write_text(f"# {name!r}\n")
    sources.keep(copy, tmp_path / "source")
    kept = [file.name for file in sources.kept(tmp_path / "source")]
    assert len({name.lower() for name in kept}) == 5
    assert all(name.isascii() and name.isprintable() and name[0] not in ".-" for name in kept)


def test_it_comes_back_as_it_was_and_the_same_makes_the_same_bytes(tmp_path):
    recording = drive(Spiral(), 2000)
    one = hand_in(tmp_path / "out", "alice", {"a.py": text("quick")}, recording)
    other = hand_in(tmp_path / "out", "bob", {"a.py": text("quick")}, recording)
    data = (one.folder / signature.NAME).read_bytes()
    assert data == (other.folder / signature.NAME).read_bytes()
    found = Signature.of_bytes(data)
    assert found.to_bytes() == data
    assert found.commands[0].tick == 0 and len(found.path) == 2 * signature.POINTS
    assert found.path[:2] == (0, 0)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{}",
        b"[" * 100_000,
        b'{"schema":"turtlesim-grader/similar/v1"}',
        b'{"schema":"turtlesim-grader/similar/v1","files":[],"prints":[[1,0,1,1]],"commands":[],'
        b'"path":[],"left_out":0}',
        b'{"schema":"turtlesim-grader/similar/v1","files":[],"prints":[],"commands":[[1,true]],'
        b'"path":[],"left_out":0}',
        b'{"schema":"turtlesim-grader/similar/v1","files":[],"prints":[],"commands":[],'
        b'"path":[1,2],"left_out":0}',
        b"\xff",
    ],
)
def test_what_is_none_of_ours_is_refused(data):
    with pytest.raises(ValueError):
        Signature.of_bytes(data)
