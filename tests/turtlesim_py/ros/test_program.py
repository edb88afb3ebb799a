import itertools

import pytest

from turtlesim_py.ros import program
from turtlesim_py.world.arena import TICK_NS

MS = 1_000_000


class WallClock:
    """Stands where the pacer's `time` is; sleeping makes time pass."""

    def __init__(self, monkeypatch):
        self.now_ns = 1_000 * MS
        monkeypatch.setattr(program, "time", self)

    def monotonic_ns(self):
        return self.now_ns

    def sleep(self, seconds):
        assert seconds > 0.0
        self.now_ns += round(seconds * 1e9)


@pytest.fixture
def wall(monkeypatch):
    return WallClock(monkeypatch)


@pytest.mark.parametrize(
    ("durations_ms", "times"),
    [
        pytest.param([1.0, 3.0, 15.0], [0.0, 16.0, 32.0, 48.0], id="every 16 ms"),
        pytest.param([20.0, 1.0, 1.0], [0.0, 20.0, 32.0, 48.0], id="a late one comes at once"),
        pytest.param([100.0, 1.0, 1.0], [0.0, 100.0, 112.0, 128.0], id="missed ones are missed"),
    ],
)
def test_the_wall_clock_ticks_in_its_grid(wall, durations_ms, times):
    begin, found, durations = wall.now_ns, [], iter([*durations_ms, 0.0])

    def tick():
        found.append((wall.now_ns - begin) / MS)
        wall.now_ns += round(next(durations) * MS)
        return len(found) <= len(durations_ms)

    program.follow_wall_clock(tick)
    assert found == times


class RosClock:
    """Says a list of times [ms], one for each time that the pacer asks; takes notes."""

    def __init__(self, wall, times_ms, asking_takes_ms):
        self._wall = wall
        self._times = times_ms
        self._asked = 0
        self._asking_takes_ms = asking_takes_ms
        self.notes = []

    def hear(self, patience_ns):
        assert patience_ns == TICK_NS
        over = self._asked >= len(self._times)
        self._wall.now_ns += TICK_NS if over else round(self._asking_takes_ms * MS)
        self._asked += 1
        return round(self._times[-1 if over else self._asked - 1] * MS)

    def serve(self):
        if self._asked > len(self._times):
            return False
        self.notes.append("serve")
        return True

    def tick(self, now_ns):
        self.notes.append(now_ns / MS)
        return True


@pytest.mark.parametrize(
    ("times_ms", "asking_takes_ms", "notes"),
    [
        pytest.param([0.0] * 3, 16.0, ["serve"] * 3, id="without a clock requests are served"),
        pytest.param([0.0, 5.0], 16.0, ["serve", 5.0], id="the first known time is a tick"),
        pytest.param(
            [float(t) for t in range(1, 34)], 0.5, [1.0, 17.0, 33.0], id="a fine clock: every 16 ms"
        ),
        pytest.param([10.0, 74.0], 16.0, [10.0, 26.0, 42.0, 58.0, 74.0], id="a coarse one: all"),
        pytest.param(
            [10.0, 10.0, 10.0, 26.0], 16.0, [10.0, "serve", "serve", 26.0], id="served at rest"
        ),
        pytest.param(
            [10.0 + 0.1 * step for step in range(33)],
            *(1.0, [10.0, "serve", "serve"]),
            id="served at wall pace while it creeps",
        ),
        pytest.param([10.0, 1e9, 1e9 + 16.0], 16.0, [10.0, 1e9, 1e9 + 16.0], id="a jump ahead"),
        pytest.param([5000.0, 20.0, 36.0], 16.0, [5000.0, 20.0, 36.0], id="a jump back"),
    ],
)
def test_the_ros_clock_brings_ticks_and_requests(wall, times_ms, asking_takes_ms, notes):
    clock = RosClock(wall, times_ms, asking_takes_ms)
    program.follow_ros_clock(clock.hear, clock.serve, clock.tick)
    assert clock.notes == notes


def test_a_tick_that_says_stop_is_the_last_even_of_several(wall):
    calls = itertools.count()
    program.follow_ros_clock(
        lambda _: 1 * MS + 500 * MS * min(next(calls), 1),
        lambda: False,
        lambda now_ns: now_ns < 100 * MS,
    )
    assert next(calls) == 2
