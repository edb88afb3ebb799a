"""Run a submission, record what its turtle really did, judge it, explain the verdict."""
