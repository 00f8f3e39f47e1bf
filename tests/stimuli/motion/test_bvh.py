"""BVH in and out: what is written reads back; whatever is read is a motion or a refusal."""

import itertools
import re
import subprocess
import sys
import tracemalloc
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.errors import InputError
from stimuli.motion import Motion, forward, load_clip, write_walker
from stimuli.motion import quaternions as quat
from stimuli.motion.formats import bvh_table
from stimuli.motion.formats.bvh import read_bvh
from stimuli.motion.formats.bvh_write import write_bvh
from stimuli.motion.formats.numbers import number_blocks, parse_numbers
from stimuli.motion.formats.plain_numbers import plain_blocks
from stimuli.motion.formats.scan_state import (
    LINES,
    ODD_BEGINS,
    ODD_LINE,
    ODD_LINES,
    ODD_WORDS,
    new_state,
)
from stimuli.motion.formats.words import decimal, whole_number
from stimuli.motion.skeleton import depth_first_order
from tests.conftest import SHARED

PATH = Path("clip.bvh")
ROOT = Path(__file__).resolve().parents[3]
HEAD = """HIERARCHY
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
"""
TWO = HEAD + "Frames: 2\nFrame Time: 0.033333\n" + "1 90 2 10 20 30 1 2 3\n" * 2


def read(text: str):
    return read_bvh(PATH, text.encode())


def numbers(text: str) -> np.ndarray:
    return parse_numbers(PATH, text.encode())


def order_of(back: Motion, motion: Motion) -> list[int]:
    """Where a motion's joints are in one read back, whose joints go depth first."""
    return [back.skeleton.names.index(name) for name in motion.skeleton.names]


def largest_angle(motion: Motion, back: Motion) -> float:
    """Degrees between corresponding joint rotations."""
    there = back.rotations[:, order_of(back, motion)]
    return float(np.degrees(2 * quat.geodesic(motion.rotations, there).max()))


def test_a_motion_written_reads_back_to_1e_4_degrees(bodies, tmp_path):
    motion = bodies.wandering(40, 1)
    write_bvh(motion, tmp_path / "out.bvh")
    back = load_clip(tmp_path / "out.bvh", scale=0.01)
    assert back.joints == len(motion.skeleton)
    assert back.fps == 30.0
    assert largest_angle(motion, back.motion) < 1e-4
    assert np.abs(motion.root - back.motion.root).max() < 1e-6
    order = order_of(back.motion, motion)
    assert np.allclose(back.motion.skeleton.offsets[order], motion.skeleton.offsets, atol=1e-8)
    assert len(back.motion.skeleton.end_offsets) == len(motion.skeleton.end_offsets)


@pytest.mark.parametrize("rests", [1, 2, 3, 60])
def test_a_root_at_rest_in_the_first_frames_is_no_rest_pose_of_an_exporter(bodies, tmp_path, rests):
    motion = bodies.wandering(60, 1)
    motion.rotations[:rests, 0] = quat.IDENTITY
    write_bvh(motion, tmp_path / "out.bvh")
    back = load_clip(tmp_path / "out.bvh", scale=0.01)
    assert len(back.motion) == 60
    assert not back.warnings
    assert largest_angle(motion, back.motion) < 1e-5


def test_what_was_read_written_and_read_has_its_source_s_hierarchy(tmp_path, sample_motions):
    paths = [write_walker(tmp_path), sample_motions / "humanoid3d_spin.json"]
    captured = [SHARED / "cmu_asfamc" / "16_41.amc", SHARED / "cmu_bvh" / "05_13.bvh"]
    for path in (*paths, *captured * SHARED.is_dir()):
        skeleton = load_clip(path).motion.skeleton
        write_bvh(load_clip(path).motion, tmp_path / "out.bvh")
        back = load_clip(tmp_path / "out.bvh", scale=0.01, up="Y").motion.skeleton
        assert back.same_hierarchy(skeleton), path
        assert depth_first_order(skeleton.parents) == list(range(len(skeleton)))
        assert np.array_equal(back.end_parents, skeleton.end_parents)
        assert np.allclose(back.end_offsets, skeleton.end_offsets, atol=1e-8)


SAMPLES = ["humanoid3d_cartwheel.json", "humanoid3d_getup_faceup.json", "turn_left0.json"]
CAPTURED = [
    "cmu_bvh/05_13.bvh", "accad_male1_bvh/Male1_A8_CrouchToLie.bvh", "cmu_asfamc/16_41.amc",
    "other_bvh/rokoko_jesse_dance.bvh", "other_bvh/reactidle_003_genuine.bvh",
    "other_bvh/cmu_daz_salsa_13.bvh",
]  # fmt: skip


