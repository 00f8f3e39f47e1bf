"""Reading the hierarchy of a BVH: statement by statement, without recursion, within bounds."""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from stimuli.motion.formats.source import MOST_JOINTS, fault, shown
from stimuli.motion.formats.words import IN_BOUNDS, decimals
from stimuli.motion.quaternions import Array

AXES = "XYZ"
_CHANNEL = re.compile(r"([XYZ])(position|rotation)", re.IGNORECASE)


@dataclass
class Hierarchy:
    """A hierarchy while it is read."""

    path: Path
    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[Array] = field(default_factory=list)
    channels: list[list[tuple[str, int]]] = field(default_factory=list)
    end_parents: list[int] = field(default_factory=list)
    end_offsets: list[Array] = field(default_factory=list)


def read_hierarchy(path: Path, text: str) -> Hierarchy:
    """The joints; statements are lines, with braces standing for themselves."""
    tree = Hierarchy(path)
    stack: list[int] = []  # open joints; −1 stands for an End Site
    opening: int | None = None  # a joint or End Site named, its brace not yet seen
    end_site = -1
    for number, raw in enumerate(text.split("\n"), start=1):
        for words in _statements(raw):
            keyword = words[0].upper()
            if keyword == "{":
                if opening is None:
                    raise _misplaced(path, "{", number)
                stack.append(opening)
                opening = None
            elif keyword == "}":
                if not stack or opening is not None:
                    raise _misplaced(path, "}", number)
                stack.pop()
            elif keyword in ("ROOT", "JOINT"):
                opening = _add_joint(tree, stack, words, opening, number)
            elif keyword == "END":
                if not stack or stack[-1] == end_site or opening is not None:
                    raise _misplaced(path, "End Site", number)
                tree.end_parents.append(stack[-1])
                tree.end_offsets.append(np.zeros(3))
                opening = end_site
            elif keyword in ("OFFSET", "CHANNELS") and stack and opening is None:
                _set_property(tree, stack[-1], words, number)
            elif keyword != "HIERARCHY":
                raise _misplaced(path, shown(" ".join(words)), number)
    if stack or opening is not None or not tree.names:
        raise fault(
            path,
            "every { of the hierarchy closed by a }",
            f"{len(stack)} open before MOTION" if tree.names else "no joints",
            "The file is damaged; export it again.",
        )
    return tree


def _statements(line: str) -> list[list[str]]:
    """The words of a line, and its braces each for itself."""
    words = line.split()
    if len(words) > 1 and ("{" in line or "}" in line):
        return [part.split() for part in re.split(r"([{}])", line) if part.strip()]
    return [words] if words else []


def _misplaced(path: Path, what: str, line: int) -> Exception:
    return fault(
        path,
        "ROOT, JOINT, End Site, OFFSET, CHANNELS or a brace in its place",
        f"{what} out of place",
        "Check the braces above this line, or export the file again.",
        line,
    )


def _add_joint(
    tree: Hierarchy, stack: list[int], words: list[str], opening: int | None, line: int
) -> int:
    """Open a joint; returns its index."""
    is_root = words[0].upper() == "ROOT"
    if is_root and tree.names:
        raise fault(
            tree.path,
            "one ROOT",
            f"a second one, {shown(' '.join(words[1:]))}",
            "Segue reads one character a file; save each root as a file of its own.",
            line,
        )
    if opening is not None or (not is_root and (not stack or stack[-1] < 0)):
        raise _misplaced(tree.path, words[0], line)
    if len(tree.names) >= MOST_JOINTS:
        raise fault(
            tree.path,
            f"at most {MOST_JOINTS} joints",
            "more",
            "This is no body; export the skeleton of one character.",
            line,
        )
    tree.names.append(" ".join(words[1:]) or f"joint {len(tree.names)}")
    tree.parents.append(-1 if is_root else stack[-1])
    tree.offsets.append(np.zeros(3))
    tree.channels.append([])
    return len(tree.names) - 1


def _set_property(tree: Hierarchy, joint: int, words: list[str], line: int) -> None:
    """OFFSET or CHANNELS of a joint, or the OFFSET of the End Site opened last (joint −1)."""
    if words[0].upper() == "OFFSET":
        numbers = decimals(words[1:])
        if numbers is None or len(numbers) != 3:
            raise fault(
                tree.path,
                f"OFFSET and three numbers {IN_BOUNDS}",
                shown(" ".join(words)),
                "Mend it.",
                line,
            )
        if joint < 0:
            tree.end_offsets[-1] = np.array(numbers)
        else:
            tree.offsets[joint] = np.array(numbers)
        return
    matches = [_CHANNEL.fullmatch(word) for word in words[2:]]
    channels = [(m[2].lower(), AXES.index(m[1].upper())) for m in matches if m]
    sound = len(words) > 1 and words[1] == str(len(channels)) and len(channels) == len(matches)
    if joint < 0 or not sound or len(set(channels)) != len(channels):
        raise fault(
            tree.path,
            "CHANNELS, their count, and that many of Xposition … Zrotation",
            shown(" ".join(words), 80),
            "Make the count fit the names.",
            line,
        )
    tree.channels[joint] = channels
