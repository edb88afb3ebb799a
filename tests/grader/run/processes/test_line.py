"""The simulator's process gets its end of the line."""

from grader.run.processes.line import Line, take_up


def test_what_one_end_says_the_other_hears() -> None:
    with Line() as line:
        (theirs,) = line.fds
        assert line.word == str(theirs)
        with take_up(line.word) as other:
            other.sendall(b"ready")
            with line.connect() as ours:
                assert ours.recv(5) == b"ready"
            other.detach()
