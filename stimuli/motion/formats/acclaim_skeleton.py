"""Reading an Acclaim skeleton (ASF): bones, their axes and freedoms, who hangs on whom."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from stimuli.motion import quaternions as quat
from stimuli.motion.formats.source import MOST_JOINTS, fault, shown
from stimuli.motion.formats.words import IN_BOUNDS, decimals, without_comment
from stimuli.motion.quaternions import Array

REMEDY = "The file is damaged; take it from its source again."
_ONCE = {"name", "direction", "length", "axis", "dof", "order", "position", "orientation"}
_Entries = dict[str, tuple[int, list[str]]]  # by keyword: line and words
_FREEDOMS = {"rx", "ry", "rz", "tx", "ty", "tz", "l"}


@dataclass(frozen=True, eq=False)
class Bone:
    """A bone: its vector (3,) in rest, its axis as a quaternion, and what an AMC gives of it."""

    name: str
    vector: Array
    axis: Array
    order: str
    freedoms: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class AcclaimSkeleton:
    """Bones with parents first, the root (a bone of no length) before all."""

    bones: tuple[Bone, ...]
    parents: tuple[int, ...]
    position: Array
    degrees: bool

    @property
    def offsets(self) -> Array:
        """(J, 3) from a bone's upper end to the upper end of the bone it hangs on."""
        return np.array([np.zeros(3) if p < 0 else self.bones[p].vector for p in self.parents])

    def bone(self, word: str) -> Bone | None:
        """The bone that a word means: of that name, or of that name in other letters."""
        for same in (str, str.lower):
            for bone in self.bones:
                if same(bone.name) == same(word):
                    return bone
        return None

    @property
    def leaves(self) -> list[int]:
        """Bones on which no other hangs."""
        return [b for b in range(1, len(self.bones)) if b not in self.parents]


@dataclass
class _Lines:
    """The file while it is read: sections of (line number, words)."""

    path: Path
    sections: dict[str, list[tuple[int, list[str]]]] = field(default_factory=dict)


def read_asf(path: Path, text: str) -> AcclaimSkeleton:
    """The skeleton of an ASF file; InputError when malformed."""
    lines = _sections(path, text)
    for needed in ("root", "bonedata", "hierarchy"):
        if needed not in lines.sections:
            raise fault(path, f"a section :{needed}", "none", REMEDY)
    units = {words[0].lower(): words[1:] for _, words in lines.sections.get("units", [])}
    degrees = not (units.get("angle") or ["deg"])[0].lower().startswith("rad")
    unit = np.pi / 180 if degrees else 1.0
    root, position = _root(lines, unit)
    bones = {"root": root}
    for start, entries in _blocks(lines):
        bone = _bone(path, entries, start, unit)
        if bone.name in bones:
            raise fault(path, "each bone once", f"{shown(bone.name)} twice", REMEDY, start)
        bones[bone.name] = bone
        if len(bones) > MOST_JOINTS:
            raise fault(path, f"at most {MOST_JOINTS} bones", "more", REMEDY, start)
    order, parents = _ordered(lines, bones)
    return AcclaimSkeleton(tuple(bones[name] for name in order), tuple(parents), position, degrees)


def _sections(path: Path, text: str) -> _Lines:
    """Lines by section; comments and blank ones left out."""
    lines, name = _Lines(path), ""
    for number, raw in enumerate(text.split("\n"), start=1):
        words = without_comment(raw).split()
        if words and words[0].startswith(":"):
            name = words[0][1:].lower()
            lines.sections.setdefault(name, [])
        elif words and name != "documentation":
            lines.sections.setdefault(name, []).append((number, words))
    return lines


def _numbers(path: Path, words: list[str], count: int, line: int) -> Array:
    numbers = decimals(words[:count])
    if numbers is None or len(numbers) != count:
        raise fault(path, f"{count} numbers {IN_BOUNDS}", shown(" ".join(words)), REMEDY, line)
    return np.array(numbers)


def _root(lines: _Lines, unit: float) -> tuple[Bone, Array]:
    """The root as a bone of no length, and its position in rest."""
    entries: _Entries = {}
    for number, words in lines.sections["root"]:
        _enter(lines.path, entries, number, words)
    freedoms = tuple(word.lower() for word in entries.get("order", (0, []))[1])
    if not _are_freedoms(freedoms) or not freedoms:
        line = entries.get("order", (None, []))[0]
        raise fault(lines.path, "an order such as TX TY TZ RX RY RZ", "another", REMEDY, line)
    order = _order(lines.path, *entries.get("axis", (0, ["XYZ"])))
    number, words = entries.get("orientation", (0, ["0", "0", "0"]))
    angles = _numbers(lines.path, words, 3, number) * unit
    number, words = entries.get("position", (0, ["0", "0", "0"]))
    position = _numbers(lines.path, words, 3, number)
    return Bone("root", np.zeros(3), _axis(angles, order), order, freedoms), position


