"""Grades a class on workers that dask-jobqueue has Slurm start.

    pip install dask-jobqueue 'turtlesim_py[cluster]'
    python with_dask.py SUBMISSIONS --out CLASS [an option of grader batch] ...

The grader is on all nodes, and SUBMISSIONS and CLASS lie in a folder that all of them see.
"""

import subprocess
import sys

from dask_jobqueue import SLURMCluster


def main() -> int:
    """Start a cluster, grade on it, end it; the exit code of `grader batch`."""
    with SLURMCluster(
        # EDIT: what one job may take; so many gradings go at once in it
        cores=4,
        processes=1,
        memory="4GB",
        walltime="01:00:00",
        # EDIT: the Python in which the grader is installed
        python="/opt/turtlesim-grader/bin/python",
        # ends before its time is up, and hands its work over
        worker_extra_args=["--lifetime", "55m", "--lifetime-stagger", "4m"],
    ) as cluster:
        # EDIT: so many jobs; each that ends is replaced
        cluster.adapt(minimum_jobs=16, maximum_jobs=16)
        words = ["batch", *sys.argv[1:], "--scheduler", cluster.scheduler_address]
        return subprocess.run([sys.executable, "-m", "grader", *words], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
