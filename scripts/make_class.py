"""Make a class of submissions out of the test fixtures, as a course system would export it.

    .venv/bin/python scripts/make_class.py FOLDER [--count 300] [--seed 1]

The folder is like Moodle's "Download all submissions": `Full Name_ID_assignsubmission_file_/`.
About half are right or lack one thing (the challenge's solution and its mutants), a third are
beginners' mistakes, a tenth is hostile, some cannot be started, and some are copies of others. The
same seed makes the same class.
"""

from __future__ import annotations

import argparse
import random
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.exercise.loading import load_exercise  # noqa: E402
from grader.testing.solutions import read_solutions  # noqa: E402
from tests.submissions.beginners import CHANGED, changed  # noqa: E402

ATTACKS = ROOT / "tests" / "attacks" / "submissions"
FIRST = ("Zoë", "Li", "José", "Anna Maria", "O'Neil", "Søren", "Fatıma", "Jürgen", "Nguyễn", "Ada")
LAST = ("Müller", "van der Berg", "Ødegård", "D'Angelo", "Çelik", "Smith", "Łukasz", "García")
#: None needs real time or a minute of a processor, so that the class costs as much as a usual one.
HOSTILE = (
    *("imitates_results", "crashes", "fakes_a_traceback", "prints_escapes", "exits_oddly"),
    *("lies_about_itself", "turns_on_the_spot", "replaces_builtins", "drives_beyond_all_numbers"),
)
UNUSABLE: dict[str, bytes] = {
    "turtle_controller.zip": b"PK\x03\x04 and nothing more",
    "notes.txt": b"I could not do it.\n",
    "turtle_controller.py": b"import rclpy\ndef main()\n    pass\n",
}
#: Of ten submissions: (number, kind).
SHARES = ((5, "right"), (3, "beginner"), (1, "hostile"), (1, "odd"))


def programs() -> dict[str, list[str]]:
    """Return the texts of programs by their kind."""
    right = [each.text() for each in read_solutions(load_exercise("turtlesim_challenge"))]
    return {
        # the reference more often, as not all students make a mistake; and its mutants
        "right": right[:1] * (len(right) // 2) + right,
        # except those that use a minute of a processor each
        "beginner": [changed(n) for n in sorted(CHANGED) if not n.startswith(("loops", "floods"))],
        "hostile": [(ATTACKS / f"{name}.py").read_text(encoding="utf-8") for name in HOSTILE],
    }


def make(folder: Path, count: int, seed: int) -> None:
    """Write a class into a folder that is not there yet."""
    chance = random.Random(seed)
    texts = programs()
    pool = [kind for share, kind in SHARES for _ in range(share)]
    earlier: list[str] = []
    for number in range(count):
        name = f"{chance.choice(FIRST)} {chance.choice(LAST)}"
        at = folder / f"{name}_{100000 + number}_assignsubmission_file_"
        at.mkdir(parents=True)
        kind = chance.choice(pool)
        if kind == "odd" and earlier and chance.random() < 0.5:
            (at / "turtle_controller.py").write_text(chance.choice(earlier), encoding="utf-8")
        elif kind == "odd":
            file = chance.choice(sorted(UNUSABLE))
            (at / file).write_bytes(UNUSABLE[file])
        else:
            text = f"{chance.choice(texts[kind])}\n# {number}\n"
            earlier.append(text)
            (at / "turtle_controller.py").write_text(text, encoding="utf-8")


def main() -> int:
    """Make one."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    if args.folder.exists():
        parser.error(f"{args.folder} exists already")
    make(args.folder, args.count, args.seed)
    print(f"{args.folder}: {args.count} submissions")
    return 0


if __name__ == "__main__":
    sys.exit(main())
