"""Starts a submission's program in its process of a run, and observes it; by either clock.

| module | what it does |
|---|---|
| `main` | in real time; also the several programs of a launch file |
| `virtual_main` | in virtual time: puts `grader.run.clock` and `grader.run.observe` together |
| `loading` | loads a program as it would be found at a student's desk |
"""
