"""The keys that a protocol may name, as PsychoPy calls them, each with its name in X11."""

import string
from collections.abc import Mapping

_NAMED = {
    "space": "space", "return": "Return", "escape": "Escape", "tab": "Tab",
    "backspace": "BackSpace", "delete": "Delete", "insert": "Insert",
    "left": "Left", "right": "Right", "up": "Up", "down": "Down",
    "home": "Home", "end": "End", "pageup": "Prior", "pagedown": "Next",
    "minus": "minus", "equal": "equal", "comma": "comma", "period": "period", "slash": "slash",
    "semicolon": "semicolon", "apostrophe": "apostrophe", "backslash": "backslash",
    "bracketleft": "bracketleft", "bracketright": "bracketright",
    "lshift": "Shift_L", "rshift": "Shift_R", "lctrl": "Control_L", "rctrl": "Control_R",
}  # fmt: skip

KEY_NAMES: Mapping[str, str] = {
    **{sign: sign for sign in string.ascii_lowercase + string.digits},
    **{f"num_{digit}": f"KP_{digit}" for digit in string.digits},
    **{f"f{n}": f"F{n}" for n in range(1, 13)},
    **_NAMED,
}
