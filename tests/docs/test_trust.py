"""What others rely on before they use the project: how to cite it, what is defended."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from collections import Counter

import yaml

from tests.once import ROOT

HOW = ("stopped", "survived", "open")


def test_the_citation_is_valid_and_of_this_version():
    schema = ("--builtin-schema", "vendor.citation-file-format", "--default-filetype", "yaml")
    words = ("-m", "check_jsonschema", *schema, "CITATION.cff")
    check = subprocess.run([sys.executable, *words], capture_output=True, cwd=ROOT, check=False)
    assert check.returncode == 0, check.stdout
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert cited["version"] == project["version"]
    assert cited["title"].replace("-", "_") == project["name"].replace("-", "_")
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").startswith("BSD 3-Clause")
    assert cited["license"] == "BSD-3-Clause"


def test_the_numbers_of_attacks_are_those_of_the_threat_model():
    model = (ROOT / "docs" / "threat-model.md").read_text(encoding="utf-8")
    one = "|".join(HOW)
    rows = re.findall(rf"^\| `\w+` \|.*\| ({one}) \| ({one}) \| ({one}) \|$", model, re.MULTILINE)
    counted = [Counter(level) for level in zip(*rows, strict=True)]
    text = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    for how in HOW:
        (told,) = re.findall(rf"^\| {how}\b.*?\| (\d+) \| (\d+) \| (\d+) \|$", text, re.MULTILINE)
        assert [int(number) for number in told] == [level[how] for level in counted], how
    assert len(rows) > 50
