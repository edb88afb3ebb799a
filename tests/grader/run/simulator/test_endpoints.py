import pytest
from rclpy.qos import QoSProfile

from grader.run.lockstep.matching import Writer
from grader.run.lockstep.protocol import SHIFT, EndpointInfo, Table
from grader.run.simulator.endpoints import MOST_ENDPOINTS, SimulatorEndpoints

TALKS = EndpointInfo("/a", "topic /chatter", "std_msgs/msg/String", True, id=1 << SHIFT | 1)


@pytest.fixture
def endpoints():
    return SimulatorEndpoints(lambda: 0, lambda remark: None)


def test_what_a_program_has_is_known_until_it_says_that_it_is_gone(endpoints):
    endpoints.note(Table((TALKS,)))
    assert endpoints.published == {"/chatter": "std_msgs/msg/String"}
    assert [each.node for each in endpoints.theirs] == ["/a"]
    endpoints.note(Table((), (TALKS.id,)))
    assert endpoints.theirs == ()
    assert endpoints.published == {"/chatter": "std_msgs/msg/String"}


def test_a_writer_is_heard_by_readers_of_its_type_whose_quality_of_service_fits(endpoints):
    writer = Writer(TALKS.channel, TALKS.type, QoSProfile(depth=10))
    endpoints.add(writer)
    hears = TALKS._replace(writes=False)
    endpoints.note(Table((hears._replace(type="std_msgs/msg/Int32"),)))
    assert endpoints.count_readers(writer) == 0
    endpoints.note(Table((hears._replace(durability=1),)))  # it wants what nobody keeps
    assert endpoints.count_readers(writer) == 0
    endpoints.note(Table((hears._replace(depth=2**32 - 1),)))
    assert endpoints.count_readers(writer) == 1


@pytest.mark.parametrize(
    "table",
    [
        Table((TALKS._replace(id=1),)),
        Table((TALKS._replace(id=2 << SHIFT | 1),)),
        Table((), (1,)),
        Table((TALKS._replace(reliability=77),)),
        Table(tuple(TALKS._replace(id=TALKS.id + n) for n in range(MOST_ENDPOINTS + 1))),
    ],
    ids=["the simulator's", "another program's", "removes ours", "no reliability", "too many"],
)
def test_what_no_program_of_ours_says_of_its_endpoints_is_refused(endpoints, table):
    with pytest.raises(ValueError, match=r"."):
        endpoints.note(table)
