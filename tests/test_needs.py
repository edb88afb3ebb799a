"""What is missing is left out and told at the end, in CI a failure; `make test` needs nothing."""

import pytest

from tests.needs import needs

pytest_plugins = ["pytester"]

TESTS = """
from tests.needs import needs

@needs("shellcheck", "pdftotext")
def test_one(): pass

@needs("shellcheck")
def test_two(): pass

def test_three(): pass
"""


@pytest.fixture
def called(pytester, monkeypatch):
    """Call those tests on a machine without a program."""
    pytester.makepyfile(TESTS)
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.delenv("CI", raising=False)

    plugins = ("-p", "tests.needs", "-p", "no:cacheprovider")
    return lambda *words: pytester.runpytest_inprocess(*plugins, *words)


def test_the_last_lines_tell_each_need_how_many_tests_and_the_command(called):
    done = called()
    done.assert_outcomes(passed=1, skipped=2)
    shellcheck, pdftotext = (line for line in done.outlines if "To run them" in line)
    assert shellcheck.startswith("shellcheck: 2 tests. To run them: ")
    assert shellcheck.endswith("apt-get install -qy shellcheck")
    assert pdftotext.startswith("pdftotext: 1 test. ")


def test_where_ci_is_set_what_is_missing_fails(called, monkeypatch):
    monkeypatch.setenv("CI", "true")
    done = called()
    done.assert_outcomes(passed=1, errors=2)
    done.stdout.fnmatch_lines("missing: shellcheck, pdftotext. Install it with: *")


def test_what_needs_something_is_no_part_of_make_test(called):
    called("-m", "not more").assert_outcomes(passed=1, deselected=2)


def test_a_need_that_the_table_has_not_is_a_mistake():
    with pytest.raises(AssertionError, match="pdftotxt"):
        needs("pdftotxt")
