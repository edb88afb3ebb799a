"""What strangers hand in is kept within limits, never run, and what is kept of it is read back."""

import pytest

from grader.batch.similar import behaviour, sources
from grader.batch.similar.behaviour import Behaved
from tests.grader.batch.similar.classes import hand_in, text
from tests.grader.driving import Spiral, drive


def read(entry):
    found = behaviour.read(entry.folder)
    assert found is not None
    return found


def test_what_is_too_much_is_left_out_and_counted(tmp_path):
    files = {f"f{n}.py": f"x = {n}\n" for n in range(sources.MOST_FILES + 5)}
    files["large.py"] = "x = 1\n" * 2_000_000
    found = read(hand_in(tmp_path / "out", "mallory", files))
    assert (len(found.files), found.left_out) == (sources.MOST_FILES, 6)


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
    data = (one.folder / behaviour.NAME).read_bytes()
    assert data == (other.folder / behaviour.NAME).read_bytes()
    found = Behaved.of_bytes(data)
    assert found.to_bytes() == data
    assert found.commands[0].tick == 0 and len(found.path) == 2 * behaviour.POINTS
    assert found.path[:2] == (0, 0)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{}",
        b"[" * 100_000,
        b'{"schema":"turtlesim-grader/similar/v2"}',
        b'{"schema":"turtlesim-grader/similar/v2","files":[["a.py",1]],"commands":[],'
        b'"path":[],"left_out":0}',
        b'{"schema":"turtlesim-grader/similar/v2","files":[],"commands":[[1,true]],'
        b'"path":[],"left_out":0}',
        b'{"schema":"turtlesim-grader/similar/v2","files":[],"commands":[],'
        b'"path":[1,2],"left_out":0}',
        b"\xff",
    ],
)
def test_what_is_none_of_ours_is_refused(data):
    with pytest.raises(ValueError):
        Behaved.of_bytes(data)
