from grader.run.opening import marks_of as marks_of
from grader.run.processes import cores as cores
from grader.run.processes import levels as levels
from grader.run.processes import started_process as started_process
