from grader.system import content as content
from grader.system import expressions as expressions
from grader.system import files as files
from grader.system import requirements as requirements
from grader.system import strict_json as strict_json
from grader.system import versions as versions
from grader.system.removal import remove as remove
from grader.system.scratch import make_folder as make_folder