@pytest.mark.parametrize("name", SAMPLES + CAPTURED * SHARED.is_dir())
def test_captured_motions_written_read_back(sample_motions, tmp_path, name):
    clip = load_clip((sample_motions if name in SAMPLES else SHARED) / name)
    write_bvh(clip.motion, tmp_path / "out.bvh")
    back = load_clip(tmp_path / "out.bvh", scale=0.01, up="Y").motion
    assert largest_angle(clip.motion, back) < 1e-4
    p, _ = forward(clip.motion.skeleton, clip.motion.rotations, clip.motion.root)
    q, _ = forward(back.skeleton, back.rotations, back.root)
    assert np.abs(p - q[:, order_of(back, clip.motion)]).max() < 1e-5


def test_gimbal_lock_is_written_and_read_back(bodies, tmp_path):
    motion = bodies.standing(60)
    rotations = motion.rotations.copy()
    rng = np.random.default_rng(0)
    angles = rng.uniform(-3, 3, (60, len(motion.skeleton), 3))
    angles[..., 1] = np.pi / 2 - rng.choice([0.0, 1e-9, 1e-6, 1e-3], angles.shape[:2])
    rotations[:] = quat.from_euler(angles, "ZYX")
    locked = Motion(motion.skeleton, rotations, motion.root)
    write_bvh(locked, tmp_path / "out.bvh")
    assert largest_angle(locked, load_clip(tmp_path / "out.bvh", scale=0.01).motion) < 1e-4


def test_other_readers_read_what_is_written(bodies, tmp_path):
    pybvh = pytest.importorskip("pybvh")
    motion = bodies.wandering(10, 2)
    write_bvh(motion, tmp_path / "out.bvh")
    theirs = pybvh.read_bvh_file(str(tmp_path / "out.bvh"))
    assert theirs.frame_count == 10


def test_channels_apply_in_their_own_order_and_positions_replace_the_offset():
    source = read(TWO)
    expected = quat.from_euler(np.radians([[10.0, 20.0, 30.0]]), "ZXY")
    assert np.allclose(source.rotations[0, 0], expected)
    assert np.allclose(source.root, [[1, 90, 2]] * 2)
    moved = TWO.replace("CHANNELS 3 Z", "CHANNELS 6 Xposition Yposition Zposition Z")
    moved = moved.replace("1 2 3\n", "5 -41 0 1 2 3\n")
    assert np.allclose(read(moved).offsets[1], [5, -41, 0])
    varied = moved.replace("5 -41 0", "5 -43 0", 1)
    assert np.allclose(read(varied).offsets[1], [5, -42, 0])
    assert np.allclose(read(varied).moves[1], [[5, -43, 0], [5, -41, 0]])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("Frames: 2", "Frames: 1000000000"), "1000000000 frames"),
        (("Frames: 2", "Frames: " + "9" * 400), "frames"),
        (("Frames: 2", "Frames: many"), "Frames:"),
        (("Frames: 2", "Frames: 0"), "at least one frame"),
        (("Frames: 2", "Frames: " + "9" * 5000), "Frames:"),
        (("Frames: 2", "Frames: ²"), "Frames:"),
        (("Frames: 2", "Frames: 1_0"), "Frames:"),
        (("0.033333", "nan"), "Frame Time"),
        (("0.033333", "0.0_3"), "Frame Time"),
        (("0.033333", "٠.٠٣"), "Frame Time"),
        (("0.033333", "900"), "0.0005 to 1 seconds, found 900"),
        (("0.033333", "1e-9"), "0.0005 to 1 seconds"),
        (("0.033333", "-1"), "frame time"),
        (("90", "nan"), "nan"),
        (("90", "1e999"), "1e999"),
        (("90", "0x10"), "0x10"),
        (("90", "ninety"), "clip.bvh:19"),
        (("90", "1e9"), "a number below 1e9, found '1e9'"),
        (("90", "9_0"), "found '9_0'"),
        (("90", "٩٠"), "found '٩٠'"),
        (("CHANNELS 3", "CHANNELS x"), "CHANNELS"),
        (("Xrotation Yrotation\n  J", "Xrotation Xrotation\n  J"), "CHANNELS"),
        (("OFFSET 0 -40 0", "OFFSET 0 -40"), "OFFSET"),
        (("OFFSET 0 -40 0", "OFFSET 0 -4_0 0"), "OFFSET"),
        (("OFFSET 0 -40 0", "OFFSET 0 ١ 0"), "OFFSET"),
        (("OFFSET 0 -40 0", "OFFSET 0 1e9 0"), "below 1e9"),
        (("JOINT Knee\n", ""), "out of place"),
        (("ROOT", "TRUNK"), "out of place"),
    ],
)
def test_faults_are_named(change, told):
    with pytest.raises(InputError) as caught:
        read(TWO.replace(*change, 1))
    assert told in str(caught.value)
    assert len(str(caught.value).splitlines()) <= 2


