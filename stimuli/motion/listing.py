"""What a clip was taken for, in the form in which a person can correct it."""

import json

from stimuli.motion.clip import Clip
from stimuli.motion.overrides import OVERRIDES
from stimuli.motion.roles import ROLES


def roles_as_overrides(clip: Clip) -> str:
    """The roles of a clip's joints as a file of overrides to start from (TOML).

    Roles that no joint plays, and those of a joint that shares its name with one before it, which
    cannot be named, stand there as comments.
    """
    skeleton = clip.motion.skeleton
    lines = [
        f"# {clip.path.name}: keep what should stay so in {OVERRIDES} beside it,",
        f"# for this clip alone as [clips.{_quoted(clip.path.name)}.roles].",
        *(f"# {_quoted(note)[1:-1]}" for note in clip.warnings),
        "[roles]",
    ]
    for role in ROLES:
        joint = skeleton.roles.get(role)
        if joint is None:
            lines.append(f'# {role} = ""')
        elif skeleton.names.index(skeleton.names[joint]) != joint:
            name = _quoted(skeleton.names[joint])
            lines.append(f"# {role} = {name}, another joint than the first of that name")
        else:
            lines.append(f"{role} = {_quoted(skeleton.names[joint])}")
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    """A string as TOML has it, which is JSON's but for one character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
