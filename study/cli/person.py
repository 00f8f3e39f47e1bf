"""Who takes part: as the command says, or as a dialog is told."""

import argparse

from stimuli.errors import InputError


def settle_participant(args: argparse.Namespace) -> bool:
    """Ask for the participant that a command does not name; False where the dialog was left.

    `args` then holds the id, and the details that were entered with it.
    """
    if args.participant is not None:
        return True
    if args.observer != "human":
        raise InputError("--participant: expected an ID for a simulated observer, found none")
    from study.screen.dialog import ask_participant

    entered = ask_participant()
    if entered is None:
        return False
    args.participant = entered.pop("participant")
    args.details = entered
    return True
