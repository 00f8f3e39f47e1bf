"""PsychoPy's dialog for who takes part, in a process of its own.

A window system's library that lacks a part ends the process that loads it; and the session's own
window is to have nothing of it beside itself. `python -m study.screen.dialog` shows the dialog and
prints what was entered as JSON, or null where it was cancelled.
"""

import json
import subprocess
from typing import Any

from stimuli.errors import InputError
from stimuli.interpreter import own_environment, own_python
from study.record.dataset import check_participant
from study.record.people import QUESTIONS
from study.screen.virtual import has_screen

_TITLE = "Segue: who takes part?"
BLANK = "n/a"


def ask_participant() -> dict[str, str] | None:
    """The participant's id and details by column, from a dialog; None where it was cancelled.

    Raises InputError where no dialog can be shown.
    """
    if not has_screen():
        raise InputError("--participant: expected an ID, found none and no screen to ask for it on")
    done = subprocess.run(
        own_python("-m", "study.screen.dialog"),
        env=own_environment(), capture_output=True, text=True, check=False,
    )  # fmt: skip
    lines = done.stdout.strip().splitlines()
    if done.returncode != 0 or not lines:
        why = (done.stderr.strip().splitlines() or ["it stopped without a word"])[-1]
        raise InputError(
            f"--participant: found none, and no dialog opens to ask for it ({why[:100]}); give it"
        )
    held = json.loads(lines[-1])
    return None if held is None else {str(key): str(value) for key, value in held.items()}


def fault_of(entered: dict[str, str]) -> str | None:
    """What is wrong with what was entered, for the dialog to say."""
    try:
        check_participant(entered["participant"])
    except InputError as error:
        return str(error)
    if entered["age"] and QUESTIONS["age"].plain(entered["age"]) is None:
        return f"age {entered['age']!r}: expected years, as 34, or nothing"
    return None


def _show(entered: dict[str, str], fault: str | None) -> dict[str, str] | None:
    """One showing of the dialog, with what was entered before; None where it was cancelled."""
    from psychopy import gui

    shown: Any = gui.Dlg(title=_TITLE)
    if fault:
        shown.addText(fault, color="red")
    shown.addField("participant", entered["participant"], label="participant's ID*", required=True)
    for name, detail in QUESTIONS.items():
        choices = list(dict.fromkeys((BLANK, *detail.answers))) if detail.answers else None
        initial = entered[name] or (BLANK if choices else "")
        shown.addField(name, initial, choices=choices, label=detail.asked)
    held = shown.show()
    if not shown.OK:
        return None
    told = {name: str(held[name]).strip() for name in ("participant", *QUESTIONS)}
    return {name: "" if text == BLANK else text for name, text in told.items()}


def _main() -> None:
    from study.screen.home import writable_home

    entered: dict[str, str] | None = dict.fromkeys(("participant", *QUESTIONS), "")
    fault = None
    with writable_home():
        while entered is not None:
            entered = _show(entered, fault)
            fault = None if entered is None else fault_of(entered)
            if fault is None:
                break
    print(json.dumps(entered))


if __name__ == "__main__":
    _main()
