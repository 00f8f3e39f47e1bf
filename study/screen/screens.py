"""PsychoPy's window on a screen that is there."""

import os
from typing import Any

from stimuli.errors import InputError, MachineError

WINDOWED = (1280, 800)  # where the screen is as large


def open_on_screen(screen: int, windowed: bool, background: tuple[int, int, int]) -> Any:
    """A window of PsychoPy on a screen; MachineError where no X server answers."""
    try:
        from psychopy import logging, visual

        there = size_of(screen)
    except Exception as error:
        if type(error).__name__ != "NoSuchDisplayException":
            raise
        raise MachineError(
            f"screen: expected an X server at DISPLAY={os.environ.get('DISPLAY', '')}, found none "
            "that answers;\nlog in on the lab's machine, or set DISPLAY to a screen that is there"
        ) from error
    logging.console.setLevel(logging.ERROR)
    return visual.Window(
        size=tuple(min(most, has) for most, has in zip(WINDOWED, there, strict=True)),
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


def size_of(screen: int) -> tuple[int, int]:
    """The size of a screen; InputError where it is not there, as PsychoPy would take the first."""
    from pyglet.canvas import get_display

    screens = get_display().get_screens()
    count = len(screens)
    if not 0 <= screen < count:
        there = "screen 0 alone" if count == 1 else f"screens 0 to {count - 1}"
        raise InputError(
            f"--screen {screen}: expected a screen that is there, found {there};\n"
            "leave --screen out, or connect the other and let the system extend the desktop to it"
        )
    return int(screens[screen].width), int(screens[screen].height)