def _order(path: Path, line: int, words: list[str]) -> str:
    order = (words or [""])[-1].upper()
    if sorted(order) != ["X", "Y", "Z"]:
        raise fault(path, "an axis order such as XYZ", shown(" ".join(words)), REMEDY, line)
    return order


def _axis(angles: Array, order: str) -> Array:
    """Rotation by angles about the fixed axes in the order named."""
    return quat.from_euler(angles[::-1], order[::-1])


def _enter(path: Path, entries: _Entries, line: int, words: list[str]) -> None:
    """Adds a line to the entries of a bone; InputError when what it says has been said."""
    keyword = words[0].lower()
    if keyword in _ONCE and keyword in entries:
        raise fault(path, f"one {keyword} of a bone", "a second", "Keep the right one.", line)
    entries.setdefault(keyword, (line, words[1:]))


def _are_freedoms(words: tuple[str, ...]) -> bool:
    return set(words) <= _FREEDOMS and len(set(words)) == len(words)


def _blocks(lines: _Lines) -> list[tuple[int, _Entries]]:
    """The bones' entries between begin and end, with the line of each begin."""
    blocks: list[tuple[int, _Entries]] = []
    inside = False
    for number, words in lines.sections["bonedata"]:
        keyword = words[0].lower()
        if keyword in ("begin", "end"):
            if inside == (keyword == "begin"):
                raise fault(lines.path, "begin and end in turn", shown(keyword), REMEDY, number)
            inside = keyword == "begin"
            if inside:
                blocks.append((number, {}))
        elif inside:
            _enter(lines.path, blocks[-1][1], number, words)
        else:
            raise fault(lines.path, "begin", shown(" ".join(words)), REMEDY, number)
    return blocks


def _bone(path: Path, entries: _Entries, start: int, unit: float) -> Bone:
    for needed in ("name", "direction", "length", "axis"):
        if needed not in entries or not entries[needed][1]:
            raise fault(path, f"a bone with a {needed}", "none", REMEDY, start)
    direction = _numbers(path, entries["direction"][1], 3, entries["direction"][0])
    norm = float(np.linalg.norm(direction))
    length = float(_numbers(path, entries["length"][1], 1, entries["length"][0])[0])
    if length and not norm:
        line, todo = entries["direction"][0], "Mend it."
        raise fault(path, "a direction of a bone that has a length", "0 0 0", todo, line)
    line, words = entries["axis"]
    order = _order(path, line, words)
    freedoms = tuple(word.lower() for word in entries.get("dof", (0, []))[1])
    if not _are_freedoms(freedoms):
        raise fault(
            path,
            "freedoms rx ry rz, each once",
            shown(" ".join(freedoms)),
            REMEDY,
            entries["dof"][0],
        )
    return Bone(
        name=entries["name"][1][0],
        vector=direction / norm * length if norm else np.zeros(3),
        axis=_axis(_numbers(path, words, 3, line) * unit, order),
        order=order,
        freedoms=freedoms,
    )


def _ordered(lines: _Lines, bones: dict[str, Bone]) -> tuple[list[str], list[int]]:
    """Names with parents first, in the order of the hierarchy, and the parents' places."""
    spelled = {name.lower(): name for name in bones} | {name: name for name in bones}
    children: dict[str, list[str]] = {}
    parent_of: dict[str, str] = {}
    for number, words in lines.sections["hierarchy"]:
        if words[0].lower() in ("begin", "end"):
            continue
        names = [spelled.get(word, spelled.get(word.lower(), "")) for word in words]
        if "" in names:
            word = words[names.index("")]
            raise fault(lines.path, "a bone of :bonedata", shown(word), REMEDY, number)
        for name in names[1:]:
            if name in parent_of or name == "root":
                raise fault(lines.path, f"one parent for {name}", "two", REMEDY, number)
            parent_of[name] = names[0]
        children.setdefault(names[0], []).extend(names[1:])
    order, parents, waiting = [], [], [("root", -1)]
    while waiting:
        name, parent = waiting.pop()
        order.append(name)
        parents.append(parent)
        waiting += [(child, len(order) - 1) for child in reversed(children.get(name, []))]
    if loose := sorted(set(bones) - set(order)):
        raise fault(lines.path, "every bone below root", f"{', '.join(loose)} loose", REMEDY)
    return order, parents
