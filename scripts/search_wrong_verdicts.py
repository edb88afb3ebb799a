"""Search for controllers of the challenge that are judged wrongly.

    python scripts/search_wrong_verdicts.py [--count 200] [--seed 1] [--limit-s 600] [--show]
        [--only right|wrong|stops|pens|mistakes] [--quick]

Random controllers of many styles drive the world without ROS: right ones, wrong ones with one or
two faults, and ones whose stop or whose pens do not come from the pose. The injected faults are the
oracle, which uses no check. A wrong controller is *killed* if it loses points in a check that its
fault concerns; a right one is *spared* if it keeps all points; what goes without the pose is *found
out* if it earns nothing in its check. It prints these rates, and every controller that was judged
wrongly, with the numbers to make it again.

With `--only mistakes` it is the first line of the report that is judged: it makes one beginner's
mistake each in the controllers of tests/submissions/right, grades them for real, and prints how
often that line has the place and the words of the mistake, and every one where it has not.
"""

from __future__ import annotations

import argparse
import math
import random
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from typing import Literal

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.diagnosis.diagnosis import CHECK, Diagnosis  # noqa: E402
from grader.errors import GraderError  # noqa: E402
from grader.exercise.check import judge  # noqa: E402
from grader.exercise.exercise import Exercise  # noqa: E402
from grader.exercise.loading import load_exercise  # noqa: E402
from grader.grading import grade  # noqa: E402
from grader.recording.recording import Recordings  # noqa: E402
from grader.testing import drive, pen, twist  # noqa: E402
from scripts import beginners_mistakes  # noqa: E402
from scripts.beginners_mistakes import Mutant, Operator  # noqa: E402
from turtlesim_py.world.arena import Arena  # noqa: E402
from turtlesim_py.world.turtle import SIZE_M, TICK_S, Pose  # noqa: E402

CENTRE_M = SIZE_M / 2
#: Checks, of which at least one must deduct points for any of these faults.
CONCERNED: Mapping[tuple[str, ...], tuple[str, ...]] = {
    ("edge_stop",): (
        *("never_stops", "stops_early", "silent", "drives_on", "turns_on", "one_wall", "counts"),
    ),
    ("spiral",): (*("circle", "inward", "line", "zigzag", "turns_back", "jumps", "off_centre"),),
    ("steady_rate",): ("irregular", "pauses"),
    ("pen_per_quadrant",): ("no_pen",),
    ("pen_per_quadrant", "picture"): (
        *("pen_off", "two_alike", "shades", "late", "wrong_centre", "random_colours", "by_time"),
    ),
    ("no_redundant_calls",): ("every_pose",),
    ("picture",): ("background",),
}
FAULTS = {fault: checks for checks, faults in CONCERNED.items() for fault in faults}
#: What a controller goes by that does not go by the pose: its clock or count, where its commands
#: should have taken it from its first pose, a table over first poses, chance.
BLIND = ("clock", "reckons", "table", "chance")
#: What it may do besides: be put into the centre first, reset, pause, or stop by silence.
BESIDES = ("", "", "teleports", "resets", "pauses", "silent")
KINDS = {"stops": "edge_stop", "pens": "pen_per_quadrant"}
#: Colours that are easily distinguished, one from each row.
PALETTES = (
    ((255, 255, 255), (0, 0, 0), (255, 255, 0)),
    ((255, 0, 0), (200, 0, 0), (255, 100, 100)),
    ((0, 255, 0), (0, 128, 0), (0, 200, 100)),
    ((0, 0, 255), (0, 0, 128), (128, 0, 255)),
)
#: The controllers that the mistakes are made in, and the processor time of a grading [s].
RIGHT = ROOT / "tests" / "submissions" / "right"
CPU_S = 200.0
#: With --quick a run takes so long [simulated s]: a right one is over by then.
SHORT_S = 65.0
#: By what the words of a first line go.
Words = Literal["own", "another's", "unnamed"]


