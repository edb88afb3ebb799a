"""package.xml is read strictly: no entities, and nothing that takes long."""

import pytest

from grader.submission.manifest import parse_xml

BOMB = "<!DOCTYPE a [{}]><a>&x9;</a>".format(
    "<!ENTITY x0 'x'>" + "".join(f"<!ENTITY x{n} '{f'&x{n - 1};' * 100}'>" for n in range(1, 10))
)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_entities_are_not_even_declared(encoding):
    assert parse_xml(BOMB.encode(encoding)) is None


def test_a_deep_tree_is_a_tree():
    root = parse_xml(b"<a>" * 100_000 + b"</a>" * 100_000)
    assert root is not None and not isinstance(root, str) and len(root) == 1


@pytest.mark.parametrize(
    "data", [b"", b"<a>", b"<a></b>", b"<?xml encoding='klingon'?><a/>", b"\0"]
)
def test_what_is_no_xml_is_told_in_words(data):
    assert str(parse_xml(data)).startswith("does not parse")
