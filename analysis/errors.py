"""What the statistics say about bad input."""


class InputError(Exception):
    """Input that cannot be used; the message says where, expected, found and what to do."""


class NothingAnalysed(InputError):
    """Input that was read, but of which nothing is left to analyse; the message says why."""


class InputWarning(UserWarning):
    """Input that is used although something about it is suspicious."""
