"""The cast of an exercise: scripted peers of a submission's nodes, and a recorder of what is said.

`script` reads it from exercise.yaml, `peers` plays it in the simulator's process, `recorder` keeps
what is sent, `trace` is what a recording has of it. Any scene can have one; `scene` is a cast
alone.
"""
