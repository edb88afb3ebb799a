"""What is to be run beside a submission, as the grader says it to the simulator's process."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Self

from grader import strict_json
from grader.run.budget import Budget
from grader.scenes.scene import Limits, Start


@dataclass(frozen=True)
class Plan:
    """One run.

    Attributes:
        limits: when it ends.
        start: where it begins; None for the scene's usual place.
        scene: the name of what runs beside the submission.
        seed: of the varied runs that this one has beside it, for the record.
        flags: remarks that are known before it begins.
        interfaces: those that the submission was written for, where the scene has several; '' for
            its usual ones.
        setting: what the exercise sets the scene up with; '' for nothing.
        looks_at_package: whether the package around the submission's program is looked at as well.
        budget: the one of the whole grading, which the simulator's process does not know.
    """

    limits: Limits
    start: Start | None = None
    scene: str = "turtlesim"
    seed: int | None = None
    flags: tuple[str, ...] = ()
    interfaces: str = ""
    setting: str = ""
    looks_at_package: bool = False
    budget: Budget = field(default_factory=Budget, compare=False, metadata=strict_json.UNSTORED)

    def to_json(self) -> str:
        """As an argument of the simulator's process."""
        return json.dumps(strict_json.to_json(self, strict_json.OURS))

    @classmethod
    def from_json(cls, text: str) -> Self:
        """The plan that `to_json` has written.

        Raises:
            ValueError: it has written none such.
        """
        return strict_json.from_json(cls, json.loads(text), strict_json.OURS)
