"""What part of the grader needs is told in one line where it is missing."""

import pytest

from grader.errors import GraderFailure
from grader.system import requirements


@pytest.mark.parametrize("load", [True, False])
def test_what_is_there_is_fine(load):
    requirements.require("websockets", load)


@pytest.mark.parametrize("load", [True, False])
def test_what_is_missing_is_named_with_what_to_install(monkeypatch, load):
    made_up = {"no_such_package": ("no_such_package.part", "tests look for it", "nothing>=1")}
    monkeypatch.setattr(requirements, "OPTIONAL", made_up)
    with pytest.raises(GraderFailure, match=r"no_such_package is missing .*'nothing>=1'"):
        requirements.require("no_such_package", load)


def test_a_package_that_it_needs_is_named_too(tmp_path, monkeypatch):
    (tmp_path / "half_there.py").write_text("import no_such_package")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(requirements, "OPTIONAL", {"half_there": ("half_there", "", "")})
    requirements.require("half_there", load=False)
    with pytest.raises(GraderFailure, match="no_such_package, which half_there needs, is missing"):
        requirements.require("half_there")
