import sys

import jinja2
import pytest

from grader.reports.page.templating import BesideTheTemplates


@pytest.fixture
def templates(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    (tmp_path / "page.html").write_text("<p>{{ name }}</p>")
    return tmp_path


def rendered(folder):
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder), bytecode_cache=BesideTheTemplates(folder)
    )
    return environment.get_template("page.html").render(name="alice")


def kept(folder):
    return sorted((folder / "__pycache__").glob("*"))


def test_what_was_compiled_is_not_compiled_again(templates, monkeypatch):
    assert rendered(templates) == "<p>alice</p>"
    assert [path.suffix for path in kept(templates)] == [".pyc"]
    monkeypatch.setattr(jinja2.Environment, "_generate", None)
    assert rendered(templates) == "<p>alice</p>"


def test_a_template_that_changed_is_compiled_anew(templates):
    rendered(templates)
    (templates / "page.html").write_text("<b>{{ name }}</b>")
    assert rendered(templates) == "<b>alice</b>"
    assert len(kept(templates)) == 1


def test_a_damaged_file_is_no_harm(templates):
    for size in (0, 3, 30):
        rendered(templates)
        (path,) = kept(templates)
        path.write_bytes(path.read_bytes()[:size])
        assert rendered(templates) == "<p>alice</p>"


def test_where_nothing_can_be_kept_it_works_all_the_same(templates, monkeypatch):
    (templates / "__pycache__").write_text("no folder")
    assert rendered(templates) == "<p>alice</p>"
    (templates / "__pycache__").unlink()
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert rendered(templates) == "<p>alice</p>"
    assert not kept(templates)
