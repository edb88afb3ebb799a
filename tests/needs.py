"""What of the machine some tests need, and the one command that brings each.

Such tests are left to `make test-all`, so `make test` skips nothing anywhere. Where something is
missing they are left out, and the last lines of the call say what to install; with the environment
variable CI set that is a failure. As a program this prints the commands for what is missing:

    .venv/bin/python -m tests.needs | sh -ex
"""

import os
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.attacks import container

ROSLIBJS = Path("tests", "turtlesim_py", "live", "roslibjs")
AS_ROOT = os.geteuid() == 0
#: Debian, Ubuntu and Fedora call it differently.
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


def _there(*programs: str) -> Callable[[], bool]:
    return lambda: any(map(shutil.which, programs))


def _apt(*packages: str) -> str:
    sudo = "" if AS_ROOT else "sudo "
    return f"{sudo}apt-get update -q && {sudo}apt-get install -qy {' '.join(packages)}"


@cache
def _can_contain() -> bool:
    try:
        return container.run(container.PROBE) == "works"
    except container.NoContainer:
        return False


#: For what no line of a shell can install.
BY_ROOT = "sudo make test"
#: What is built, not installed.
BUILD_SITE = "make docs"
SITE = Path(__file__).parents[1] / "build" / "site" / "html"
#: Name -> whether it is there, and what installs it; each after what it needs itself.
NEEDS: dict[str, tuple[Callable[[], bool], str]] = {
    "chromium": (_there(*BROWSERS), _apt("chromium")),
    "container": (_can_contain, BY_ROOT),
    "node": (_there("node"), _apt("nodejs", "npm")),
    "pdftotext": (_there("pdftotext"), _apt("poppler-utils")),
    "pgrep": (_there("pgrep"), _apt("procps")),
    "roslibjs": (
        (Path(__file__).parents[1] / ROSLIBJS / "node_modules" / "roslib").is_dir,
        f"npm install --prefix {ROSLIBJS} --no-audit --no-fund --no-package-lock",
    ),
    "root": (lambda: AS_ROOT, BY_ROOT),
    "site": ((SITE / "gallery" / "index.html").is_file, BUILD_SITE),
    "shellcheck": (_there("shellcheck"), _apt("shellcheck")),
}


def needs(*names: str) -> pytest.MarkDecorator:
    """The mark of a test that can only pass where all of these are, of `NEEDS`."""
    assert names and NEEDS.keys() >= set(names), f"{names}: not all of them are in {[*NEEDS]}"
    return pytest.mark.needs(*names)


def missing(names: Any) -> list[str]:
    return [name for name in names if not NEEDS[name][0]()]


# What pytest calls: tests/conftest.py names this module as a plugin ------------------------------


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "needs(*names): left out where one is missing (needs.py)")
    config.addinivalue_line("markers", "more(reason): only in `make test-all`")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave what needs something of the machine to `make test-all`."""
    for item in items:
        if item.get_closest_marker("needs"):
            item.add_marker(pytest.mark.more("it needs something of the machine"))


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Leave a test out, or fail it, before anything is set up for it."""
    named = [name for mark in item.iter_markers("needs") for name in mark.args]
    if not (lacks := missing(dict.fromkeys(named))):
        return
    if os.environ.get("CI"):
        commands = "; ".join(NEEDS[name][1] for name in lacks)
        pytest.fail(f"missing: {', '.join(lacks)}. Install it with: {commands}", pytrace=False)
    item.user_properties += [("needs", name) for name in lacks]  # they travel with the report
    pytest.skip(f"missing: {', '.join(lacks)}")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_terminal_summary(terminalreporter: Any) -> Iterator[None]:
    """After all other summaries: what is missing, how many tests that left out, and the command."""
    yield
    reports = terminalreporter.stats.get("skipped", [])
    left_out = Counter(
        name for report in reports for kind, name in report.user_properties if kind == "needs"
    )
    if left_out:
        terminalreporter.section("left out for what is missing here")
    for name, count in left_out.most_common():
        tests = "1 test" if count == 1 else f"{count} tests"
        terminalreporter.line(f"{name}: {tests}. To run them: {NEEDS[name][1]}")


if __name__ == "__main__":
    commands = (NEEDS[name][1] for name in missing(NEEDS))
    print(*(each for each in commands if each not in (BY_ROOT, BUILD_SITE)), sep="\n")
