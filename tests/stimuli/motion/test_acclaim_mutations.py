"""Layouts and faults of Acclaim, laid over a small pair of files and over every real one."""

import re
from collections.abc import Callable, Mapping
from itertools import cycle
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.motion import forward, load_clip
from stimuli.motion.formats.source import text_of
from tests.conftest import ABSENT, SHARED

REAL = sorted((SHARED / "cmu_asfamc").glob("*.amc"))
ASF = """# made by hand
:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -1 0
     length 2.0
     axis 0 0 30 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 2
     name shin
     direction 0 -1 0
     length 3.0
     axis 0 0 0 XYZ
    dof rx
  end
:hierarchy
  begin
    root thigh
    thigh shin
  end
"""
AMC = """#!OML:ASF
:FULLY-SPECIFIED
:DEGREES
1
root 1.5 5 2 0 90 0
thigh 10 20 30
shin 45.25
2
root 1.5 5.5 2 0 95 0
thigh 10 25 30
shin 45
"""
Change = Callable[[str], str]


def sub(pattern: str, by: str, count: int = 0) -> Change:
    flags = re.MULTILINE | re.IGNORECASE
    return lambda text: re.sub(pattern, by, text, count=count, flags=flags)


def ends(*marks: str) -> Change:
    def change(text: str) -> str:
        turn = cycle(marks)
        return re.sub("\n", lambda _: next(turn), text)

    return change


def same(text: str) -> str:
    return text


def upper_keywords(text: str) -> str:
    """Keywords in upper case; names as they are."""
    words = ("units|root|bonedata|hierarchy|documentation|begin|end|id|name|direction|length|axis|"
             "dof|limits|order|position|orientation|angle|mass|version|deg|rad")  # fmt: skip
    return re.sub(rf"^(\s*:?(?:{words})\b)", lambda found: found[0].upper(), text, flags=re.M)


LAYOUTS: Mapping[str, tuple[Change, Change]] = {
    "carriage returns alone": (ends("\r"), ends("\r")),
    "carriage return and line feed": (ends("\r\n"), ends("\r\n")),
    "two carriage returns and a line feed": (ends("\r\r\n"), ends("\r\r\n")),
    "line ends of several kinds": (ends("\n", "\r"), ends("\r\n", "\n", "\r")),
    "keywords in upper case": (upper_keywords, same),
    "all in upper case": (str.upper, str.upper),
    "the skeleton in upper case": (str.upper, same),
    "the poses in upper case": (same, str.upper),
    "keywords in lower case": (str.lower, sub(r"^:\w+", lambda word: word[0].lower())),
    "tabs and blanks": (sub(r" +", "\t"), sub(r" +", "\t  ")),
    "blanks at line ends": (sub(r"$", " \t"), sub(r"$", "  ")),
    "blank lines": (sub(r"\n", "\n\n"), sub(r"\n", "\n\n")),
    "comments": (sub(r"$", " # so"), sub(r"$", " # so")),
    "exponents": (same, sub(r"(\s-?[0-9.]+)(?=\s)(?<=\S\s\S\S\S)", r"\1e0")),
    "no line end at the end": (str.rstrip, str.rstrip),
}  # fmt: skip
FAULTS: Mapping[str, tuple[Change, Change]] = {
    "no length": (sub(r"^\s*length.*\n(?=\s*axis)", "", 1), same),
    "no direction": (sub(r"^\s*direction.*\n", "", 1), same),
    "no axis of a bone": (sub(r"^(\s*length.*\n)\s*axis.*\n", r"\1", 1), same),
    "no name": (sub(r"^\s*name.*\n(?=\s*direction)", "", 1), same),
    "two lengths": (sub(r"^(\s*length.*\n)(?=\s*axis)", r"\1\1", 1), same),
    "two directions": (sub(r"^(\s*direction.*\n)", r"\1\1", 1), same),
    "two names": (sub(r"^(\s*name.*\n)(?=\s*direction)", r"\1\1", 1), same),
    "two dofs": (sub(r"^(\s*dof.*\n)", r"\1\1", 1), same),
    "two orders": (sub(r"^(\s*order.*\n)", r"\1\1", 1), same),
    "a length that is no number": (sub(r"(^\s*length)\s+\S+(?=.*\n\s*axis)", r"\1 nan", 1), same),
    "a direction of two numbers": (sub(r"(^\s*direction\s+\S+\s+\S+)\s+\S+", r"\1", 1), same),
    "a direction of 0": (sub(r"(^\s*direction).*", r"\1 0 0 0", 1), same),
    "an axis order of two": (sub(r"XYZ\s*$", "XYX", 1), same),
    "an unknown freedom": (sub(r"(^\s*dof)\s+rx", r"\1 qx", 1), same),
    "a freedom twice": (sub(r"(^\s*dof)\s+rx", r"\1 rx rx", 1), same),
    "no root": (sub(r"^:root", ":rump", 1), same),
    "no bones": (sub(r"^:bonedata", ":bones", 1), same),
    "no hierarchy": (sub(r"^:hierarchy", ":tree", 1), same),
    "a bone loose": (sub(r"(^\s*root)(\s+\S+)", r"\1", 1), same),
    "a bone with two parents": (sub(r"(^\s*root)(\s+\S+)", r"\1\2\2", 1), same),
    "an end missing": (sub(r"^\s*end\s*\n", "", 1), same),
    "a skeleton that is none": (lambda text: "nothing", same),
    "an empty skeleton": (lambda text: " \n", same),
    "no number": (same, sub(r"(^root\s+)\S+", r"\1nan", 1)),
    "a number that its program could not print": (same, sub(r"(^root\s+)\S+", r"\1-1.#IND", 1)),
    "a length that its program could not print": (
        sub(r"(^\s*length)\s+\S+(?=.*\n\s*axis)", r"\1 1.#INF", 1),
        same,
    ),
    "a bare exponent": (same, sub(r"(^root\s+)\S+", r"\g<1>0e", 1)),
    "an infinite number": (same, sub(r"(^root\s+)\S+", r"\1inf", 1)),
    "a number too many": (same, sub(r"(^root\s+)", r"\1 1.0 ", 1)),
    "a number too few": (same, sub(r"(^root\s+)\S+", r"\1", 1)),
    "decimal commas": (same, sub(r"\.", ",")),
    "a bone missing in a frame": (same, sub(r"^root.*\n", "", 1)),
    "a bone twice in a frame": (same, sub(r"^(root.*\n)", r"\1\1", 1)),
    "an unknown bone": (same, sub(r"^root", "stump", 1)),
    "frames that skip": (same, sub(r"^2\s*$", "3", 1)),
    "no frame number": (same, sub(r"^1\s*$", "", 1)),
    "no frames": (same, lambda text: text.split("\n1\n")[0] + "\n"),
    "an empty file": (same, lambda text: " \n"),
}


