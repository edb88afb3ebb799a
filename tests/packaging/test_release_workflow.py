""".github/workflows/release.yml, as far as it can be seen without GitHub."""

import re

import yaml

from tests.needs import needs
from tests.programs import ran

from .conftest import ROOT

FILE = ROOT / ".github" / "workflows" / "release.yml"
JOBS = yaml.safe_load(FILE.read_text(encoding="utf-8"))["jobs"]


def test_only_the_job_that_publishes_gets_a_token_of_the_index_and_it_runs_nothing_of_ours():
    trusted = {name for name, job in JOBS.items() if "id-token" in job["permissions"]}
    assert trusted == {"publish"}
    assert [step["uses"].partition("@")[0] for step in JOBS["publish"]["steps"]] == [
        "actions/download-artifact",
        "pypa/gh-action-pypi-publish",
    ]
    assert JOBS["publish"]["environment"] == "pypi"
    uploaded = JOBS["publish"]["steps"][1]["with"]["packages-dir"]
    assert uploaded == "dist/pypi/"
    assert "dist/pypi/ " in (ROOT / "scripts" / "release.sh").read_text(encoding="utf-8")


def test_actions_are_pinned_to_commits():
    used = [step["uses"] for job in JOBS.values() for step in job["steps"] if "uses" in step]
    assert used
    assert [each for each in used if not re.search(r"@[0-9a-f]{40}$", each)] == []


@needs("shellcheck")
def test_the_scripts_are_good_shell():
    scripts = sorted((ROOT / "scripts").glob("*.sh"))
    check = ran(["shellcheck", *scripts])
    assert check.returncode == 0, check.stdout
