"""An address says a repository, a tag and a folder, and nothing that git takes for a command."""

from __future__ import annotations

import pytest

from grader.added.address import Address
from grader.errors import UsageError


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("https://example.org/me/x.git", ("https://example.org/me/x.git", "", "")),
        ("https://example.org/me/x@v1.2#a/b", ("https://example.org/me/x", "v1.2", "a/b")),
        ("ssh://git@example.org:22/x@main", ("ssh://git@example.org:22/x", "main", "")),
        ("ssh://git@example.org/x", ("ssh://git@example.org/x", "", "")),
        ("git@example.org:me/x.git@v1#a", ("git@example.org:me/x.git", "v1", "a")),
        ("git@example.org:x", ("git@example.org:x", "", "")),
    ],
)
def test_an_address_has_three_parts(text, parts):
    assert Address.parse(text) == Address(*parts)


def test_a_folder_here_is_told_by_its_whole_path(tmp_path, monkeypatch):
    (tmp_path / "a@b").mkdir()
    monkeypatch.chdir(tmp_path)
    assert Address.parse("a@b/.@v1") == Address((tmp_path / "a@b").as_uri(), "v1")
    assert Address.parse(f"file://{tmp_path}") == Address(tmp_path.as_uri())


@pytest.mark.parametrize(
    "text",
    [
        *("", "-x", "--upload-pack=touch x", "ext::sh -c id", "fd::1", "http://example.org/x"),
        *("git://example.org/x", "https://-oProxyCommand=x/y", "git@-oProxyCommand=x:y"),
        *("ssh://-oProxyCommand=x/y", "host:-x", "host:/-x", "https://example.org/x;id"),
        *("https://example.org/x$(id)", "https://example.org/x\n", "https://example.org/x y"),
        *("https://example.org/x@-v", "https://example.org/x@a..b", "https://example.org/x@a:b"),
        *("https://example.org/x#", "https://example.org/x#../y", "https://example.org/x#/y"),
        *("https://example.org/x#-y", "https://example.org/x#a//b", "/nowhere/at/all"),
    ],
)
def test_what_is_no_address_is_refused(text):
    with pytest.raises(UsageError):
        Address.parse(text)


@pytest.mark.parametrize("address", ["https://example.org/x", "git@example.org:x", "."])
def test_a_tag_has_no_slash(address):
    with pytest.raises(UsageError, match="a branch without a slash, or a commit"):
        Address.parse(f"{address}@feat/x")


@pytest.mark.parametrize(
    ("page", "address"),
    [
        ("https://github.com/me/x/tree/main/a/b", "https://github.com/me/x@main#a/b"),
        ("https://github.com/me/x/tree/v1/", "https://github.com/me/x@v1"),
        ("https://example.org/a/b/x/-/tree/main/a", "https://example.org/a/b/x@main#a"),
    ],
)
def test_the_address_of_a_host_s_page_is_told_as_that_of_its_repository(page, address):
    with pytest.raises(UsageError) as refused:
        Address.parse(page)
    assert str(refused.value).endswith(f"the repository's is {address}")
    Address.parse(address)


@pytest.mark.parametrize("secret", ["https://me:hunter2", "https://hunter2", "ssh://me:hunter2"])
@pytest.mark.parametrize("behind", ["", "@-v", "#..", "@feat/x", "/-/tree/main"])
def test_a_password_or_token_is_refused_and_not_repeated(secret, behind):
    with pytest.raises(UsageError, match="credential helpers") as refused:
        Address.parse(f"{secret}@example.org/x{behind}")
    assert "hunter2" not in str(refused.value)
