from grader import Checks, Finding

checks = Checks()


@checks()
def colours(recordings, tolerances):
    """The light shows several colours."""
    shown = {colour for _, _, colour in recordings.nominal.trace.shown}
    return Finding(
        min(len(shown) / tolerances["colours"], 1), f"{len(shown)} colours.", "Does a timer run?"
    )


@checks()
def mixes(recordings, tolerances):
    """A colour was mixed by the service, and shown."""
    trace = recordings.nominal.trace
    asked = {colour for _, _, colour in trace.mixed}
    shown = {colour for _, _, colour in trace.shown}
    return Finding(float(bool(asked & shown)), f"{len(asked)} mixed.", "Show the answer of /mix.")
