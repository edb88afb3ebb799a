"""Sentences that the processes of this scene's runs say as texts, for other languages."""

from __future__ import annotations

from grader.language.phrase import marked

#: Remarks on a run; see `grader.recording.remarks`.
REMARKS = (marked("of the node's messages the first {number}, or {megabytes} MB, were taken"),)
