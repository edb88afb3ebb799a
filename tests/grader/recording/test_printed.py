"""What a node has printed may be made to be hard to read."""

from tests.limited import printed_by

CODE = """
limit(4, 4_000_000_000)
for hard in (
    "\\n" * 65_000,
    " " * 65_000,
    ' File "' * 10_000,
    '\\n  File "a", line ' * 4_000,
    '\\n  File "a", line 1' * 4_000,
    "Exception in thread a:\\nTraceback \\n a\\n" * 1_500,
    "The 'a' field must" * 3_000,
):
    text = "Traceback (most recent call last)" + hard
    for look in LOOKS:
        look(text)
print("done")
"""


def test_an_output_is_gone_through_once():
    code = CODE.replace("LOOKS", "(last_exception,)")
    assert printed_by(f"from grader.recording.observations import last_exception{code}") == "done\n"