def test_deep_and_wide_hierarchies_are_refused_quickly():
    deep = "HIERARCHY\nROOT a\n{\n" + "JOINT b\n{\nOFFSET 0 1 0\n" * 100_000 + "MOTION\n"
    with pytest.raises(InputError, match="2000"):
        read(deep)


def test_a_rate_that_is_given_rules_over_the_frame_time():
    text = TWO.replace("0.033333", "900")
    assert read_bvh(PATH, text.encode(), 60.0).fps == 60.0


def test_joints_without_channels_may_not_fill_the_memory():
    joints = "".join(f"JOINT j{k}\n{{\nOFFSET 0 1 0\n}}\n" for k in range(1999))
    head = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 1 Zrotation\n" + joints + "}\nMOTION\n"
    text = head + "Frames: 30000\nFrame Time: 0.01\n" + "1\n" * 30_000
    with pytest.raises(InputError, match="found 30,000 frames of 2000 joints at 100 a second"):
        read(text)


@given(st.text(max_size=12))
def test_a_word_is_a_number_only_in_plain_notation(word):
    number, count = decimal(word), whole_number(word)
    plain = word.isascii() and "_" not in word and word == word.strip()
    try:
        expected = float(word)
    except ValueError:
        expected = np.nan
    assert number == (expected if plain and abs(expected) < 1e9 else None)
    assert count == (int(word) if word.isascii() and word.isdigit() else None)


@settings(max_examples=150)
@given(st.binary(max_size=400))
def test_any_bytes_are_a_refusal(data):
    with pytest.raises(InputError):
        read_bvh(PATH, data)


@settings(max_examples=300)
@given(st.data())
def test_a_damaged_file_is_a_motion_or_a_refusal(data):
    text = TWO
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(start + 12, len(text))))
        text = (
            text[:start]
            + data.draw(st.text("0123456789.-e{} \nZXJOINTxyz", max_size=6))
            + text[end:]
        )
    try:
        source = read(text)
    except InputError:
        return
    assert np.all(np.isfinite(source.rotations))
    assert np.all(np.isfinite(source.root))
    assert np.allclose(np.linalg.norm(source.rotations, axis=-1), 1.0)


decimals = st.floats(-1e7, 1e7, allow_nan=False)


@given(st.lists(decimals, min_size=1, max_size=200), st.integers(0, 9), st.sampled_from(" \n\t"))
def test_even_decimals_are_what_python_reads(values, digits, gap):
    words = [f"{value:.{digits}f}" for value in values]
    found = numbers(gap.join(words))
    assert found.tolist() == [float(word) for word in words]


NOTATIONS = st.one_of(
    st.tuples(decimals, st.integers(0, 9)).map(lambda pair: f"{pair[0]:.{pair[1]}f}"),
    st.tuples(decimals, st.integers(0, 12)).map(lambda pair: f"{pair[0]:.{pair[1]}e}"),
    st.tuples(decimals, st.integers(1, 12)).map(lambda pair: f"{pair[0]:.{pair[1]}G}"),
    st.sampled_from(["0", "-0.0", "+3.50", "-.07", "2.", "1e-300", "4E+02", "000.10"]),
)


@given(st.lists(NOTATIONS, min_size=1, max_size=200))
def test_mixed_notations_are_what_python_reads(words):
    found = numbers("\n".join(words))
    assert found.tolist() == [float(word) for word in words]


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, max_value=1e8, min_value=-1e8),
                min_size=1, max_size=50))  # fmt: skip
def test_any_notation_is_what_python_reads(values):
    found = numbers(" ".join(repr(value) for value in values))
    assert found.tolist() == values


@pytest.mark.parametrize(
    "word",
    ["12345678901234567.25e-9", "7e-200", "1" * 25 + "e-20", "-0.1234567890123456789", "1e-400",
     "-" + "9" * 30 + "e-25", "-0.99999999999999999999", "0." + "0" * 400 + "1e400",
     "9007199254740993e-8", "0.500000000000000166533453693773481063544750213623046875",
     "-0", "-0e7", "0e999999999999"],
)  # fmt: skip
def test_a_number_of_any_length_is_correctly_rounded(word):
    found = numbers(f"1.5 {word}\n{word}")
    assert [value.hex() for value in found.tolist()] == [
        float(w).hex() for w in ("1.5", word, word)
    ]


