import http.client
import re
import socket

from tests.programs import Program
from turtlesim_py import browser
from turtlesim_py.programs import turtlesim


def test_it_says_where_the_page_is_and_opens_it(tmp_path, monkeypatch):
    opener = tmp_path / "browser"
    opener.write_text(f'#!/bin/sh\necho "$1" >"{tmp_path}/opened"\n')
    opener.chmod(0o755)
    monkeypatch.setenv("BROWSER", f"{opener} %s")
    arguments = ("--ros-args", "-p", "view_port:=0", "-r", "__ns:=/desk")
    with Program("turtlesim_py.programs.turtlesim", *arguments, cwd=tmp_path) as program:
        program.wait_for_line("This turtlesim shows no window")
        said = [program.process.stdout.readline() for _ in range(4)]
        address = re.search(r"The turtles: (http://127\.0\.0\.1:(\d+)/)", said[1])
        assert re.search(r"add to its address: /\?token=\S{16}", said[2])
        asking = http.client.HTTPConnection("127.0.0.1", int(address[2]))
        asking.request("GET", "/")
        assert asking.getresponse().status == 200
        assert program.stop() == 0
    assert (tmp_path / "opened").read_text() == f"{address[1]}\n"


def test_where_somebody_has_the_usual_port_another_is_taken(monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as other:
        monkeypatch.setattr(turtlesim, "USUAL_PORT", other.getsockname()[1])
        assert turtlesim._free_port() == 0


def test_on_a_machine_without_a_screen_no_browser_is_started(monkeypatch):
    for name in ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not browser.has_browser()
