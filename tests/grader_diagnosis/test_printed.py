from tests.grader.recording.test_printed import CODE
from tests.limited import printed_by


def test_an_output_is_gone_through_once():
    code = CODE.replace("LOOKS", "(thread_exception,)")
    assert printed_by(f"from grader_diagnosis.crash import thread_exception{code}") == "done\n"
