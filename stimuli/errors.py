"""What goes wrong with input, said in one or two lines: where, expected, found, what to do."""


class InputError(ValueError):
    """Input that cannot be used; the message is for the person who gave it."""


class UnwritableError(InputError):
    """A file cannot be written where it was wanted; the system's reason is its cause."""


class InputWarning(UserWarning):
    """Input that was read but looks suspicious."""


class MachineError(Exception):
    """The machine lacks something or gave out: what was kept, and what to do, in two lines."""
