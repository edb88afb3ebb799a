"""What a viewer is told is enough to have the same picture, and no more is told than happens."""

import numpy as np
import pytest

from turtlesim_py.live.feed import Feed
from turtlesim_py.world.arena import Arena


class Viewer:
    """Draws what it is told, as the page does."""

    def __init__(self):
        self.arena = Arena(sprite="jazzy")
        self.news = []
        self.feed = Feed(self.arena, self.news.append)
        self.canvas = np.zeros((500, 500, 4), np.uint8)

    def look(self):
        self.feed.is_watched = True
        self.feed.ask(self)
        self.pass_ticks(1)

    def pass_ticks(self, ticks):
        for _ in range(ticks):
            self.feed.after_tick(self.arena.tick())

    def changes(self):
        taken, self.news[:] = self.news[:], []
        for news in taken:
            if news.canvas is not None:
                self.canvas = news.canvas.rgba()
            else:
                self._draw(news)
        return [news for news in taken if news.canvas is None]

    def _draw(self, change):
        for stroke in change.content["drawn"]:
            if stroke is None:
                self.canvas[:] = (255, 255, 255, 0)
                continue
            color, numbers = stroke
            for row, first, last in zip(*[iter(numbers)] * 3, strict=True):
                self.canvas[row, first : last + 1] = (*color, 255)


@pytest.fixture
def viewer():
    return Viewer()


def test_the_same_strokes_are_on_the_viewers_canvas(viewer):
    viewer.look()
    viewer.arena.command("turtle1", (2.0, 0.0, 0.0), (0.0, 0.0, 1.5))
    viewer.pass_ticks(40)
    viewer.arena.set_pen("turtle1", 200, 10, 30, 7, 0)
    viewer.pass_ticks(41)
    viewer.arena.clear()
    viewer.arena.command("turtle1", (1.0, 0.0, 0.0), (0.0, 0.0, -2.5))
    viewer.pass_ticks(60)
    viewer.changes()
    assert np.array_equal(viewer.canvas, viewer.arena.canvas.rgba())
    assert (viewer.canvas[..., 3] == 255).any()


def test_who_comes_late_gets_what_was_drawn_before_and_then_what_is_drawn(viewer):
    viewer.arena.command("turtle1", (2.0, 0.0, 0.0), (0.0, 0.0, 1.5))
    viewer.pass_ticks(30)
    assert viewer.news == []
    viewer.look()
    viewer.pass_ticks(21)
    viewer.changes()
    assert np.array_equal(viewer.canvas, viewer.arena.canvas.rgba())


def test_at_rest_nothing_is_told_and_while_nobody_looks_nothing_kept(viewer):
    viewer.look()
    viewer.changes()
    viewer.pass_ticks(100)
    assert viewer.changes() == []
    viewer.feed.is_watched = False
    viewer.news.clear()
    viewer.arena.command("turtle1", (2.0, 0.0, 0.0), (0.0, 0.0, 1.5))
    viewer.pass_ticks(30)
    assert viewer.news == []
    assert viewer.arena.canvas.watcher is None


def test_turtles_that_come_and_go_are_told_with_their_pens(viewer):
    viewer.look()
    viewer.arena.spawn(1.0, 2.0, 0.5, "second")
    viewer.arena.set_pen("second", 1, 2, 3, 4, 0)
    viewer.arena.set_pen("second", 9, 9, 9, 9, 1)  # a pen that is lifted keeps its colour
    viewer.pass_ticks(2)
    (*_, change) = viewer.changes()
    first, *_ = change.content["turtles"]
    assert first["name"] == "second"
    assert first["pen"] == {"r": 1, "g": 2, "b": 3, "width": 4, "off": True}
    assert first["pose"][:2] == [1.0, 2.0]
    viewer.arena.kill("second")
    viewer.pass_ticks(2)
    (*_, change) = viewer.changes()
    assert [turtle["name"] for turtle in change.content["turtles"]] == ["turtle1"]
    viewer.arena.teleport_absolute("turtle1", float("nan"), float("inf"), 0.0)
    viewer.pass_ticks(2)
    (*_, change) = viewer.changes()
    assert change.content["turtles"][0]["px"][0] == "nan"  # what is no number, in words


def test_calls_are_told_in_order_and_a_flood_of_them_is_cut(viewer):
    viewer.look()
    viewer.arena.clear()
    viewer.arena.rotate_absolute("turtle1", 1.0, b"\x01\xff")
    viewer.pass_ticks(2)
    told = [call for change in viewer.changes() for call in change.content["calls"]]
    assert [call["op"] for call in told] == ["clear", "log", "rotate_absolute"]
    for _ in range(1000):
        viewer.arena.clear()
    viewer.pass_ticks(2)
    assert max(len(change.content["calls"]) for change in viewer.changes()) == 20
