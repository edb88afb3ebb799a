"""Bytes that Python refuses are told with file and line, and are not run as if they were right."""

import os
import subprocess
import sys

import pytest

from grader.run.opening import open_submission
from grader.run.student import loading
from grader.submission.program import EntryPoint, Script
from grader.submission.python_source import byte_fault
from tests.grader.submission.copies import in_place

NODE = b"import rclpy\n\n\ndef main(args=None):\n    rclpy.init(args=args)\n"
LATIN_1 = NODE + "# café\n".encode("latin-1")
DECLARED = b"# -*- coding: latin-1 -*-\n" + LATIN_1
UTF_16 = NODE.decode().encode("utf-16")
NULL = NODE + b"x = '\0'\n"

#: Bytes, and the line that is told.
REFUSED = {"latin-1": (LATIN_1, 6), "utf-16": (UTF_16, 1), "null": (NULL, 6)}
READ = (DECLARED, "# café\n".encode(), b"\xef\xbb\xbf" + NODE)


@pytest.mark.parametrize("data", [LATIN_1, UTF_16, *READ])
def test_a_file_is_read_or_refused_as_python_does(tmp_path, data):
    file = tmp_path / "node.py"
    file.write_bytes(data.replace(b"import rclpy\n", b""))
    run = subprocess.run([sys.executable, file], capture_output=True, check=False)
    assert (run.returncode == 0) == (not byte_fault(file.read_bytes())) == (data in READ)


@pytest.mark.parametrize(("data", "line"), REFUSED.values(), ids=REFUSED.keys())
def test_the_run_of_a_file_that_python_refuses_ends_with_its_line(tmp_path, data, line):
    file = tmp_path / "node.py"
    file.write_bytes(data)
    assert byte_fault(data)
    with pytest.raises(SyntaxError, match="save the file as UTF-8") as error:
        loading.run(loading.ProgramStart(str(tmp_path), str(file), None))
    assert (error.value.filename, error.value.lineno) == (str(file), line)


def test_a_lone_file_is_refused_as_python3_would_and_noted(tmp_path):
    file = tmp_path / "node.py"
    file.write_bytes(LATIN_1)
    with open_submission(file) as submission:
        assert in_place(submission).entry == Script(file)
        (note,) = submission.remarks
    assert str(note).startswith("node.py has a byte (0xe9) in line 6 that is no UTF-8")
    file.write_bytes(UTF_16)
    with open_submission(file) as submission:
        assert tuple(map(str, submission.remarks)) == (
            "node.py is saved as UTF-16, and Python reads UTF-8: save it as UTF-8",
        )


def test_a_module_that_only_an_import_passes_over_is_imported_and_noted(tmp_path):
    """As `ros2 run` does it: an import of older Pythons does not look at comments."""
    setup = "from setuptools import setup\n"
    setup += "setup(entry_points={'console_scripts': ['turtle_controller = node:main']})\n"
    (tmp_path / "setup.py").write_text(setup)
    (tmp_path / "node.py").write_bytes(b"import helper\n" + NODE)
    (tmp_path / "helper.py").write_bytes(LATIN_1)
    with open_submission(tmp_path) as submission:
        assert submission.entry == EntryPoint("node", "main")
        assert str(submission.notes[0]).startswith("helper.py has a byte (0xe9) in line 6")


def test_an_absurd_declaration_is_left_to_python(tmp_path):
    for declaration in (b"# coding: klingon\n", b"# coding: hex\n", b"\xef\xbb\xbf# coding: ascii"):
        assert not byte_fault(declaration + os.linesep.encode())
