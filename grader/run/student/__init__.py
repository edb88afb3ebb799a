"""Starts and observes a submission's program in its process of a run, by either clock.

| module | what it does |
|---|---|
| `main` | in real time; also the several programs of a launch file |
| `virtual_main` | in virtual time: puts `grader.run.clock` and `grader.run.observe` together |
| `loading` | loads a program as a student's machine would |
"""
