"""What happens in the process that looks at a package: its set-up, launch files and URDFs.

`main` does all of it in order. What runs a stranger's code does so in a copy of the process, which
ends with it (`steps`). Nothing of what is done here is believed outside: see
`grader.submission.package_trace`.
"""