@given(st.lists(st.integers(1, 2**53 - 1), min_size=1, max_size=50), st.integers(-340, -8),
       st.integers(0, 4))  # fmt: skip
def test_halfway_between_two_doubles_is_rounded_as_python_does(mantissas, power, more):
    words = [f"{2 * mantissa + 1}{'0' * more}e{power}" for mantissa in mantissas]
    words += [f"{Decimal(mantissa + 0.5) * Decimal(2) ** -20:f}" for mantissa in mantissas]
    words = [word for word in words if abs(float(word)) < 1e9]
    assert numbers(" ".join(["1", *words])).tolist() == [1.0, *map(float, words)]


@pytest.mark.parametrize(
    "word",
    ["1.2.3", "1-2", "é", ".", "-", "+", "nan", "inf", "1,5", "1.-5", "1e5.2", "1e", "e5", "1e5e3",
     "1e-", "..5", "0x1.5", "1e5.0", "9E454.", ".-229", "-.+3", "9e5.", "0e3.", "1e401", "0e", "0E",
     "-0e", "0.e", "0e+", "0E-", "00e", ".0e", "0e.", "0ee", "--1", "1_0", "1d5", "1e9", "-1e9"],
)  # fmt: skip
@pytest.mark.parametrize("plain", [0, 300])
def test_what_is_no_number_is_refused_with_its_line(word, plain):
    text = "1.5 " * plain + "\n" + word + " 2"
    with pytest.raises(InputError, match=rf"clip\.bvh:2: .*found '{re.escape(word)}'"):
        numbers(text)


ZXY = "Zrotation Xrotation Yrotation"
STRANGE_WORDS = st.lists(
    st.text("0123456789.+-eE", min_size=1, max_size=24), min_size=1, max_size=4
)
LIKELY_WORDS = st.lists(
    st.from_regex(r"\A[+-]?[0-9]{0,20}\.?[0-9]{0,20}([eE][+-]?[0-9]{0,4}\.?)?\Z").filter(bool),
    min_size=1,
    max_size=4,
)
BARE_LETTERS = st.lists(
    st.from_regex(r"\A[+-]?[0.]{1,3}[eE][+-]?[0.]{0,2}\Z"), min_size=1, max_size=4
)


@settings(max_examples=1000)
@given(st.one_of(STRANGE_WORDS, LIKELY_WORDS, BARE_LETTERS), st.sampled_from([0, 300]))
def test_words_are_numbers_exactly_as_python_reads_them_or_a_refusal(words, plain):
    text = " ".join(words + ["1.5"] * plain)
    if any(decimal(word) is None for word in words):
        with pytest.raises(InputError):
            numbers(text)
    else:
        assert numbers(text)[: len(words)].tolist() == [float(w) for w in words]


@given(st.lists(st.sampled_from(["1", "2 3", "\t4", "", " ", "5 6 7"]), max_size=30),
       st.sampled_from(["\n", "\r", "\r\n", "\r\r\n"]))  # fmt: skip
def test_a_scan_counts_the_words_of_lines_whatever_ends_them(lines, end):
    state = new_state(0)
    data = end.join(lines).encode()
    blocks = [block.tolist() for block in number_blocks(PATH, data, state, 4, usual=2)]
    assert [*itertools.chain(*blocks)] == [float(word) for line in lines for word in line.split()]
    counts = [len(line.split()) for line in lines if line.split()]
    odd = [place for place, count in enumerate(counts) if count != 2]
    assert (state[LINES], state[ODD_LINES]) == (len(counts), len(odd))
    if odd:
        assert (state[ODD_LINE], state[ODD_WORDS]) == (odd[0] + 1, counts[odd[0]])
        before = data[: state[ODD_BEGINS]].decode()
        assert len([line for line in before.splitlines() if line.strip()]) >= odd[0]


ROW = "1 90 2 10 20 30 1 2 3"


@pytest.mark.parametrize("frames", [2, 1])
@pytest.mark.parametrize("end", ["\n", " \r\n", "    \n"])
def test_a_number_in_another_frame_s_line_is_refused(frames, end):
    text = HEAD + f"Frames: {frames}\nFrame Time: 0.033333\n"
    rows = [ROW, ROW]
    source = read(text + end.join(rows) + end)
    assert len(source.root) == frames
    for rows in ([ROW + " 4", ROW[2:]], [ROW[2:], "4 " + ROW]):
        with pytest.raises(InputError, match=r"clip\.bvh:20.*frame 1 has (10|8)"):
            read(text + end + end.join(rows) + end)