@dataclass(frozen=True)
class Style:
    """The style of a controller; without faults, every style is right.

    Attributes:
        period: ticks between velocity commands.
        turn: angular velocity [rad/s], positive to the left.
        speed, growth: the first linear velocity and what each command adds to it [m/s].
        margin_m: it stops when a wall is nearer.
        one_timer: whether it uses the pose only when it publishes.
        answer: ticks until the pen has changed.
        repeats: whether it goes on publishing zeros.
        backwards: whether it drives backwards.
        waits: ticks before anything.
        faults: the injected mistakes.
        blind: what each of `KINDS` goes by, where that is not the pose.
        chance: a seed for random details of a fault.
    """

    period: int
    turn: float
    speed: float
    growth: float
    margin_m: float
    one_timer: bool
    answer: int
    repeats: bool
    backwards: bool
    waits: int
    colors: tuple[tuple[int, int, int], ...]
    faults: tuple[str, ...] = ()
    blind: tuple[tuple[str, str], ...] = ()
    chance: int = 0


def some_style(chance: random.Random) -> Style:
    """Draw the style of a right solution."""
    one_timer = chance.random() < 0.3
    turn = chance.choice((0.8, 1.0, 1.2, 1.5, 2.0))
    period = chance.choice((6, 12, 31) if one_timer else (3, 6, 12, 31, 50))
    per_turn = chance.uniform(0.2, 0.8)  # by so much the radius grows with each turn [m]
    commands = 2 * math.pi / turn / (period * TICK_S)
    colors = [chance.choice(row) for row in PALETTES]
    chance.shuffle(colors)
    return Style(
        period=period,
        turn=turn * chance.choice((1, 1, -1)),
        speed=chance.choice((0.0, 0.0, 0.1, 0.3)) * turn,
        growth=per_turn * turn / commands,
        margin_m=chance.uniform(1.0, 2.0) if one_timer else chance.uniform(0.3, 1.5),
        one_timer=one_timer,
        answer=chance.randrange(0, 5),
        repeats=chance.random() < 0.4,
        backwards=chance.random() < 0.1,
        waits=chance.choice((0, 0, 0, 30, 300)),
        colors=tuple(colors),
        chance=chance.randrange(2**32),
    )


