"""Sentences that the processes of this scene's runs say as texts, for other languages."""

from __future__ import annotations

from grader.language.phrase import marked

#: Remarks on a run; see `grader.recording.remarks`.
REMARKS = (
    marked("what the node sent after its first {number} messages was not taken"),
    marked("of the simulator's log the first {number} lines were kept"),
    marked("save_canvas wrote {number} pictures and no more"),
    marked("requests for more than {number} parameters were refused"),
    marked("more than {number} rotation goals in ten seconds were refused"),
    marked("the parameter use_sim_time cannot be set: the run has a clock of its own"),
    marked("the parameter canvas_folder cannot be set: the run has a folder of its own"),
    marked("more than {number} turtles at a time: the others were refused"),
    marked("more than {number} turtles in a run: the others were refused"),
)
