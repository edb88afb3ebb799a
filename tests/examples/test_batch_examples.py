"""examples/batch: a class on many machines, held against what their documents say."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BATCH = ROOT / "examples" / "batch"


def test_the_workflow_has_its_actions_pinned():
    used = re.findall(r"uses: (\S+)", (BATCH / "github" / "grade-class.yml").read_text())
    (template,) = (ROOT / "grader_class" / "course" / "templates" / "github").rglob("grade.yml")
    known = template.read_text()
    assert used
    assert [action for action in used if f"uses: {action} " not in known] == []


def test_the_script_for_dask_jobqueue_ends_with_what_the_grading_says(tmp_path):
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
