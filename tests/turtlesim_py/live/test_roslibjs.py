import subprocess

from turtlesim.msg import Pose

from tests.needs import ROSLIBJS, needs
from tests.programs import DEADLINE_S, ROOT

PROGRAM = ROOT / ROSLIBJS


@needs("node", "roslibjs")
def test_roslibjs_drives_sets_the_pen_and_turns(page, graph):
    poses = graph.listen(Pose, "/seen/turtle1/pose")
    socket = f"{page.address.replace('http', 'ws')}socket"
    done = subprocess.run(
        ["node", PROGRAM / "drive.js", socket, "/seen"],
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
    )
    assert done.stdout.splitlines() == ["topics true", "pen 0", "turned true"], done
    graph.until(lambda: any(pose.x > 7 and pose.theta > 0.9 for pose in poses), "the turned pose")
