"""What is looked at: package and launch file, then what the node sends of the robot."""

from __future__ import annotations

from grader.exercise.check import Checks, Tolerances
from grader.exercise.sentences import error_first
from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.circle import judge_odometry
from grader.exercises.state_publisher.links import judge_links
from grader.exercises.state_publisher.moving import judge_moves
from grader.exercises.state_publisher.naming import judge_names
from grader.exercises.state_publisher.packaging import judge_launch, judge_package
from grader.exercises.state_publisher.rate import judge_rate
from grader.exercises.state_publisher.seen import Seen
from grader.exercises.state_publisher.stamping import judge_stamps
from grader.recording.recording import Recordings

checks = Checks()


@checks()
def package(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It is a package with an entry point.

    A console script in setup.py starts the node, and nothing keeps `colcon build` or `ros2 run`
    from doing so. Half of the points where something does. A single file has none of them.
    setup.py is run with a `setup()` that only takes down what it gets.
    """
    return judge_package(recordings.nominal)


@checks()
def launch(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Its launch file starts robot and node.

    A launch file of the package starts robot_state_publisher with the parameter robot_description
    (2/5), and the package's own node, without another source of joint states beside it (2/5);
    setup.py installs it and all files that it reads, and none of them is looked for in somebody's
    home (1/5). It is evaluated with its default arguments, where the package is laid out as if
    installed, and starts nothing. If it ends with an error: 0. Of several launch files the best
    counts.
    """
    return judge_launch(recordings.nominal)


@checks()
def publishes(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It publishes steadily.

    Joint states come {rate_least_hz} to {rate_most_hz} times a second, and for {rate_share%} of the
    time their number in half a second is off the usual by {rate_deviation%} at most: half of the
    points. The same holds for the node's transforms on /tf, if it sends any: the other half. Half
    at most for more than {static_most} messages on /tf_static, or a message that holds the same
    transform twice.
    """
    return error_first(recordings, judge_rate(Seen(recordings), tolerances))


@checks()
def joint_names(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The joint states name the robot's joints.

    All joints of the URDF that move are named, and no others: the points are the number of names
    in both, divided by the number of names in either. A joint state with more or fewer positions
    than names is ignored by robot_state_publisher: half of the points at most, less by the share of
    such messages.
    """
    return error_first(recordings, judge_names(Seen(recordings)))


@checks()
def stamps(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The messages carry the time.

    No stamp is 0; else there are no points. From message to message they increase (1/5 of the
    points), and {same_share%} of the transforms have the stamp of a joint state (2/5).
    """
    return error_first(recordings, judge_stamps(Seen(recordings), tolerances))


@checks()
def joints_move(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The joints move as they should.

    A continuous joint turns on, one way for 95 % of the time, by {turn_least_rad} rad at least and
    by no more than {turn_most} rad/s. A revolute one goes to and fro, {swing_least_rad} to
    {swing_most_rad} rad wide, a prismatic one {push_least_m} to {push_most_m} m wide; both turn
    back {returns} times at least, and go step by step. The points are the part of the joints that
    do. Limits in the URDF do not count.
    """
    return error_first(recordings, judge_moves(Seen(recordings), tolerances))


@checks()
def odometry(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The robot goes in a circle and looks ahead.

    The transforms from `odom` to the root link lie on a circle with a radius of {radius_least_m} to
    {radius_most_m} m, in either direction, and go one way without jumps (35 % of the points); at a
    constant height of {height_least_m} to {height_most_m} m (15 %); the robot stands upright and
    looks in the direction in which it goes, give or take {heading_deg} degrees (30 %); and the
    quaternion has the length 1 (20 %).
    """
    return error_first(recordings, judge_odometry(Seen(recordings), tolerances))


@checks()
def reachable(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Every link has its place in odom.

    From `odom`, tf2 finds a way to every link of the URDF; each frame has one parent, and one
    sender: the node or robot_state_publisher. All or nothing.
    """
    return error_first(recordings, judge_links(Seen(recordings)))
