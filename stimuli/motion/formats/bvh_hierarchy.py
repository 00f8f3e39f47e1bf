"""Reading the hierarchy of a BVH, word by word: line ends mean nothing, but faults know their line.

A name may hold blanks: it goes on to the brace, or to the end of its line.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from stimuli.motion.formats.source import LINE_END, MOST_JOINTS, fault, shown
from stimuli.motion.formats.words import IN_BOUNDS, decimals, whole_number
from stimuli.motion.quaternions import Array

AXES = "XYZ"
_CHANNEL = re.compile(r"([XYZ])(position|rotation)", re.IGNORECASE)
_LINES = re.compile(LINE_END)
_WORD = re.compile(r"[{}]|[^\s{}]+")
_END_SITES = {"ENDSITE", "END_SITE", "END-SITE"}
_KEYWORDS = {"{", "}", "ROOT", "JOINT", "END", "OFFSET", "CHANNELS", "HIERARCHY", *_END_SITES}
_MEND = "Check the braces above this line, or export the file again."


@dataclass
class Hierarchy:
    """A hierarchy while it is read."""

    path: Path
    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[Array | None] = field(default_factory=list)
    channels: list[list[tuple[str, int]] | None] = field(default_factory=list)
    end_parents: list[int] = field(default_factory=list)
    end_offsets: list[Array | None] = field(default_factory=list)


@dataclass
class _Words:
    """Words with their lines, and the one that is next."""

    words: list[str]
    lines: list[int]
    at: int = 0

    @property
    def next(self) -> str:
        """The word that is next, or nothing at the end."""
        return self.words[self.at] if self.at < len(self.words) else ""

    @property
    def line(self) -> int:
        """The line of the word that is next, or of the last."""
        return self.lines[min(self.at, len(self.lines) - 1)] if self.lines else 1

    def name(self) -> str:
        """Words up to the next brace, as far as they stand in one line."""
        first = self.at
        while self.next not in ("", "{", "}") and self.line == self.lines[first]:
            self.at += 1
        return " ".join(self.words[first : self.at])

    def values(self) -> list[str]:
        """Words up to the next keyword or brace."""
        first = self.at
        while self.next and self.next.upper() not in _KEYWORDS:
            self.at += 1
        return self.words[first : self.at]


def read_hierarchy(path: Path, text: str) -> Hierarchy:
    """The joints of the text before MOTION."""
    tree, words = Hierarchy(path), _split(text)
    stack: list[int] = []  # open joints; −1 stands for an End Site
    while word := words.next.upper():
        line = words.line
        words.at += 1
        if word in ("ROOT", "JOINT"):
            stack.append(_add_joint(tree, stack, word, words, line))
        elif word == "END" or word in _END_SITES:
            stack.append(_add_end_site(tree, stack, words, line))
        elif word == "}" and stack:
            _close(tree, stack.pop(), line)
        elif word == "OFFSET" and stack:
            _set_offset(tree, stack[-1], words, line)
        elif word == "CHANNELS" and stack:
            _set_channels(tree, stack[-1], words, line)
        elif word != "HIERARCHY":
            raise _misplaced(path, words.words[words.at - 1], line)
    if stack or not tree.names:
        raise fault(
            path,
            "every { of the hierarchy closed by a }",
            f"{len(stack)} open before MOTION" if tree.names else "no joints",
            "The file is damaged; export it again.",
        )
    return tree


def _split(text: str) -> _Words:
    """The words of a text but for comments; what follows JOINT is a name, however it begins."""
    words: list[str] = []
    lines: list[int] = []
    for number, line in enumerate(_LINES.split(text), start=1):
        for word in _WORD.findall(line):
            named = words and words[-1].upper() in ("ROOT", "JOINT")
            if word.startswith(("#", "//")) and not named:
                break
            words.append(word)
            lines.append(number)
    return _Words(words, lines)


def _misplaced(path: Path, word: str, line: int) -> Exception:
    return fault(
        path,
        "ROOT, JOINT, End Site, OFFSET, CHANNELS or a brace in its place",
        f"{shown(word) if word else 'the end'} out of place",
        _MEND,
        line,
    )


def _add_joint(tree: Hierarchy, stack: list[int], keyword: str, words: _Words, line: int) -> int:
    """Open a joint; returns its index."""
    name = words.name()
    if keyword == "ROOT" and tree.names:
        raise fault(
            tree.path,
            "one ROOT",
            f"a second one, {shown(name)}",
            "Segue reads one character a file; save each root as a file of its own.",
            line,
        )
    if keyword == "JOINT" and (not stack or stack[-1] < 0):
        raise _misplaced(tree.path, f"{keyword} {name}", line)
    if len(tree.names) >= MOST_JOINTS:
        raise fault(
            tree.path,
            f"at most {MOST_JOINTS} joints",
            "more",
            "This is no body; export the skeleton of one character.",
            line,
        )
    _open(tree, words, keyword, name)
    tree.names.append(name or f"joint {len(tree.names)}")
    tree.parents.append(stack[-1] if stack else -1)
    tree.offsets.append(None)
    tree.channels.append(None)
    return len(tree.names) - 1


def _add_end_site(tree: Hierarchy, stack: list[int], words: _Words, line: int) -> int:
    """Open an End Site, which may have a name."""
    words.name()
    if not stack or stack[-1] < 0:
        raise _misplaced(tree.path, "End Site", line)
    _open(tree, words, "End", "Site")
    tree.end_parents.append(stack[-1])
    tree.end_offsets.append(None)
    return -1


def _open(tree: Hierarchy, words: _Words, keyword: str, name: str) -> None:
    if words.next != "{":
        found = shown(words.next) if words.next else "the end"
        wanted = f"{{ after {shown(f'{keyword} {name}')}"
        raise fault(tree.path, wanted, found, _MEND, words.line)
    words.at += 1


def _whose(tree: Hierarchy, joint: int) -> str:
    """A joint as messages call it; −1 is the End Site opened last."""
    if joint >= 0:
        return f"joint {shown(tree.names[joint])}"
    return f"the End Site of {shown(tree.names[tree.end_parents[-1]])}"


def _close(tree: Hierarchy, joint: int, line: int) -> None:
    """InputError when a joint or End Site ends that has no OFFSET."""
    offset = tree.offsets[joint] if joint >= 0 else tree.end_offsets[-1]
    if offset is None:
        todo = "Write it, 0 0 0 where it has no length, or export the file again."
        raise fault(tree.path, f"an OFFSET of {_whose(tree, joint)}", "none", todo, line)


def _set_offset(tree: Hierarchy, joint: int, words: _Words, line: int) -> None:
    values = words.values()
    numbers = decimals(values)
    if numbers is None or len(numbers) != 3:
        wanted = f"OFFSET and three numbers {IN_BOUNDS} for {_whose(tree, joint)}"
        raise fault(tree.path, wanted, shown(" ".join(["OFFSET", *values])), "Mend it.", line)
    place, offsets = (joint, tree.offsets) if joint >= 0 else (-1, tree.end_offsets)
    if offsets[place] is not None:
        wanted = f"one OFFSET of {_whose(tree, joint)}"
        raise fault(tree.path, wanted, "a second", "Keep the right one.", line)
    offsets[place] = np.array(numbers)


def _set_channels(tree: Hierarchy, joint: int, words: _Words, line: int) -> None:
    values = words.values()
    matches = [_CHANNEL.fullmatch(word) for word in values[1:]]
    channels = [(m[2].lower(), AXES.index(m[1].upper())) for m in matches if m]
    counted = bool(values) and whole_number(values[0]) == len(channels)
    sound = counted and len(channels) == len(matches)
    if not sound or len(set(channels)) != len(channels) or (joint < 0 and channels):
        allowed = "that many of Xposition … Zrotation" if joint >= 0 else "none for an End Site"
        raise fault(
            tree.path,
            f"CHANNELS, their count, and {allowed}",
            shown(" ".join(["CHANNELS", *values]), 80),
            "Make the count fit the names.",
            line,
        )
    if joint < 0:
        return
    if tree.channels[joint] is not None:
        wanted = f"CHANNELS of {_whose(tree, joint)} once"
        raise fault(tree.path, wanted, "twice", "Keep the right ones.", line)
    tree.channels[joint] = channels
