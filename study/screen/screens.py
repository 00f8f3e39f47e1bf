"""PsychoPy's window on a screen that is there."""

import os
from typing import Any

from stimuli.errors import InputError, MachineError


def open_on_screen(screen: int, windowed: bool, background: tuple[int, int, int]) -> Any:
    """A window of PsychoPy on a screen; MachineError where no X server answers."""
    try:
        from psychopy import logging, visual

        check_screen(screen)
    except Exception as error:
        if type(error).__name__ != "NoSuchDisplayException":
            raise
        raise MachineError(
            f"screen: expected an X server at DISPLAY={os.environ.get('DISPLAY', '')}, found none "
            "that answers;\nlog in on the lab's machine, or set DISPLAY to a screen that is there"
        ) from error
    logging.console.setLevel(logging.ERROR)
    return visual.Window(
        size=(1280, 800),
        fullscr=not windowed,
        allowGUI=windowed,
        screen=screen,
        color=background,
        colorSpace="rgb255",
        units="pix",
        checkTiming=False,
        waitBlanking=True,
        gammaErrorPolicy="ignore",
        title="Segue",
    )


def check_screen(screen: int) -> None:
    """Refuse a screen that is not there; PsychoPy would take the first in silence."""
    from pyglet.canvas import get_display

    count = len(get_display().get_screens())
    if not 0 <= screen < count:
        there = "screen 0 alone" if count == 1 else f"screens 0 to {count - 1}"
        raise InputError(
            f"--screen {screen}: expected a screen that is there, found {there};\n"
            "leave --screen out, or connect the other and let the system extend the desktop to it"
        )
