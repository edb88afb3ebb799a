"""The limits on what a submission may request of a graded turtlesim, and remarks on refusals.

The numbers are far above what it takes to drive turtles. They keep every run short and its
recording small; a turtlesim that grades nobody has no such limits.
"""

from __future__ import annotations

from grader.text.message import Message, msg

#: Turtles at a time: each publishes in every tick, and has a trajectory in the recording.
MOST_TURTLES = 32
#: Turtles in a run, with those of `reset`: each needs fifteen endpoints of DDS.
MOST_HATCHED = 200
#: Inputs in a run: the whole recording is judged, and written to disk.
MOST_EVENTS = 100_000
#: Lines of the simulator's log in a run.
MOST_LOGS = 20_000
#: Rotation goals at a time: running, or ended in the last ten seconds. All of them are in each
#: message of an action's status.
MOST_GOALS = 100
#: Entries of one request to a service for parameters.
MOST_ENTRIES = 1_000
#: Pictures that `save_canvas` writes in a run.
MOST_PICTURES = 100
#: Of a name [characters]; ROS allows less, so no turtle has a longer one.
LONGEST_NAME = 300
#: Parameters that decide how a run is judged, or where files are written.
FIXED = {
    "use_sim_time": msg("the parameter use_sim_time cannot be set: the run has a clock of its own"),
    "canvas_folder": msg(
        "the parameter canvas_folder cannot be set: the run has a folder of its own"
    ),
}
#: More different remarks than this are not kept.
MOST_FLAGS = 20
_NOT_ALL = msg(
    "what the node sent after its first {number} messages was not taken", number=MOST_EVENTS
)
_FIRST_LINES = msg("of the simulator's log the first {number} lines were kept", number=MOST_LOGS)
_NO_MORE_PICTURES = msg("save_canvas wrote {number} pictures and no more", number=MOST_PICTURES)
_MANY_AT_A_TIME = msg(
    "more than {number} turtles at a time: the others were refused", number=MOST_TURTLES
)
_MANY_IN_A_RUN = msg(
    "more than {number} turtles in a run: the others were refused", number=MOST_HATCHED
)


class Allowance:
    """Counts what a run has used.

    Attributes:
        hatched: the number of turtles that there have been.
        events, logs, pictures: their numbers.
    """

    def __init__(self) -> None:
        self.hatched = self.events = self.logs = self.pictures = 0
        self._flags: dict[Message, None] = {}

    @property
    def flags(self) -> tuple[Message, ...]:
        """Remarks for the result: requests of the submission that were refused."""
        return tuple(self._flags)

    def refuse(self, remark: Message) -> None:
        """Note a refusal, with the remark for the result."""
        if len(self._flags) < MOST_FLAGS:
            self._flags[remark] = None

    def _allow(self, is_within: bool, remark: Message) -> bool:
        if not is_within:
            self.refuse(remark)
        return is_within

    @property
    def is_used_up(self) -> bool:
        """Whether nothing more will be served."""
        return not self._allow(self.events < MOST_EVENTS, _NOT_ALL)

    def may_log(self) -> bool:
        """Whether the simulator may log another line."""
        self.logs += 1
        return self._allow(self.logs <= MOST_LOGS, _FIRST_LINES)

    def may_save(self) -> bool:
        """Whether another picture may be written."""
        self.pictures += 1
        return self._allow(self.pictures <= MOST_PICTURES, _NO_MORE_PICTURES)

    def why_not_hatch(self, turtles: int) -> str:
        """Return why there may be no turtle beside so many others; '' where there may."""
        if turtles >= MOST_TURTLES:
            self.refuse(_MANY_AT_A_TIME)
            return f"more than {MOST_TURTLES} turtles at a time"
        if self.hatched >= MOST_HATCHED:
            self.refuse(_MANY_IN_A_RUN)
            return f"more than {MOST_HATCHED} turtles in a run"
        return ""
