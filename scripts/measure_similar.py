"""How well grader.batch.similar tells copies from coincidence; run it from the top folder.

A class is made of every submission below tests/submissions, right and wrong ones, and of disguised
copies of the right ones. Each disguise is as in the tests. Printed is how many of the copies are
listed, and of what else is listed how much of the shorter source stands in the other one verbatim,
line by line: the submissions of a folder are often variants of one, and those are copies, too.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.grader.batch.similar.classes import HONEST, SUBMITTED, hand_in, looked_at, text
from tests.grader.batch.similar.disguises import DISGUISES
from tests.submissions.beginners import CHANGED, changed

COPIED = ("quick", "functions", "states", "loop")
#: So much of the lines verbatim, and it is a variant of the other.
VARIANT = 0.5


def main() -> None:
    """Make the class, compare it, print."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        lines = {who: set(own_lines(handed_in)) for who, handed_in in honest(out)}
        copies = {(who, f"{who}-{name}") for who in COPIED for name in DISGUISES}
        for who, copy in sorted(copies):
            disguise = DISGUISES[copy.rpartition("-")[2]]
            hand_in(out, copy, {"mine.py": disguise(text(who))})
        found = looked_at(out)
    ids = [entry.id for entry in found.entries]
    pairs = [(ids[pair.first], ids[pair.second], pair) for pair in found.look.pairs]
    listed = {(one, other) for one, other, _ in pairs}
    print(f"{len(ids)} hand-ins, {found.look.pairs_in_all} pairs, {len(pairs)} listed")
    print(f"copies listed beside their originals: {len(copies & listed)} of {len(copies)}")
    others = [each for each in pairs if each[0].split("-")[0] != each[1].split("-")[0]]
    variants = [each for each in others if verbatim(lines, *each[:2]) >= VARIANT]
    print(f"others listed: {len(others)}, of which variants of one another: {len(variants)}")
    for one, other, pair in others:
        share = pair.source.share if pair.source else 0.0
        print(f"  {share:4.0%} alike, {verbatim(lines, one, other):4.0%} verbatim: {one}, {other}")


def honest(out: Path) -> list[tuple[str, Path]]:
    """Hand in everything that lies below tests/submissions; ids and where it is from."""
    files = [path for path in sorted(SUBMITTED.glob("*/*.py")) if path.parent.name != "similar"]
    named = {f"{path.parent.name}.{path.stem}": path for path in files}
    for name in CHANGED:
        path = out.parent / "written" / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(changed(name), encoding="utf-8")
        named[f"first_lines.{name}"] = path
    for who, handed_in in {**HONEST, **named}.items():
        if who != "styles.timer":  # it is among the honest ones
            hand_in(out, who, handed_in)
    return [*HONEST.items(), *named.items()]


def own_lines(handed_in: Path) -> list[str]:
    """The lines of a hand-in that say something."""
    files = [handed_in] if handed_in.is_file() else sorted(handed_in.rglob("*.py"))
    found = [line.strip() for file in files for line in file.read_text().splitlines()]
    return [line for line in found if len(line) > 10 and "import" not in line]


def verbatim(lines: dict[str, set[str]], one: str, other: str) -> float:
    """How much of the shorter one's lines the other one has, 0 to 1."""
    both = [lines.get(who, set()) for who in (one, other)]
    return len(both[0] & both[1]) / max(1, min(map(len, both)))


if __name__ == "__main__":
    main()
