import pytest

from turtlesim_py import browser

PAGE = "http://127.0.0.1:8090/?token=x"


@pytest.mark.parametrize(
    ("ends", "typed"),
    [
        ("10.0.0.7 50122 192.0.2.4 22", "ssh -L 8090:127.0.0.1:8090 ada@192.0.2.4"),
        ("10.0.0.7 50122 192.0.2.4 2222", "ssh -p 2222 -L 8090:127.0.0.1:8090 ada@192.0.2.4"),
        ("fe80::7 50122 2001:db8::4 22", "ssh -L 8090:127.0.0.1:8090 ada@2001:db8::4"),
    ],
)
def test_who_has_come_by_ssh_forwards_the_port(ends, typed, monkeypatch):
    monkeypatch.setenv("SSH_CONNECTION", ends)
    monkeypatch.setenv("USER", "ada")
    assert browser.tunnel(PAGE) == typed


@pytest.mark.parametrize("ends", ["", "odd"])
def test_who_sits_here_needs_nothing(ends, monkeypatch):
    monkeypatch.setenv("SSH_CONNECTION", ends)
    assert browser.tunnel(PAGE) == ""


def test_a_page_that_every_machine_reaches_needs_nothing(monkeypatch):
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.7 50122 192.0.2.4 22")
    assert browser.tunnel("http://lab-4:8080/?token=x") == ""
