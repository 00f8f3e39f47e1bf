"""Layouts and faults that public reports know of, laid over a small file and over every real one.

A layout says the same in another form: it gives the same motion. A fault is refused in words.
"""

import re
from collections.abc import Callable, Mapping
from itertools import cycle
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion.formats.bvh import read_bvh
from stimuli.motion.formats.source import Take, text_of
from tests.conftest import ABSENT, SHARED

TWO = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Knee
  {
    OFFSET 0 -40 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 -40 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.033333
1.0 90.0 2.5 10.0 20.0 30.0 1.0 2.0 3.25
1.0 90.0 2.5 10.0 20.0 30.0 1.0 2.0 3.5
"""
REAL = sorted(
    path for path in SHARED.rglob("*.bvh")
    if path.parent.name != "messy" or path.name.startswith("real_")
)  # fmt: skip
SAMPLE = [path for path in REAL if path.stem in ("Male1_C03_Run", "09_03", "real_walk01_24fps")]


def ends(*marks: str) -> Callable[[str], str]:
    """Line ends replaced by `marks`, in turn."""

    def change(text: str) -> str:
        turn = cycle(marks)
        return re.sub("\n", lambda _: next(turn), text)

    return change


def head(change: Callable[[str], str]) -> Callable[[str], str]:
    """A change of what stands before the frames."""

    def changed(text: str) -> str:
        first, middle, rest = re.split(r"(Frame Time:[^\n]*\n)", text, maxsplit=1)
        return change(first + middle) + rest

    return changed


def body(change: Callable[[str], str]) -> Callable[[str], str]:
    """A change of the frames."""

    def changed(text: str) -> str:
        first, middle, rest = re.split(r"(Frame Time:[^\n]*\n)", text, maxsplit=1)
        return first + middle + change(rest)

    return changed


def sub(pattern: str, by: str, count: int = 0) -> Callable[[str], str]:
    return lambda text: re.sub(pattern, by, text, count=count, flags=re.MULTILINE)


def encoded(encoding: str) -> Callable[[str], bytes]:
    return lambda text: text.encode(encoding)


def without_last_offset(text: str) -> str:
    first, _, rest = text.rpartition("OFFSET")
    return first + rest[rest.index("\n") :]


Change = Callable[[str], str | bytes]
LAYOUTS: Mapping[str, Change] = {
    "carriage returns alone": ends("\r"),
    "carriage return and line feed": ends("\r\n"),
    "two carriage returns and a line feed": ends("\r\r\n"),
    "line ends of several kinds": ends("\n", "\r\n", "\r", "\n\n", "\r\r\n"),
    "all before the frames in one line": head(lambda text: text.replace("\n", " ")),
    "every word of the hierarchy in its line": head(sub(r"(?<=[0-9}{n])[ \t]+(?=\S)", "\n")),
    "OFFSET and CHANNELS in one line": sub(r"\s*\n\s*CHANNELS", " CHANNELS"),
    "MOTION and Frames in one line": sub(r"^MOTION\s*", "MOTION "),
    "Frames and Frame Time in one line": sub(r"\s*\nFrame Time", " Frame Time"),
    "Frame Time before Frames": sub(r"(Frames:.*\n)(Frame Time:.*\n)", r"\2\1"),
    "no colons": head(sub(r"(?<=Frames|e Time):", "")),
    "blanks before colons": head(sub(r"(?<=Frames|e Time):", "\t :")),
    "no blank after colons": head(sub(r"(?<=Frames:|e Time:)\s+", "")),
    "EndSite": sub(r"End Site", "EndSite"),
    "END SITE": sub(r"End Site", "END SITE"),
    "a name of an end site": sub(r"End Site.*", "End Site tip of it"),
    "no channels in an end site": sub(r"(End Site\s*\{\s*OFFSET.*)", r"\1\nCHANNELS 0"),
    "keywords in lower case": head(
        lambda text: re.sub(r"HIERARCHY|MOTION|OFFSET|CHANNELS|ROOT|JOINT",
                            lambda word: word[0].lower(), text)),
    "braces that touch": head(sub(r"\s*\n\s*\{\s*", "{")),
    "comments": lambda text: "# motion of\n// MOTION\n" + head(sub(
        r"^(.*(?:OFFSET|CHANNELS|\}).*)$", r"\1 # that { is all"))(body(sub(
            r"^(.*)$", r"\1 // frame"))(text)),
    "comments that hold a motion part": lambda text: (
        "# MOTION Frames: 3\n" + sub(
            r"^(\s*)(ROOT|MOTION)", r"// MOTION Frames: 3\n\1\2", 2)(text)),
    "a comment of a motion part beside a brace": sub(
        r"\{\s*$", "{ # of MOTION\tFrames: 3 Frame Time: 1", 1),
    "counts of channels with zeros": sub(r"CHANNELS\s+", "CHANNELS 0"),
    "comments between": body(sub(r"^", "# frame\n", 1)),
    "blank lines": body(sub("\n", "\n\n \n")),
    "tabs": body(sub(" +", "\t")),
    "wide blanks": body(sub(" +", "     ")),
    "blanks of other alphabets": body(sub(" +", "\u00a0\u3000")),
    "blanks at line ends": sub("$", "  \t"),
    "no line end at the end": str.rstrip,
    "a mark of DOS at the end": lambda text: text + "\x1a",
    "exponents": body(lambda text: re.sub(
        r"\S+", lambda word: word[0] if "e" in word[0].lower() else word[0] + "e+00", text)),
    "many digits": body(sub(r"(?<=\.)([0-9]+)(?=\s)", r"\g<1>000000000000000000")),
    "a mark of UTF-8": encoded("utf-8-sig"),
    "UTF-16": encoded("utf-16"),
}  # fmt: skip
FAULTS: Mapping[str, Change] = {
    "no OFFSET of the root": sub(r"OFFSET.*\n", "\n", 1),
    "no OFFSET of an end": sub(r"(End Site\s*\{\s*)OFFSET.*\n", r"\1\n", 1),
    "no OFFSET of the last": without_last_offset,
    "two OFFSETs": sub(r"(OFFSET.*\n)", r"\1\1", 1),
    "two OFFSETs of an end": sub(r"(End Site\s*\{\s*)(OFFSET.*\n)", r"\1\2\2", 1),
    "two of CHANNELS": sub(r"(CHANNELS 3.*\n)", r"\1\1", 1),
    "CHANNELS in an end": sub(r"(End Site\s*\{)", r"\1\nCHANNELS 1 Zrotation", 1),
    "an OFFSET of two numbers": sub(r"(OFFSET\s+\S+\s+\S+)\s+\S+", r"\1", 1),
    "an OFFSET of four numbers": sub(r"(OFFSET\s+\S+)", r"\1 0.0", 1),
    "no CHANNELS of a joint": sub(r"CHANNELS 3.*", "", 1),
    "a wrong count of channels": sub(r"CHANNELS 3", "CHANNELS 2", 1),
    "a word of its own": sub(r"OFFSET", "LENGTH 3\nOFFSET", 1),
    "a brace missing": sub(r"\}", "", 1),
    "a brace too many": sub(r"\}", "}}", 1),
    "a second root": sub(r"^(\s*)MOTION", r"ROOT Other\n{\nOFFSET 0 0 0\n}\n\1MOTION", 1),
    "numbers that touch": body(sub(r"(?<=[0-9])\s+(?=\S)", "-", 1)),
    "decimal commas": body(sub(r"\.", ",")),
    "semicolons": body(sub(r"(?<=\S) +(?=\S)", ";")),
    "no number": body(sub(r"\S+", "nan", 1)),
    "a number that its program could not print": body(sub(r"\S+", "-1.#IND", 1)),
    "a bare exponent": body(sub(r"\S+", "0e", 1)),
    "words at the end": lambda text: text.rstrip() + "\nEND\n",
    "a number too few": lambda text: re.sub(r"\S+\s*$", "", text),
    "a number in the next line": body(sub(r"[ \t]+(\S+)\s*?\n", r"\n\1 ", 1)),
    "frames that are no whole number": sub(r"(Frames:\s*\d+)", r"\1.0"),
    "no Frames": sub(r"Frames:.*\n", ""),
    "no Frame Time": sub(r"Frame Time:.*\n", ""),
    "a Frame Time in milliseconds": sub(r"Frame Time:.*", "Frame Time: 33.3333"),
    "a Frame Time with a comma": sub(r"(Frame Time:.*)\.", r"\1,"),
    "no MOTION": sub(r"^\s*MOTION", "", 1),
    "a skeleton alone": lambda text: text.split("MOTION")[0],
    "UTF-16 without its mark": encoded("utf-16-le"),
    "a web page": lambda text: "<!DOCTYPE html>\n<html></html>",
}  # fmt: skip


def read(text: str | bytes) -> Take:
    return read_bvh(Path("clip.bvh"), text.encode() if isinstance(text, str) else text)


def assert_alike(found: Take, wanted: Take) -> None:
    assert found.parents.tolist() == wanted.parents.tolist()
    assert found.end_parents.tolist() == wanted.end_parents.tolist()
    assert found.fps == wanted.fps
    for part in ("offsets", "end_offsets", "rotations", "root"):
        ours, theirs = getattr(found, part), getattr(wanted, part)
        assert ours.shape == theirs.shape
        assert np.allclose(ours, theirs, rtol=0, atol=1e-9), part
    assert found.moves.keys() == wanted.moves.keys()


def assert_refused(text: str | bytes) -> str:
    with pytest.raises(InputError) as caught:
        read(text)
    message = str(caught.value)
    assert message.startswith("clip.bvh")
    assert len(message.splitlines()) <= 2
    assert len(message) < 1_000
    return message


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_same_in_another_layout_is_the_same_motion(layout):
    changed = LAYOUTS[layout](TWO)
    assert changed not in (TWO, TWO.encode())
    assert_alike(read(changed), read(TWO))


@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_missing_twice_or_malformed_is_refused(fault):
    changed = FAULTS[fault](TWO)
    assert changed not in (TWO, TWO.encode())
    assert_refused(changed)


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ("no OFFSET of the root", "clip.bvh:15: expected an OFFSET of joint 'Hips', found none"),
        ("no OFFSET of an end", "clip.bvh:13: expected an OFFSET of the End Site of 'Knee'"),
        ("two OFFSETs", "clip.bvh:5: expected one OFFSET of joint 'Hips', found a second"),
        ("two of CHANNELS", "clip.bvh:10: expected CHANNELS of joint 'Knee' once, found twice"),
        ("an OFFSET of four numbers", "clip.bvh:4: expected OFFSET and three numbers"),
        ("a wrong count of channels", "clip.bvh:9: "),
        ("a bare exponent", "clip.bvh:19: expected a number, found '0e'"),
        (
            "a number that its program could not print",
            "clip.bvh:19: expected a number, found '-1.#IND'",
        ),
        ("a number in the next line", "clip.bvh:19: expected 2 frames of 9 numbers"),
        ("words at the end", "clip.bvh:21: expected a number, found 'END'"),
    ],
)
def test_a_refusal_names_line_and_joint(fault, told):
    assert told in assert_refused(FAULTS[fault](TWO))
    for line_ends in ("\r", "\r\n", "\r\r\n"):
        assert told in assert_refused(ends(line_ends)(str(FAULTS[fault](TWO))))


def mutate_real(path: Path | None) -> None:
    """Every layout and fault over a captured file."""
    if path is None:
        pytest.skip(ABSENT)
    text = text_of(path, path.read_bytes())
    wanted = read(text)
    for name, change in LAYOUTS.items():
        try:
            assert_alike(read(change(text)), wanted)
        except (AssertionError, InputError) as error:
            raise AssertionError(f"{path.name}: {name}") from error
    for name, change in FAULTS.items():
        changed = change(text)
        wraps = name == "a number in the next line" and len(wanted.root) == 1
        if changed != text and not wraps:
            try:
                assert_refused(changed)
            except BaseException as error:
                raise AssertionError(f"{path.name}: {name}") from error


@pytest.mark.parametrize("path", SAMPLE or [None], ids=lambda path: path and path.stem)
def test_layouts_and_faults_of_some_captured_files(path):
    mutate_real(path)


@pytest.mark.slow
@pytest.mark.parametrize("path", REAL or [None], ids=lambda path: path and path.stem)
def test_layouts_and_faults_of_every_captured_file(path):
    mutate_real(path)
