import pytest

from grader.run.clock import threads
from grader.run.clock.scheduler import COARSER, PAUSE_NS, UNITS_A_PAUSE, Scheduler
from grader.run.clock.threads import Lock
from grader.run.lockstep.protocol import NEVER


class Emptiness:
    """A source of time where only our own deadlines happen."""

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler = scheduler
        self.asked: list[int] = []

    def advance(self, deadline_ns: int) -> None:
        assert deadline_ns < NEVER, "all threads wait for ever"
        self.asked.append(deadline_ns)
        self.scheduler.set_now(deadline_ns)


@pytest.fixture
def scheduler(monkeypatch):
    scheduler = Scheduler()
    scheduler.advance = Emptiness(scheduler).advance
    monkeypatch.setattr(threads, "SCHEDULER", scheduler, raising=False)
    return scheduler


def test_sleeping_takes_virtual_time_only(scheduler):
    scheduler.sleep(10**18)
    assert scheduler.now_ns == 10**18


def test_threads_run_in_turn_and_in_order(scheduler):
    ran = []

    def sleeper(name: str, duration_ns: int) -> None:
        for _ in range(2):
            scheduler.sleep(duration_ns)
            ran.append((name, scheduler.now_ns))

    scheduler.spawn(lambda: sleeper("slow", 3_000_000))
    scheduler.spawn(lambda: sleeper("fast", 2_000_000))
    scheduler.sleep(10_000_000)
    assert ran == [
        ("fast", 2_000_000),
        ("slow", 3_000_000),
        ("fast", 4_000_000),
        ("slow", 6_000_000),
    ]


def test_a_lock_is_handed_over_in_the_order_of_asking(scheduler):
    lock, got = Lock(), []
    lock.acquire()

    def wanting(name: str) -> None:
        with lock:
            got.append(name)

    for name in "abc":
        scheduler.spawn(lambda name=name: wanting(name))
    scheduler.sleep(1_000_000)
    assert got == []
    lock.release()
    scheduler.sleep(1_000_000)
    assert got == ["a", "b", "c"]


def test_waiting_for_a_lock_ends_with_its_time_out(scheduler):
    lock = Lock()
    lock.acquire()
    assert not lock.acquire(timeout=2.5)
    assert scheduler.now_ns == 2_500_000_000
    assert not lock.acquire(blocking=False)


def test_a_lock_refuses_what_python_s_refuses(scheduler):
    with pytest.raises(RuntimeError):
        Lock().release()
    with pytest.raises(ValueError):
        Lock().acquire(timeout=-2)
    with pytest.raises(ValueError):
        Lock().acquire(False, 1)


def test_polling_costs_time(scheduler):
    for _ in range(UNITS_A_PAUSE):
        scheduler.charge()
    assert scheduler.now_ns == PAUSE_NS


def test_polling_without_end_costs_more_and_more(scheduler):
    for _ in range(COARSER[-1][0] // UNITS_A_PAUSE + 1):
        scheduler.charge(UNITS_A_PAUSE)
    before_ns = scheduler.now_ns
    scheduler.charge(UNITS_A_PAUSE)
    assert scheduler.now_ns - before_ns == COARSER[-1][1] * PAUSE_NS


def test_resting_pays_for_what_was_done(scheduler):
    for _ in range(100):
        scheduler.charge(UNITS_A_PAUSE - 1)
        scheduler.sleep(PAUSE_NS)
    assert scheduler.now_ns == 100 * PAUSE_NS
