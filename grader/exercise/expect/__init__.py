"""Expectations as data: what an exercise.yaml says under `expect:`, as checks.

`expectations` reads them, `judging` looks at what was exchanged (`grader.scenes.cast.trace`),
`comparing` compares values.
"""
