"""How much a submission may ask of a graded turtlesim; what it does not get, and that it is told.

The numbers are far above what drives turtles. They keep a run short, and what is recorded of it
small, whatever comes; the node beside which nobody is graded has none of them.
"""

from __future__ import annotations

#: Turtles at a time: each publishes in every tick, and has a way in the recording.
MOST_TURTLES = 32
#: Turtles in a run, those of `reset` too: each takes fifteen endpoints of DDS.
MOST_HATCHED = 200
#: Inputs in a run: the whole recording is judged, and written to disk.
MOST_EVENTS = 100_000
#: Lines of the simulator's log in a run.
MOST_LOGS = 20_000
#: Rotation goals that are known at a time: what runs, or has ended in the last ten seconds. All of
#: them are in each message of an action's status.
MOST_GOALS = 100
#: Entries of one request to a service for parameters.
MOST_ENTRIES = 1_000
#: Pictures that `save_canvas` writes in a run.
MOST_PICTURES = 100
#: Of a name [characters]; ROS allows less, so a longer one is no turtle's.
LONGEST_NAME = 300
#: Parameters that decide how a run is judged, or where files are written.
FIXED = {
    "use_sim_time": "the run has a clock of its own",
    "canvas_folder": "the run has a folder of its own",
}
#: More different remarks than this are not kept.
MOST_FLAGS = 20


class Allowance:
    """What of it a run has used.

    Attributes:
        hatched: how many turtles there have been.
        events, logs, pictures: how many there have been.
    """

    def __init__(self) -> None:
        self.hatched = self.events = self.logs = self.pictures = 0
        self._flags: dict[str, None] = {}

    @property
    def flags(self) -> tuple[str, ...]:
        """For the result: what the submission asked for and did not get."""
        return tuple(self._flags)

    def refuse(self, what: str) -> None:
        """Something was refused; the text stands for itself in a result."""
        if len(self._flags) < MOST_FLAGS:
            self._flags[what] = None

    @property
    def is_used_up(self) -> bool:
        """Whether nothing more is to be served."""
        if self.events < MOST_EVENTS:
            return False
        self.refuse(f"what the node sent after its first {MOST_EVENTS} messages was not taken")
        return True

    def may_log(self) -> bool:
        """Whether the simulator may log another line."""
        self.logs += 1
        if self.logs <= MOST_LOGS:
            return True
        self.refuse(f"of the simulator's log the first {MOST_LOGS} lines were kept")
        return False

    def may_save(self) -> bool:
        """Whether another picture may be written."""
        self.pictures += 1
        if self.pictures <= MOST_PICTURES:
            return True
        self.refuse(f"save_canvas wrote {MOST_PICTURES} pictures and no more")
        return False

    def why_not_hatch(self, turtles: int) -> str:
        """Why there may not be another turtle beside so many; '' where there may."""
        why = ""
        if turtles >= MOST_TURTLES:
            why = f"more than {MOST_TURTLES} turtles at a time"
        elif self.hatched >= MOST_HATCHED:
            why = f"more than {MOST_HATCHED} turtles in a run"
        if why:
            self.refuse(f"{why}: the others were refused")
        return why
