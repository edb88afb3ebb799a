"""Do the tests notice a change? Mutation testing with cosmic-ray, in a clone of the last commit.

    make mutate ARGS="grader/exercise grader/exercise/result --count 100"

It changes random places: a comparison, a number, a condition, an exception. For each change the
tests of the same folder run, those of its module first, until one fails: those of `make test`, then
the rest of `make test-all`. The changes that no test has noticed are printed. The same call again
goes on where it was stopped; after a commit it begins anew, at the same places as long as the code
is the same.

As root the tests run in a separate process namespace: a changed program may kill the wrong ones.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import random
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import attrs
from cosmic_ray import commands
from cosmic_ray.modules import filter_paths, find_modules
from cosmic_ray.mutating import mutate_and_test
from cosmic_ray.testing import run_tests
from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import TestOutcome

ROOT = Path(__file__).resolve().parents[1]
TREE = ROOT / "build" / "mutants"
#: Students' programs.
EXCLUDED = [f"**/{name}/**/*.py" for name in ("starter", "reference", "right")]
#: `|` is mostly in annotations, which are never run.
EQUIVALENT = "core/ReplaceBinaryOperator_BitOr_"
PYTEST = "-m pytest -x -q -n0 -p no:randomly -p no:cacheprovider"
#: The tests of `make test`, then the rest; pytest's own options, and how long they may take [s].
TIERS = (("-m 'not more'", 300.0), ("-m more", 1800.0))
#: What pytest exits with where a folder has no test of a tier.
NO_TESTS = 5
APART = ("unshare", "--mount", "--pid", "--fork", "--mount-proc", "--kill-child")


def clone() -> str:
    """Bring the clone to the last commit, with a .venv; return that commit."""
    if not TREE.exists():
        _run("git", "clone", "-q", str(ROOT), str(TREE), cwd=ROOT)
    _run("git", "fetch", "-q", str(ROOT), "HEAD")
    _run("git", "checkout", "-q", "-f", "--detach", "FETCH_HEAD")
    print(
        f"== preparing {TREE.relative_to(ROOT)}, a clone with an environment of its own", flush=True
    )
    _run("make", "tools")
    return _run("git", "rev-parse", "--short=10", "HEAD").strip()


def _run(*words: str, cwd: Path = TREE) -> str:
    return subprocess.run(words, cwd=cwd, check=True, stdout=subprocess.PIPE, text=True).stdout


def draw(session: WorkDB, modules: Sequence[str], count: int, seed: int) -> None:
    """Fill a session with mutants of these files and folders."""
    paths = filter_paths(find_modules(map(Path, modules)), EXCLUDED)
    commands.init(sorted(paths), session, {})
    items = [
        item
        for item in session.work_items
        if not item.mutations[0].operator_name.startswith(EQUIVALENT)
    ]
    items.sort(key=lambda item: str(item.mutations))
    session.clear()
    session.add_work_items(random.Random(seed).sample(items, min(count, len(items))))


def tests_of(module: Path) -> list[str]:
    """Return the tests of a module's folder, or of the nearest folder above with tests."""
    folder = Path("tests") / module.parent
    while not (found := sorted(map(str, folder.glob("test_*.py")))):
        folder = folder.parent
    return sorted(found, key=lambda name: not name.endswith(f"/test_{module.stem}.py"))


def execute(session: WorkDB) -> None:
    """Run the tests for each mutant that has no result yet."""
    site = next(Path(".venv").glob("lib/python*/site-packages"))
    refused = subprocess.run([*APART, "true"], stderr=subprocess.DEVNULL).returncode
    passed: set[str] = set()
    modules = {Path(item.mutations[0].module_path) for item in session.work_items}
    for module in modules:  # a run that was stopped has left one changed
        shutil.copyfile(module, site / module)
    for item in session.pending_work_items:
        module = Path(item.mutations[0].module_path)
        for tier, (which, timeout_s) in enumerate(TIERS):
            tests = f".venv/bin/python {PYTEST} {which} {' '.join(tests_of(module))}"
            # programs that tests start are the installed ones
            words = f"cp {module} {site / module} && {{ {tests} || [ $? -eq {NO_TESTS} ]; }}"
            command = shlex.join(["sh", "-c", words])
            if not refused:
                command = f"{shlex.join(APART)} {command}"
            if command not in passed:
                outcome, output = run_tests(command, timeout_s)
                if outcome != TestOutcome.SURVIVED:
                    raise SystemExit(f"{output}\nTests fail with nothing changed: see above.")
                passed.add(command)
            result = mutate_and_test(item.mutations, command, timeout_s)
            shutil.copyfile(module, site / module)
            if result.is_killed:
                result = attrs.evolve(result, output=f"{tier} {result.output}")
                break
        session.set_result(item.job_id, result)
        done = f"{session.num_results}/{session.num_work_items}"
        print(f"{done} {module}: {result.test_outcome.value} {tier}", flush=True)


def report(session: WorkDB) -> None:
    """Print the changes that no test has noticed, and how many were noticed."""
    results = [result for _, result in session.results]
    survivors = [result for result in results if not result.is_killed]
    for result in survivors:
        print(*result.diff.splitlines()[1:], sep="\n", end="\n\n")
    noticed = [result.output for result in results if result.is_killed]
    first = sum(output.startswith("0 ") for output in noticed)
    late = sum(output.endswith(" timeout") for output in noticed)
    print(
        f"{first} of {len(results)} changes were noticed by make test, {len(noticed) - first} more "
        f"by the rest; {late} of them by a time-out"
    )


def main() -> None:
    """Draw mutants, or go on with those that were drawn, and report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("modules", nargs="+", help="files or folders, as grader/exercise")
    parser.add_argument("--count", type=int, default=200, help="mutants at most: %(default)s")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    # what the wheels set for this process: the libraries of the clone are its own
    for name in ("LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE"):
        os.environ.pop(name, None)
    commit = clone()
    os.chdir(TREE)
    drawn = hashlib.sha256("+".join(args.modules).encode()).hexdigest()[:10]
    file = TREE.with_name(f"mutants-{commit}-{drawn}-{args.count}-{args.seed}.sqlite")
    is_new = not file.exists()
    with use_db(file) as session:
        if is_new:
            draw(session, args.modules, args.count, args.seed)
        execute(session)
        report(session)


if __name__ == "__main__":
    main()
