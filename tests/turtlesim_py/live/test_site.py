import pytest

from turtlesim_py.live.site import Site, is_loopback

HERE = Site("secret", needs_token=False)
EVERYWHERE = Site("secret", needs_token=True)


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        ("/", {"host": "127.0.0.1:8080"}),
        ("/socket", {"host": "localhost:8080", "origin": "http://localhost:8080"}),
        ("/socket", {"host": "[::1]:8080", "origin": "http://[::1]:8080"}),
        ("/socket", {"host": "127.0.0.1:8080"}),  # a program, not a page
        # a forwarded port that tells by which name it was asked for
        (
            "/socket",
            {
                "host": "localhost:8080",
                "x-forwarded-host": "big-disco-8080.app.github.dev",
                "origin": "https://big-disco-8080.app.github.dev",
            },
        ),
        # ... and one that does not
        ("/socket?token=secret", {"host": "hub.example.edu", "origin": "https://hub.example.edu"}),
    ],
)
def test_on_this_machine_come_in(path, headers):
    assert HERE.refusal(path, headers) == ""


@pytest.mark.parametrize(
    ("path", "headers", "words"),
    [
        ("/socket", {"host": "127.0.0.1:8080", "origin": "https://evil.example"}, "evil.example"),
        ("/socket", {"host": "127.0.0.1:8080", "origin": "null"}, "null"),
        # a name that leads to this machine for a while
        ("/socket", {"host": "evil.example:8080", "origin": "http://evil.example:8080"}, "evil"),
        ("/socket", {}, "''"),
        ("/socket?token=wrong", {"host": "127.0.0.1:8080"}, "changes at each start"),
        ("/socket?token=", {"host": "evil.example"}, "evil"),
        (
            "/socket",
            {"host": "localhost", "x-forwarded-host": "a.dev", "origin": "https://b.dev"},
            "b.dev",
        ),
        ("/socket", {"host": "[oops", "origin": "http://[oops"}, "asked for as ''"),
    ],
)
def test_pages_of_others_do_not(path, headers, words):
    assert words in HERE.refusal(path, headers)


def test_where_other_machines_can_ask_only_the_token_lets_in():
    headers = {"host": "127.0.0.1:8080"}
    assert "needs the token" in EVERYWHERE.refusal("/", headers)
    assert EVERYWHERE.refusal("/?token=secret", headers) == ""


def test_an_address_is_this_machines_alone_or_not():
    alone = ("127.0.0.1", "localhost", "::1", "127.8.8.8")
    assert [is_loopback(address) for address in alone] == [True] * 4
    others = ("0.0.0.0", "::", "192.168.1.5", "example.org", "")
    assert [is_loopback(address) for address in others] == [False] * 5
