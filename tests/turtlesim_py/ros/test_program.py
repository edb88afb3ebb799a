"""What makes a simulator tick, with clocks of the test's own."""

from __future__ import annotations

import itertools

import pytest

from turtlesim_py.ros import program
from turtlesim_py.world.arena import TICK_NS

MS = 1_000_000


class WallClock:
    """Stands where the pacer's `time` is; sleeping makes time pass."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_ns = 1_000 * MS
        monkeypatch.setattr(program, "time", self)

    def monotonic_ns(self) -> int:
        return self.now_ns

    def sleep(self, seconds: float) -> None:
        assert seconds > 0.0
        self.now_ns += round(seconds * 1e9)


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> WallClock:
    return WallClock(monkeypatch)


def wall_ticks(wall: WallClock, durations_ms: list[float]) -> list[float]:
    """When the ticks come [ms], the first at 0, if each takes so long."""
    begin, times = wall.now_ns, []
    durations = iter([*durations_ms, 0.0])

    def tick() -> bool:
        times.append((wall.now_ns - begin) / MS)
        wall.now_ns += round(next(durations) * MS)
        return len(times) <= len(durations_ms)

    program.follow_wall_clock(tick)
    return times


def test_the_wall_clock_ticks_every_16_ms(wall: WallClock) -> None:
    assert wall_ticks(wall, [1.0, 3.0, 15.0]) == [0.0, 16.0, 32.0, 48.0]


def test_a_late_tick_comes_at_once_and_the_grid_stays(wall: WallClock) -> None:
    assert wall_ticks(wall, [20.0, 1.0, 1.0]) == [0.0, 20.0, 32.0, 48.0]


def test_missed_ticks_are_not_made_up_for(wall: WallClock) -> None:
    assert wall_ticks(wall, [100.0, 1.0, 1.0]) == [0.0, 100.0, 112.0, 128.0]


class RosClock:
    """Says a list of times [ms], one for each time that the pacer asks; takes notes."""

    def __init__(self, wall: WallClock, times_ms: list[float], asking_takes_ms: float) -> None:
        self._wall = wall
        self._times = times_ms
        self._asked = 0
        self._asking_takes_ms = asking_takes_ms
        self.notes: list[float | str] = []

    def hear(self, patience_ns: int) -> int:
        assert patience_ns == TICK_NS
        over = self._asked >= len(self._times)
        self._wall.now_ns += TICK_NS if over else round(self._asking_takes_ms * MS)
        self._asked += 1
        return round(self._times[-1 if over else self._asked - 1] * MS)

    def serve(self) -> bool:
        if self._asked > len(self._times):
            return False
        self.notes.append("serve")
        return True

    def tick(self, now_ns: int) -> bool:
        self.notes.append(now_ns / MS)
        return True


def ros_notes(
    wall: WallClock, times_ms: list[float], asking_takes_ms: float = 16.0
) -> list[float | str]:
    """What is called while the clock says these times."""
    clock = RosClock(wall, times_ms, asking_takes_ms)
    program.follow_ros_clock(clock.hear, clock.serve, clock.tick)
    return clock.notes


def test_without_a_clock_requests_are_served_and_nothing_ticks(wall: WallClock) -> None:
    assert ros_notes(wall, [0.0, 0.0, 0.0]) == ["serve"] * 3


def test_the_first_time_that_is_known_brings_the_first_tick(wall: WallClock) -> None:
    assert ros_notes(wall, [0.0, 5.0]) == ["serve", 5.0]


def test_a_fine_clock_brings_a_tick_every_16_ms(wall: WallClock) -> None:
    times = [float(t) for t in range(1, 34)]
    assert ros_notes(wall, times, asking_takes_ms=0.5) == [1.0, 17.0, 33.0]


def test_a_coarse_clock_brings_all_the_ticks_in_between(wall: WallClock) -> None:
    assert ros_notes(wall, [10.0, 74.0]) == [10.0, 26.0, 42.0, 58.0, 74.0]


def test_requests_are_served_while_the_clock_rests(wall: WallClock) -> None:
    assert ros_notes(wall, [10.0, 10.0, 10.0, 26.0]) == [10.0, "serve", "serve", 26.0]


def test_they_are_served_at_wall_pace_while_it_creeps(wall: WallClock) -> None:
    times = [10.0 + 0.1 * step for step in range(33)]
    assert ros_notes(wall, times, asking_takes_ms=1.0) == [10.0, "serve", "serve"]


def test_a_jump_ahead_is_not_made_up_for(wall: WallClock) -> None:
    assert ros_notes(wall, [10.0, 1e9, 1e9 + 16.0]) == [10.0, 1e9, 1e9 + 16.0]


def test_after_a_jump_back_it_goes_on_from_there(wall: WallClock) -> None:
    assert ros_notes(wall, [5000.0, 20.0, 36.0]) == [5000.0, 20.0, 36.0]


def test_a_tick_that_says_stop_is_the_last_even_of_several(wall: WallClock) -> None:
    calls = itertools.count()
    program.follow_ros_clock(
        lambda _: 1 * MS + 500 * MS * min(next(calls), 1),
        lambda: False,
        lambda now_ns: now_ns < 100 * MS,
    )
    assert next(calls) == 2
