"""What a question to a buffer can end in: tf2's six exceptions, by their names in Python."""


class TransformException(Exception):
    """Any of them."""


class ConnectivityException(TransformException):
    """The two frames hang in different trees."""


class LookupException(TransformException):
    """A frame is not known, or the frames make a loop."""


class ExtrapolationException(TransformException):
    """There is no data at that time."""


class InvalidArgumentException(TransformException):
    """A name that no frame can have."""


class TimeoutException(TransformException):
    """Raised by no lookup: what has not come in time is one of the others."""
