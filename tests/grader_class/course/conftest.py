import tempfile
from pathlib import Path

import pytest

from tests.grader_class.course.machine import Machine


@pytest.fixture
def machine():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Machine(Path(folder), real=False)
