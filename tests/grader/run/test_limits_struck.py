"""What a submission takes too much of is refused, or ends it, and the recording says what."""

import pytest

from grader.run.finish import limits_struck
from grader.run.limits import LIMITS, size
from grader.text.message import NOTHING, msg
from tests.tiers import others_are_more

OUTPUT = 'Traceback (most recent call last):\n  File "node.py", line 7, in <module>\n'


by_the_guard = pytest.mark.more("test_limits_guard strikes these limits without a run")


@by_the_guard
@pytest.mark.parametrize("name", ["fills_memory", "fills_shared_memory"])
def test_memory_that_is_really_used_ends_the_run(recorded, name):
    run = recorded(f"limits/{name}").run
    said = f"used more than {size(LIMITS.family_bytes)} of memory"
    assert (run.outcome, run.exit_code) == ("killed", -9)
    assert any(said in str(flag) for flag in run.flags)


@pytest.mark.more("four seconds; a long output is read below")
def test_an_output_without_end_ends_the_run(recorded):
    run = recorded("limits/logs_a_flood").run
    assert run.outcome == "killed"
    said = f"printed more than {size(LIMITS.output_bytes)}"
    assert any(said in str(flag) for flag in run.flags)


REFUSED = {
    "asks_for_memory": f"MemoryError: one process may ask for {size(LIMITS.data_bytes)}",
    "opens_files": f"[Errno 24]: a process may have {LIMITS.open_files} open files",
    "writes_a_large_file": f"[Errno 27]: a file may have {size(LIMITS.file_bytes)}",
}


@pytest.mark.parametrize("name", others_are_more("one is kept", REFUSED, "asks_for_memory"))
def test_what_is_refused_is_told_with_the_limit(recorded, name):
    run = recorded(f"limits/{name}").run
    assert run.outcome == "crashed"
    assert any(REFUSED[name] in str(flag) for flag in run.flags), run.flags


@by_the_guard
@pytest.mark.parametrize("name", ["starts_processes", "starts_threads"])
def test_processes_and_threads_are_counted_together(recorded, name):
    flags = recorded(f"limits/{name}").run.flags
    assert any(f"{LIMITS.tasks} processes and threads" in str(flag) for flag in flags), flags


def test_of_a_long_output_the_middle_is_left_out_and_its_length_told(recorded):
    recording = recorded("limits/prints_without_end")
    first, told, last = recording.output.partition("[... 19934464 bytes left out ...]")
    assert told
    assert first.startswith("000000 xxx")
    assert last.endswith("xxx\n")
    assert recording.run.outcome == "exited"


def test_what_was_seen_from_outside_goes_before_what_a_program_says():
    said, much = f"{OUTPUT}MemoryError\n", msg("the node used too much")
    assert limits_struck(1, said, much) == (much,)
    assert limits_struck(0, said, NOTHING) == ()
    assert limits_struck(None, said, NOTHING) == ()
    assert "MemoryError" in str(limits_struck(1, said, NOTHING)[0])


def test_a_signal_that_the_kernel_sends_is_told():
    assert "processor time" in str(limits_struck(-24, "", NOTHING)[0])
    assert "64 MiB" in str(limits_struck(-25, "", NOTHING)[0])
    assert limits_struck(-9, "", NOTHING) == ()


def test_only_the_last_lines_are_looked_at_and_no_more_than_a_few():
    assert limits_struck(1, "MemoryError\n" + "x\n" * 100, NOTHING) == ()
    assert limits_struck(1, "MemoryError\n" + "x" * 100_000, NOTHING) == ()
    assert limits_struck(1, "not a MemoryError\n", NOTHING) == ()
