import json
import re
from pathlib import Path

import jsonschema
import pytest

import grader

SCHEMAS = sorted(Path(grader.__file__).parent.rglob("*.schema.json"))


@pytest.mark.parametrize("path", SCHEMAS, ids=lambda path: path.name)
def test_a_schema_is_one_and_its_id_is_no_path_that_could_be_resolved(path):
    schema = json.loads(path.read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    # jsonschema 4.10 takes an id with slashes for a relative address, and every $ref for broken
    assert re.fullmatch(r"urn:turtlesim-grader:\w+:v\d", schema["$id"])
