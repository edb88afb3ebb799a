from grader.testing.checking import check_exercise as check_exercise
from grader.testing.driving import drive as drive
from grader.testing.extensions import check_report as check_report
from grader.testing.extensions import check_scene as check_scene
from grader.testing.solutions import right_solutions as right_solutions
