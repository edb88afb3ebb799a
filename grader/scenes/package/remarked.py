"""Sentences that the processes of this scene's runs say as texts, for other languages."""

from __future__ import annotations

from grader.language.phrase import marked

#: Remarks on a run; see `grader.recording.remarks`.
REMARKS = (
    marked("the package's own code has stopped (SIGSTOP) the process that looks at it"),
    marked("the process that looked at the package left nothing that can be read: {why_not}"),
)