def test_frames_may_be_wrapped_over_lines():
    text = HEAD + "Frames: 2\nFrame Time: 0.033333\n"
    for body in (
        ROW + " " + ROW,
        (ROW + " " + ROW).replace(" ", "\n"),
        f"{ROW[:9]}\n{ROW[9:]}\n" * 2,
    ):
        assert np.allclose(read(text + body).root, [[1, 90, 2]] * 2)


ALIKE = st.lists(
    st.lists(NOTATIONS, min_size=3, max_size=3).map(" ".join) | st.just(" \t"), max_size=20
)


@given(ALIKE, st.sampled_from(["\n", "\r\n", "\r", "\r\r\n"]))
def test_numbers_by_python_alone_are_those_of_the_compiled_loop(lines, end):
    data = end.join(lines).encode()
    plain = [value for block in plain_blocks(data, 0, 6, 3) for value in block.tolist()]
    scanned = [
        value for block in number_blocks(PATH, data, new_state(0), 6, 3) for value in block.tolist()
    ]
    assert list(map(repr, plain)) == list(map(repr, scanned))  # the sign of a zero, too


@pytest.mark.parametrize("line", ["1 2", "1 2 3 4", "1 2 x", "1 2 1e9", "1 2 0e", "1 2 # 3", "1 ²"])
def test_what_is_laid_out_otherwise_is_not_for_python_alone(line):
    with pytest.raises(ValueError, match=r"layout|bounds|columns|convert|numbers"):
        list(plain_blocks(f"1 2 3\n{line}\n".encode(), 0, 6, 3))


@pytest.mark.parametrize(
    "channels", ["Zrotation Xrotation Yrotation", "Yrotation", "Xrotation Zrotation"]
)
def test_a_clip_read_by_python_alone_is_that_of_the_compiled_loops(channels, monkeypatch):
    count = len(channels.split())
    text = TWO.replace("CHANNELS 3 Zrotation Xrotation Yrotation", f"CHANNELS {count} {channels}")
    text = text.replace("1 2 3\n", " ".join("123"[:count]) + "\n")
    told = []
    for loaded in (True, False):
        monkeypatch.setattr(bvh_table, "worth_loading", lambda size, loaded=loaded: loaded)
        told.append(read(text))
    assert np.allclose(told[0].rotations, told[1].rotations, rtol=0, atol=1e-15)
    assert np.array_equal(told[0].root, told[1].root)


def test_one_short_clip_is_read_without_loading_the_compiled_loops(tmp_path):
    path = tmp_path / "clip.bvh"
    path.write_text(TWO)
    script = (
        "import sys; from pathlib import Path; from stimuli.motion.formats.bvh import read_bvh\n"
        "path = Path(sys.argv[1]); data = path.read_bytes(); read_bvh(path, data)\n"
        "short = 'numba' in sys.modules\n"
        "read_bvh(path, data + b'1 90 2 10 20 30 1 2 3\\n' * 1_600_000)\n"
        "print(short, 'numba' in sys.modules)"
    )
    command = [sys.executable, "-c", script, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.split() == ["False", "True"]


@pytest.mark.parametrize("loaded", [True, False])
@pytest.mark.parametrize("form", [".0f", ".1f", ".4f", ".17g"])
def test_a_file_takes_no_more_memory_than_itself_and_its_rotations(monkeypatch, form, loaded):
    """Three times the file; or, for whole degrees, whose rotations alone are three times the file,
    these and the file. NumPy by itself has half a megabyte in hand."""
    monkeypatch.setattr(bvh_table, "worth_loading", lambda numbers: loaded)
    frames, joints = 1200, 20
    tree = "".join(f"JOINT j{n}\n{{\nOFFSET 0 1 0\nCHANNELS 3 {ZXY}\n" for n in range(1, joints))
    angles = np.random.default_rng(0).uniform(-180, 180, (frames, 3 * joints + 3))
    rows = "\n".join(" ".join(format(angle, form) for angle in row) for row in angles)
    data = (
        "HIERARCHY\nROOT root\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
        f"{ZXY}\n{tree}{'}' * joints}\nMOTION\nFrames: {frames}\nFrame Time: 0.01\n{rows}\n"
    ).encode()
    read_bvh(Path("a.bvh"), data)
    tracemalloc.start()
    take = read_bvh(Path("a.bvh"), data)
    peak = len(data) + tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    held = len(data) + 1.1 * take.rotations.nbytes if form == ".0f" else 3 * len(data)
    assert peak <= held + (0 if loaded else 500_000)
