"""examples/batch: a class on many machines, with what starts things on them imitated."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
BATCH = ROOT / "examples" / "batch"
PYPROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
PARTS = 16
#: `sbatch`: an array is run at once, one task after the other.
SBATCH = """
while [ "${1#-}" != "$1" ]; do
    case $1 in --array=*) export SLURM_ARRAY_TASK_COUNT=${1#--array=1-} ;; esac
    shift
done
for n in $(seq "${SLURM_ARRAY_TASK_COUNT:-1}"); do SLURM_ARRAY_TASK_ID=$n bash "$@" || code=$?; done
echo "7;cluster"
"""
#: `parallel`: the command stands after --quote, the inputs after :::
PARALLEL = r"""
while [ "$1" != --quote ]; do shift; done
shift
command=()
while [ "$1" != ::: ]; do command+=("$1"); shift; done
shift
for n; do "${command[@]//\{\}/$n}"; done
"""


class Machine:
    """A machine with a `grader` that only writes down its words, a line for each call."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.calls = folder / "calls.txt"
        grader = f"printf '%s\\t' \"$@\" >>'{self.calls}'; echo >>'{self.calls}'\n"
        for name, text in (("grader", grader), ("sbatch", SBATCH), ("parallel", PARALLEL)):
            path = folder / "bin" / name
            path.parent.mkdir(exist_ok=True)
            path.write_text(f"#!/bin/bash\n{text}")
            path.chmod(0o755)

    def run(self, script: str, *words: str) -> list[list[str]]:
        """Run an example; the words of each call of the grader."""
        env = {
            **os.environ,
            "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}",
            "GRADER": str(self.folder / "bin" / "grader"),
        }
        call = subprocess.run(
            ["bash", str(BATCH / script), *words],
            cwd=self.folder,
            env=env,
            capture_output=True,
            text=True,
        )
        assert call.returncode == 0, call.stderr
        return [line.split("\t")[:-1] for line in self.calls.read_text().splitlines()]


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    folder = tmp_path / "a machine"
    (folder / "handed in").mkdir(parents=True)
    return Machine(folder)


def loaded(file: str) -> Any:
    return yaml.safe_load((BATCH / file).read_text(encoding="utf-8"))


@pytest.mark.parametrize("script", ["parallel.sh", "slurm/array.sh"])
def test_each_part_is_graded_once_and_then_all_are_put_together(
    machine: Machine, script: str
) -> None:
    *parts, merge = machine.run(script, "handed in", "the class", "--exercise", "square")
    top = machine.folder
    words = [word for call in parts for word in call]
    assert [word for word in words if re.fullmatch(r"\d+/\d+", word)] == [
        f"{n}/{PARTS}" for n in range(1, PARTS + 1)
    ]
    for number, call in enumerate(parts, 1):
        assert call[:2] == ["batch", str(top / "handed in")]
        assert call[call.index("--out") + 1] == str(top / f"the class.parts/{number}")
        assert call[-2:] == ["--exercise", "square"]
    assert merge[:2] == ["batch", "--merge"]
    assert merge[-4:] == ["--out", str(top / "the class"), "--exercise", "square"]


def test_the_workflow_follows_the_schema_and_has_its_actions_pinned() -> None:
    path = BATCH / "github" / "grade-class.yml"
    words = ["--builtin-schema", "vendor.github-workflows", str(path)]
    check = subprocess.run([sys.executable, "-m", "check_jsonschema", *words], capture_output=True)
    assert check.returncode == 0, check.stdout
    used = re.findall(r"uses: (\S+)", path.read_text())
    known = (ROOT / "examples" / "ci" / "github" / "grade.yml").read_text()
    assert used
    assert [action for action in used if f"uses: {action} " not in known] == []


def test_the_workflow_has_a_job_for_each_part() -> None:
    grade = loaded("github/grade-class.yml")["jobs"]["grade"]
    parts = grade["strategy"]["matrix"]["part"]
    assert parts == list(range(1, len(parts) + 1))
    (shard,) = [step["env"]["SHARD"] for step in grade["steps"] if "env" in step]
    assert shard == "${{ matrix.part }}/${{ strategy.job-total }}"


def test_the_indexed_job_has_an_index_for_each_part() -> None:
    job = loaded("kubernetes/indexed-job.yaml")["spec"]
    (container,) = job["template"]["spec"]["containers"]
    assert job["completionMode"] == "Indexed"
    assert container["env"] == [{"name": "PARTS", "value": str(job["completions"])}]
    *_, command = container["command"]
    subprocess.run(["bash", "-n", "-c", command], check=True)
    assert "part=$((JOB_COMPLETION_INDEX + 1));" in command  # indices begin with 0
    assert job["template"]["spec"]["automountServiceAccountToken"] is False


def test_scheduler_and_workers_of_the_dask_cluster_are_of_one_image() -> None:
    spec = loaded("kubernetes/dask-cluster.yaml")["spec"]
    containers = [spec[part]["spec"]["containers"][0] for part in ("worker", "scheduler")]
    assert len({container["image"] for container in containers}) == 1
    assert "$(DASK_WORKER_NAME)" in containers[0]["args"]  # by which the operator knows it
    text = (BATCH / "kubernetes" / "dask-cluster.yaml").read_text()
    (named,) = re.findall(r"'(distributed>=[\d.]+)'", text)
    assert f'"{named}"' in PYPROJECT


def test_the_script_for_dask_jobqueue_ends_with_what_the_grading_says(tmp_path: Path) -> None:
    (tmp_path / "dask_jobqueue.py").write_text(
        "class SLURMCluster:\n"
        "    scheduler_address = 'tcp://10.0.0.1:8786'\n"
        "    def __init__(self, **words): self.words = words\n"
        "    def __enter__(self): return self\n"
        "    def __exit__(self, *_): print('ended', sorted(self.words))\n"
        "    def adapt(self, minimum_jobs, maximum_jobs): assert minimum_jobs == maximum_jobs\n"
    )
    (tmp_path / "grader").mkdir()
    (tmp_path / "grader" / "__init__.py").touch()
    (tmp_path / "grader" / "__main__.py").write_text("import sys; print(sys.argv[1:]); exit(3)")
    call = subprocess.run(
        [sys.executable, str(BATCH / "slurm" / "with_dask.py"), "handed_in", "--out", "class"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert call.returncode == 3, call.stderr
    words = ["batch", "handed_in", "--out", "class", "--scheduler", "tcp://10.0.0.1:8786"]
    assert str(words) in call.stdout
    assert "ended ['cores', 'memory', 'processes', 'python', 'walltime'" in call.stdout