@pytest.fixture
def pair(tmp_path) -> Callable:
    """Writes a skeleton and its poses; returns the poses' path."""

    def write(asf: str, amc: str) -> Path:
        (tmp_path / "07.asf").write_bytes(asf.encode())
        (tmp_path / "07_01.amc").write_bytes(amc.encode())
        return tmp_path / "07_01.amc"

    return write


def places(path: Path) -> np.ndarray:
    motion = load_clip(path, scale=1.0, up="Y").motion
    return forward(motion.skeleton, motion.rotations, motion.root)[0]


def assert_refused(path: Path) -> None:
    with pytest.raises(InputError) as caught:
        load_clip(path)
    assert len(str(caught.value).splitlines()) <= 2
    assert len(str(caught.value)) < 1_000


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_same_in_another_layout_is_the_same_motion(pair, layout):
    asf, amc = (change(text) for change, text in zip(LAYOUTS[layout], (ASF, AMC), strict=True))
    assert (asf, amc) != (ASF, AMC)
    wanted = places(pair(ASF, AMC))
    assert np.allclose(places(pair(asf, amc)), wanted, rtol=0, atol=1e-12)


@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_missing_twice_or_malformed_is_refused(pair, fault):
    asf, amc = (change(text) for change, text in zip(FAULTS[fault], (ASF, AMC), strict=True))
    assert (asf, amc) != (ASF, AMC)
    assert_refused(pair(asf, amc))


@pytest.mark.parametrize(
    "keyword", ["name", "direction", "length", "axis", "order", "id", "limits"]
)
@pytest.mark.parametrize(
    "by", ["", "#", "nan", "0e", "-", "x y z", "9" * 400, "1 2 3 4 5", ":root"]
)
def test_no_line_of_a_skeleton_ends_in_a_traceback(pair, keyword, by):
    for line, instead in ((rf"(^\s*{keyword}\b).*", rf"\g<1> {by}"), (rf"^\s*{keyword}\b.*", by)):
        path = pair(sub(line, instead)(ASF), AMC)
        try:
            motion = load_clip(path).motion
        except InputError:
            assert_refused(path)
        else:
            assert np.all(np.isfinite(motion.skeleton.offsets))
            assert np.all(np.isfinite(motion.rotations))


def mutate_real(path: Path | None, pair: Callable) -> None:
    if path is None:
        pytest.skip(ABSENT)
    asf = text_of(path, next(path.parent.glob(f"{path.stem.split('_')[0]}.asf")).read_bytes())
    amc = "\n".join(text_of(path, path.read_bytes()).split("\n")[:900])
    amc = amc[: re.search(r"(?s).*(?=\n\d+\s*\n)", amc).end()] + "\n"
    wanted = places(pair(asf, amc))
    for name, (first, second) in LAYOUTS.items():
        found = places(pair(first(asf), second(amc)))
        assert np.allclose(found, wanted, rtol=0, atol=1e-9), name
    for name, (first, second) in FAULTS.items():
        try:
            assert_refused(pair(first(asf), second(amc)))
        except BaseException as error:
            raise AssertionError(f"{path.name}: {name}") from error


@pytest.mark.parametrize("path", REAL[:1] or [None], ids=lambda path: path and path.stem)
def test_layouts_and_faults_of_one_captured_file(path, pair):
    mutate_real(path, pair)


@pytest.mark.slow
@pytest.mark.parametrize("path", REAL or [None], ids=lambda path: path and path.stem)
def test_layouts_and_faults_of_every_captured_file(path, pair):
    mutate_real(path, pair)