@dataclass
class Controller:
    """A controller of a style, which drives as a submission would."""

    style: Style
    speed: float = 0.0
    quadrant: int = 0
    stopped_at: int = 0
    commands: int = 0
    due: dict[int, tuple[int, int, int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.speed = self.style.speed
        self.chance = random.Random(self.style.chance)
        self.wall = self.chance.randrange(4)
        self.period = self.style.period
        self.next_at = self.style.waits + 1
        self.blind = dict(self.style.blind)
        self.believed: Pose | None = None
        self.sent = (0.0, 0.0)
        self.change_at, self.drawn = self.style.waits, 0
        self.most_m = self.chance.uniform(3.5, 5.4)

    def has(self, fault: str) -> bool:
        """Whether the style has a fault."""
        return fault in self.style.faults

    def __call__(self, tick: int, pose: Pose | None, arena: Arena) -> None:
        """Do what a submission would do before a tick."""
        for when in [when for when in self.due if when <= tick]:
            self.paint(self.due.pop(when), arena)
        if tick < self.style.waits or pose is None:
            return
        if self.has("off_centre") and tick == self.style.waits + 2:
            arena.teleport_absolute("turtle1", CENTRE_M + 1.2, CENTRE_M, 0.0)
        if tick == self.style.waits + 2:
            if self.has("teleports"):
                arena.teleport_absolute("turtle1", CENTRE_M, CENTRE_M, 0.0)
            if self.has("resets"):
                arena.reset()
        self.reckon(tick, pose)
        is_due = tick >= self.next_at
        if self.style.one_timer and not is_due:
            return
        if not self.stopped_at:
            self.watch(tick, pose, arena)
        if is_due:
            self.next_at = tick + self.period
            if self.has("irregular"):
                self.next_at = tick + self.chance.choice((2, 9, 25, 55))
            if self.has("pauses") and self.commands in (60, 61):
                self.next_at = tick + 110
            self.publish(tick, arena)

    def reckon(self, tick: int, pose: Pose) -> None:
        """Move the pose that it believes in by what it has sent."""
        if self.believed is None or tick <= self.style.waits + 3:
            self.believed = pose
            if self.blind.get("stops") in ("table", "chance"):
                first = random.Random(f"{self.style.chance} {pose.x:.1f} {pose.y:.1f}")
                sides = (pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y)
                self.most_m = min(sides) - first.uniform(0.3, 1.8)
                if self.blind["stops"] == "chance":
                    self.most_m = first.uniform(3.0, 5.4)
            return
        speed, turn = self.sent
        theta = self.believed.theta + turn * TICK_S
        x = self.believed.x + speed * TICK_S * math.cos(theta)
        y = self.believed.y + speed * TICK_S * math.sin(theta)
        self.believed = Pose(x, y, theta, speed, turn)

    def seen(self, kind: str, pose: Pose) -> Pose:
        """Return the pose that it goes by for its stop, or for its pens."""
        if self.blind.get(kind) == "reckons":
            assert self.believed is not None
            return self.believed
        return pose

    def publish(self, tick: int, arena: Arena) -> None:
        """Do what its timer would do."""
        if self.stopped_at and not self.has("drives_on"):
            if self.has("turns_on"):
                twist(arena, 0.0, self.style.turn)
            elif self.style.repeats and not self.has("silent"):
                twist(arena, 0.0, 0.0)
            return
        self.commands += 1
        speed, turn = self.velocity(tick)
        self.sent = (-speed if self.style.backwards else speed, turn)
        twist(arena, *self.sent)

    def velocity(self, tick: int) -> tuple[float, float]:
        """Return the next command for the shape."""
        style = self.style
        seconds = tick * TICK_S
        if self.has("circle"):
            return abs(style.turn) * 1.5, style.turn
        if self.has("inward"):
            self.speed = max(0.05, (self.speed or 2.5 * abs(style.turn)) - style.growth / 2)
            return self.speed, style.turn
        if self.has("line"):
            return 0.8, 0.02
        if self.has("zigzag"):
            return 1.0, style.turn * (1 if seconds % 4 < 2 else -1)
        self.speed += style.growth
        if self.has("jumps"):
            radius = 0.5 + 3.4 * (self.speed // (3.4 * abs(style.turn)))
            return radius * abs(style.turn), style.turn
        if self.has("turns_back") and seconds % 10 < 2:
            return self.speed, -style.turn
        return self.speed, style.turn

    def watch(self, tick: int, pose: Pose, arena: Arena) -> None:
        """Do what its pose callback would do."""
        if self.is_near(self.seen("stops", pose)):
            self.stopped_at = tick
            if not self.has("silent"):
                twist(arena, 0.0, self.style.turn if self.has("turns_on") else 0.0)
            return
        quadrant = self.quadrant_of(tick, self.seen("pens", pose))
        if quadrant != self.quadrant or self.has("every_pose"):
            self.quadrant = quadrant
            is_late = self.has("late")
            delay = max(45, round(0.95 / abs(self.style.turn) / TICK_S)) if is_late else 0
            self.due[tick + self.style.answer + delay] = self.color_of(quadrant)

    def is_near(self, pose: Pose) -> bool:
        """Whether it stops here."""
        sides = (pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y)
        if self.has("never_stops"):
            return False
        if self.blind.get("stops") in ("clock", "table", "chance"):
            return self.speed > self.most_m * abs(self.style.turn)
        if self.has("counts"):
            return self.speed > 3.2 * abs(self.style.turn)
        if self.has("stops_early"):
            return min(sides) < 3.2
        if self.has("one_wall"):
            return sides[self.wall] < self.style.margin_m
        return min(sides) < self.style.margin_m

    def quadrant_of(self, tick: int, pose: Pose) -> int:
        """Return the quadrant in which it believes to be."""
        by = self.blind.get("pens")
        if by in ("table", "chance"):  # so long between changes, jittering
            quarter = math.pi / 2 / abs(self.style.turn) / TICK_S
            if by == "table":
                return int((tick - self.style.waits) / quarter) % 4 + 1
            while tick >= self.change_at:
                self.change_at += round(quarter * self.chance.uniform(0.8, 1.2))
                self.drawn = self.drawn % 4 + 1
            return self.drawn
        if self.has("by_time") or by == "clock":
            return int(tick * TICK_S * abs(self.style.turn) / (math.pi / 2)) % 4 + 1
        centre = CENTRE_M + 1.5 * self.has("wrong_centre")
        if pose.y >= centre:
            return 1 if pose.x >= centre else 2
        return 3 if pose.x < centre else 4

    def color_of(self, quadrant: int) -> tuple[int, int, int]:
        """Return the colour that it requests."""
        colors = list(self.style.colors)
        if self.has("two_alike"):
            colors[3] = colors[1]
        if self.has("shades"):
            r, g, b = colors[1]
            colors[3] = (r ^ 1, g ^ 1, b ^ 1)
        if self.has("background"):
            colors[2] = (69, 86, 255)
        if self.has("random_colours"):
            return tuple(self.chance.randrange(256) for _ in "rgb")  # type: ignore[return-value]
        return colors[quadrant - 1]

    def paint(self, color: tuple[int, int, int], arena: Arena) -> None:
        """Set the pen, as the service would."""
        if self.has("no_pen"):
            return
        if self.has("pen_off"):
            arena.set_pen("turtle1", *color, 3, 1)
        else:
            pen(arena, color)


def some_blind(style: Style, kind: str, chance: random.Random) -> Style:
    """Draw what a controller goes by in place of the pose, and what it does besides."""
    besides = chance.choice(BESIDES)
    blind = ((kind, chance.choice(BLIND)),)
    return replace(style, blind=blind, faults=(besides,) if besides else (), backwards=False)


def judged(style: Style, exercise: Exercise) -> dict[str, tuple[float, str]]:
    """Return for each check the share of its points, and its rationale."""
    ticks = round(exercise.limits.total_s / TICK_S)
    runs = [drive(Controller(style), ticks, start) for start in (None, *exercise.starts())]
    verdicts = judge(
        Recordings(runs[0], tuple(runs[1:])), exercise.checks, exercise.points, exercise.tolerances
    )
    return {v.check: (v.score / v.max_score, str(v.rationale)) for v in verdicts}


# The first line -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Drawn:
    """A mistake in a controller.

    Attributes:
        submission: the file or package of the controller without it.
        file: the one with the mistake.
    """

    operator: Operator
    submission: Path
    file: Path
    mutant: Mutant


@dataclass(frozen=True)
class Answer:
    """What the report says of a mistake.

    Attributes:
        seconds: that its grading took.
        trouble: why there is no result; '' where there is one.
        loses: whether it loses points, or does not run to its end.
    """

    drawn: Drawn
    seconds: float
    trouble: str = ""
    loses: bool = True
    found: Diagnosis | None = None

    @property
    def is_exact(self) -> bool:
        """Whether the place is a line that has to be changed."""
        return self._line in self.drawn.mutant.lines

    @property
    def is_near(self) -> bool:
        """Whether it is such a line, or in the function where something is missing."""
        first, last = self.drawn.mutant.function or (1, 0)
        return self.is_exact or first <= self._line <= last

    @property
    def _line(self) -> int:
        """The line that it names, from 1; 0 for none, or one of another file."""
        place = self.found.place if self.found else None
        is_there = place is not None and PurePath(place.file).name == self.drawn.file.name
        return place.line if is_there else 0

    @property
    def words(self) -> Words:
        """Whose words those of the first line are."""
        text = f"{self.found.cause!s} {self.found.help!s}" if self.found else ""
        if self.drawn.operator.named_by(text):
            return "own"
        is_named = self.found is not None and self.found.key != CHECK
        return "another's" if is_named and self.others else "unnamed"

    @property
    def others(self) -> list[str]:
        """The operators whose words the cause has; a help is more general."""
        of = beginners_mistakes.OPERATORS
        cause = str(self.found.cause) if self.found else ""
        return [each.name for each in of if each.named_by(cause)]

    def __str__(self) -> str:
        lines = ", ".join(map(str, self.drawn.mutant.lines))
        around = self.drawn.mutant.function
        inside = f" (in {around[0]} to {around[1]})" if around else ""
        text = f"{self.drawn.file.name}, line {lines}{inside}; {self.seconds:.0f} s\n"
        text += "".join(
            f"        | {row.strip()}\n"
            for number, row in enumerate(self.drawn.mutant.source.split("\n"), 1)
            if number in self.drawn.mutant.lines
        )
        if self.found is None:
            return f"{text}        {self.trouble or 'no first line'}"
        place = self.found.place
        where = f"{place.file}, line {place.line}" if place else "no place"
        judged = "exact" if self.is_exact else "its function" if self.is_near else "elsewhere"
        words = self.words
        whose = f"{words}: {', '.join(self.others)}" if words == "another's" else words
        said = f"{self.found.key}: {self.found.cause!s} | {self.found.help!s}"
        return f"{text}        place {judged} ({where}); words {whose}\n        {said}"


def some_mistakes(count: int, chance: random.Random) -> Iterator[Drawn]:
    """Draw mistakes in controllers, of each class about as many."""
    controllers = []
    for path in sorted(RIGHT.iterdir()):
        files = [path] if path.suffix == ".py" else sorted((path / path.name).glob("[a-z]*.py"))
        controllers += [(path, file) for file in files]
    drawn, operators = 0, list(beginners_mistakes.OPERATORS)
    while drawn < count:
        chance.shuffle(operators)
        for operator in operators[: count - drawn]:
            own = random.Random(f"{chance.random()}")  # the same, whatever is drawn for others
            for path, file in own.sample(controllers, len(controllers)):
                mutant = operator.mutant(file.read_text(encoding="utf-8"), own)
                if mutant is not None:
                    yield Drawn(operator, path, file, mutant)
                    break
            drawn += 1


def answered(drawn: Drawn, exercise: Exercise) -> Answer:
    """Grade a controller with a mistake; what it loses when the time is up counts as well."""
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / drawn.submission.name
        if drawn.submission.is_dir():
            shutil.copytree(drawn.submission, copy)
        file = copy / drawn.file.relative_to(drawn.submission)
        file.write_text(drawn.mutant.source, encoding="utf-8")
        try:
            result = grade(copy, exercise)
        except GraderError as error:
            return Answer(drawn, time.monotonic() - began, f"not graded: {error}")
    is_over = all(
        each.outcome in ("finished", "exited") for each in (result.run, *result.varied_runs)
    )
    loses = result.score < result.max_score or not is_over
    return Answer(drawn, time.monotonic() - began, loses=loses, found=result.diagnosis)


def search_mistakes(count: int, seed: int, until: float, show: bool, is_quick: bool) -> None:
    """Print how often the first line has the place and the words of a mistake, and where not."""
    exercise = replace(load_exercise("turtlesim_challenge"), cpu_s=CPU_S)
    if is_quick:
        limits = replace(exercise.limits, total_s=SHORT_S)
        exercise = replace(exercise, limits=limits, varied=replace(exercise.varied, count=1))
    drawn = list(some_mistakes(count, random.Random(seed)))

    def answer(each: Drawn) -> Answer | None:
        return answered(each, exercise) if time.monotonic() < until else None

    with ThreadPoolExecutor(2) as pool:
        answers = [each for each in pool.map(answer, drawn) if each is not None]
    if len(answers) < count:
        print(f"The time is up after {len(answers)} mistakes.")
    without = [each for each in answers if each.trouble]
    lost = [each for each in answers if each.loses and not each.trouble]
    failed = [each for each in lost if not each.is_near or each.words != "own"]
    by_operator = Counter(each.drawn.operator.name for each in failed)
    for name, times in sorted(by_operator.items(), key=lambda found: (-found[1], found[0])):
        of = sum(each.drawn.operator.name == name for each in lost)
        print(f"\n{name}: {times} of {of} fail")
        print("\n".join(f"    {each}" for each in failed if each.drawn.operator.name == name))
    if show:
        print("\nas they should be, or without a loss:")
        rest = [each for each in answers if each not in failed]
        print("\n".join(f"    {each.drawn.operator.name}: {each}" for each in rest))
    if without:
        print("\nnot graded, and not counted:")
        print("\n".join(f"    {each.drawn.operator.name}: {each}" for each in without))
    graded = len(answers) - len(without)
    print(f"\nmistakes: {graded} graded, {len(lost)} lose points or do not run to the end")
    many = max(len(lost), 1)
    for what, good in (
        ("the place is the exact line", sum(each.is_exact for each in lost)),
        ("... or its function, where something is missing", sum(each.is_near for each in lost)),
        ("the words are the mistake's own", sum(each.words == "own" for each in lost)),
        ("the words are another mistake's", sum(each.words == "another's" for each in lost)),
        ("it is not named", sum(each.words == "unnamed" for each in lost)),
        ("place and words are right", len(lost) - len(failed)),
    ):
        print(f"{what}: {good} of {len(lost)} ({100 * good / many:.0f} %)")


def main() -> None:
    """Search, and print the wrong verdicts and both rates."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=200, help="controllers")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit-s", type=float, default=600, help="wall time at most")
    parser.add_argument("--show", action="store_true", help="print every controller")
    parser.add_argument(
        "--quick", action="store_true", help="of mistakes: short runs, one of them varied"
    )
    kinds = ("right", "wrong", *KINDS, "mistakes")
    parser.add_argument("--only", choices=kinds, help="controllers of a kind")
    asked = parser.parse_args()
    until = time.monotonic() + asked.limit_s
    if asked.only == "mistakes":
        search_mistakes(asked.count, asked.seed, until, asked.show, asked.quick)
        return
    exercise = load_exercise("turtlesim_challenge")
    chance = random.Random(asked.seed)
    of: Counter[str] = Counter()
    good: Counter[str] = Counter()
    for number in range(asked.count):
        style = some_style(chance)
        kind = asked.only or ("right", "wrong", "stops", "wrong", "pens", "wrong")[number % 6]
        if kind in KINDS:
            style = some_blind(style, kind, chance)
        elif kind == "wrong":
            faults = chance.sample(sorted(FAULTS), 1 if chance.random() < 0.7 else 2)
            style = replace(style, faults=tuple(faults))
        if time.monotonic() > until:
            print(f"The time is up after {number} controllers.")
            break
        found = judged(style, exercise)
        lost = {check: why for check, (share, why) in found.items() if share < 1}
        if kind in KINDS:
            is_right = found[KINDS[kind]][0] == 0
        elif kind == "wrong":
            is_right = all(lost.keys() & {*FAULTS[f], "moves"} for f in style.faults)
        else:
            is_right = not lost
        of[kind] += 1
        good[kind] += is_right
        if asked.show or not is_right:
            print(f"{number}: {'as it should be' if is_right else 'JUDGED WRONGLY'}: {style}")
            print("".join(f"    {check}: {why}\n" for check, why in lost.items()), end="")
    print(f"killed: {good['wrong']} of {of['wrong']} wrong ones lose the points of every fault")
    print(f"spared: {good['right']} of {of['right']} right ones keep all points")
    for kind, check in KINDS.items():
        how = f"{kind} without the pose earn nothing of {check}"
        print(f"found out: {good[kind]} of {of[kind]} {how}")


if __name__ == "__main__":
    main()
