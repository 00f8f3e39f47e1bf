"""What the statistics say about bad input."""


class InputError(Exception):
    """Input that cannot be used; the message says where, expected, found and what to do."""


class InputWarning(UserWarning):
    """Input that is used although something about it is suspicious."""
