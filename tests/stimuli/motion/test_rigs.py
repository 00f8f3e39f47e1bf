"""Rigs of any maker brought to one walker: roots above hips, other axes, names that say nothing."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stimuli.errors import InputError
from stimuli.motion import forward, load_clip
from stimuli.motion import quaternions as quat
from stimuli.motion.library import clips_under
from stimuli.motion.listing import roles_as_overrides
from stimuli.motion.roles import LIMBS, ROLES
from stimuli.motion.shape import shape_roles
from tests.conftest import of_captured

LISTED = (
    "Hips Spine Chest Neck Head LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm "
    "RightForeArm RightHand LeftUpLeg LeftLeg LeftFoot LeftToe RightUpLeg RightLeg RightFoot "
    "RightToe"
)
NAMES = LISTED.split()
PARENTS = [-1, 0, 1, 2, 3, 2, 5, 6, 7, 2, 9, 10, 11, 0, 13, 14, 15, 0, 17, 18, 19]
OFFSETS = np.array(
    [(0, 0, 0), (0, 12, 0), (0, 25, 0), (0, 22, 0), (0, 10, 1),
     (5, 18, 0), (13, 0, 0), (27, 0, 0), (25, 0, 0), (-5, 18, 0), (-13, 0, 0), (-27, 0, 0),
     (-25, 0, 0), (9, 0, 0), (0, -42, 0), (0, -41, 0), (0, -5, 14), (-9, 0, 0), (0, -42, 0),
     (0, -41, 0), (0, -5, 14)], dtype=float)  # fmt: skip
ENDS = {4: (0, 14, 0), 8: (8, 0, 0), 12: (-8, 0, 0), 16: (0, 0, 6), 20: (0, 0, 6)}
FRAMES = 8


@dataclass(frozen=True)
class Rig:
    """A body in centimetres as a file might have it: `moving` joints have position channels."""

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: np.ndarray
    ends: dict[int, tuple[float, float, float]]
    rotations: Rotation  # (F · J) of them
    positions: np.ndarray  # (F, J, 3)
    moving: tuple[int, ...] = (0,)

    def text(self) -> str:
        """The rig as BVH, with X Y Z angles."""
        rows: list[list[np.ndarray]] = [[] for _ in self.positions]
        shape = (len(self.positions), len(self.names), 3)
        angles = self.rotations.as_euler("XYZ", degrees=True).reshape(shape)

        def joint(k: int) -> list[str]:
            moves = "Xposition Yposition Zposition " * (k in self.moving)
            count = 6 if moves else 3
            lines = [f"{'JOINT' if k else 'ROOT'} {self.names[k]}", "{",
                     "OFFSET " + " ".join(f"{x:.9f}" for x in self.offsets[k]),
                     f"CHANNELS {count} {moves}Xrotation Yrotation Zrotation"]  # fmt: skip
            for frame, row in enumerate(rows):
                row += [self.positions[frame, k]] * bool(moves) + [angles[frame, k]]
            for child in (c for c, parent in enumerate(self.parents) if parent == k):
                lines += joint(child)
            if k in self.ends:
                lines += ["End Site", "{", "OFFSET " + " ".join(map(str, self.ends[k])), "}"]
            return [*lines, "}"]

        head = ["HIERARCHY", *joint(0), "MOTION", f"Frames: {len(rows)}", "Frame Time: 0.0333333"]
        body = [" ".join(f"{x:.9f}" for x in np.concatenate(row)) for row in rows]
        return "\n".join([*head, *body]) + "\n"


def walker() -> Rig:
    """A man of 1.70 m who walks along Z, swinging arms and legs."""
    phase = np.arange(FRAMES) * 0.7
    swing = np.zeros((FRAMES, len(NAMES), 3))
    for joint, far in ((13, 0.4), (17, -0.4), (6, -0.3), (10, 0.3), (1, 0.05)):
        swing[:, joint, 0] = far * np.sin(phase)
    swing[:, (14, 18), 0] = 0.3
    swing[:, 0, 1] = 0.1 * np.sin(phase) + 0.05
    positions = np.tile(OFFSETS, (FRAMES, 1, 1))
    positions[:, 0] = np.stack([3 * np.sin(phase), 88 + np.cos(phase), 12.0 * np.arange(FRAMES)], 1)
    turns = Rotation.from_rotvec(swing.reshape(-1, 3))
    return Rig(tuple(NAMES), tuple(PARENTS), OFFSETS, ENDS, turns, positions)


def turned(rig: Rig, turn: Rotation, rest: bool) -> Rig:
    """The rig in a world turned by `turn`, its rest pose with it or as it was."""
    count = len(rig.names)
    turns = [rig.rotations[frame * count : (frame + 1) * count] for frame in range(FRAMES)]
    if rest:
        changed = [turn * rotations * turn.inv() for rotations in turns]
        positions = turn.apply(rig.positions.reshape(-1, 3)).reshape(rig.positions.shape)
        ends = {joint: tuple(turn.apply(end)) for joint, end in rig.ends.items()}
        offsets = turn.apply(rig.offsets)
    else:
        first = [Rotation.concatenate([turn * rotations[:1], rotations[1:]]) for rotations in turns]
        changed, positions, ends, offsets = first, rig.positions.copy(), rig.ends, rig.offsets
        positions[:, 0] = turn.apply(rig.positions[:, 0])
    return replace(rig, rotations=Rotation.concatenate(changed), positions=positions, ends=ends,
                   offsets=offsets)  # fmt: skip


def under(rig: Rig, names: str, turns: Rotation, places: np.ndarray, beside: int = 0) -> Rig:
    """The rig below a chain of roots, the last of which turns and goes as given (F of each).

    `beside` joints hang on the first root too.
    """
    above = names.split()
    more, count = len(above), len(rig.names)
    extra = [f"ik_{k}" for k in range(beside)]
    positions = np.zeros((FRAMES, more + count + beside, 3))
    positions[:, more - 1] = places
    inner = turns.inv().apply(rig.positions[:, 0] - places)
    positions[:, more : more + count] = rig.positions
    positions[:, more] = inner
    rotations = []
    for frame in range(FRAMES):
        own = rig.rotations[frame * count : (frame + 1) * count]
        still, turn = Rotation.from_rotvec(np.zeros((more - 1, 3))), turns[frame : frame + 1]
        rotations += [still, turn, turn.inv() * own[:1], own[1:]]
        rotations.append(Rotation.from_rotvec(np.zeros((beside, 3))))
    parents = [*range(-1, more - 1), *(p + more if p >= 0 else more - 1 for p in rig.parents)]
    return Rig(
        names=(*above, *rig.names, *extra),
        parents=(*parents, *[0] * beside),
        offsets=np.concatenate([np.zeros((more, 3)), rig.offsets, np.full((beside, 3), 5.0)]),
        ends={joint + more: end for joint, end in rig.ends.items()},
        rotations=Rotation.concatenate(rotations),
        positions=positions,
        moving=(*range(more), more),
    )


STILL = Rotation.from_rotvec(np.zeros((FRAMES, 3)))
NOWHERE = np.zeros((FRAMES, 3))
TURNING = Rotation.from_euler("Y", np.linspace(0, 1, FRAMES)[:, None])
ALONG = np.stack([np.arange(FRAMES), np.zeros(FRAMES), 12.0 * np.arange(FRAMES)], axis=1)
Z_UP = Rotation.from_euler("X", 90, degrees=True)


@pytest.fixture
def read(tmp_path) -> Callable:
    """Writes a rig (or text) and loads it."""

    def loaded(rig, **options):
        text = rig if isinstance(rig, str) else rig.text()
        (tmp_path / "clip.bvh").write_text(text, encoding="utf-8")
        return load_clip(tmp_path / "clip.bvh", **options)

    return loaded


def places(clip) -> np.ndarray:
    """Where the joints are, sorted by their names."""
    motion = clip.motion
    found = forward(motion.skeleton, motion.rotations, motion.root)[0]
    return found[:, np.argsort(motion.skeleton.names)]


@pytest.mark.parametrize(
    ("names", "turns", "where", "beside"),
    [
        ("Armature", STILL, NOWHERE, 0),
        ("Armature", STILL, NOWHERE + np.array([100.0, 0.0, -30.0]), 0),
        ("root", TURNING, ALONG, 0),
        ("root", STILL, ALONG, 3),
        ("Scene Armature Reference", TURNING, ALONG, 0),
    ],
)
def test_the_joint_that_carries_the_body_is_the_root(read, names, turns, where, beside):
    plain, found = read(walker()), read(under(walker(), names, turns, where, beside))
    assert np.allclose(places(found), places(plain), atol=1e-6)
    assert found.motion.skeleton.names == plain.motion.skeleton.names
    assert found.scale == 0.01
    assert found.roles_missing == ()
    above = ", ".join(names.split())
    assert found.warnings[0].startswith(f"Hips carries the body: {above} above it folded in")
    assert ("left out: ik_0, ik_1, ik_2" in found.warnings[0]) == bool(beside)
    assert found.joints == len(plain.motion.skeleton) + len(names.split()) + beside


def test_one_hierarchy_is_folded_alike_whether_it_moves_or_not(read):
    rig = under(walker(), "root", STILL, NOWHERE)
    stands = replace(rig, positions=np.tile(rig.positions[:1], (FRAMES, 1, 1)))
    assert read(stands).motion.skeleton.same_hierarchy(read(rig).motion.skeleton)


def test_rest_poses_of_a_folded_rig_are_dropped(read):
    rig = under(walker(), "root", STILL, NOWHERE)
    count = len(rig.names)
    parts = [rig.rotations[k * count : (k + 1) * count] for k in range(FRAMES)]
    rest = Rotation.from_rotvec(np.zeros((count, 3)))
    dropped = replace(rig, rotations=Rotation.concatenate([rest, *parts[1:]]))
    found = read(dropped)
    assert len(found.motion) == FRAMES - 1
    assert "1 inserted rest pose dropped at the start" in found.warnings


def test_hips_that_do_not_move_below_a_root_that_does_are_left_there(read):
    rig = under(walker(), "root", STILL, walker().positions[:, 0])
    found = read(replace(rig, moving=(0,)))
    assert found.motion.skeleton.names[0] == "root"
    hips = sorted(found.motion.skeleton.names).index("Hips")
    assert np.allclose(places(found)[:, hips, 1], 0.01 * rig.positions[:, 0, 1], atol=1e-6)
    assert not found.warnings


def test_hips_may_be_relative_to_their_offset_as_a_root_may(read):
    rig = under(walker(), "root", STILL, NOWHERE)
    rig.offsets[1] = [0.0, 87.0, 0.0]
    rig.positions[:, 1] -= rig.offsets[1]
    found = read(rig)
    assert np.allclose(places(found), places(read(walker())), atol=1e-6)
    assert "the root's position channels are relative to its OFFSET: added to it" in found.warnings


def test_an_armature_without_channels_is_folded_too(read):
    text = under(walker(), "Armature", STILL, NOWHERE).text()
    text = text.replace(text[text.index("CHANNELS 6") :].split("\n")[0], "CHANNELS 0", 1)
    head, rows = text.split("Frame Time: 0.0333333\n")
    rows = "\n".join(" ".join(row.split()[6:]) for row in rows.splitlines())
    found = read(f"{head}Frame Time: 0.0333333\n{rows}\n")
    assert np.allclose(places(found), places(read(walker())), atol=1e-6)
    assert found.warnings == ("Hips carries the body: Armature above it folded in",)


@pytest.mark.parametrize("above", ["", "root"])
def test_a_body_without_legs_is_carried_by_what_moves(read, above):
    """Arms, trunk and head, with positions on every joint."""
    rig, count = walker(), 13
    taken = [f * len(NAMES) + k for f in range(FRAMES) for k in range(count)]
    bust = Rig(rig.names[:count], rig.parents[:count], rig.offsets[:count],
               {k: end for k, end in ENDS.items() if k < count}, rig.rotations[taken],
               rig.positions[:, :count], tuple(range(count)))  # fmt: skip
    whole = under(bust, above, STILL, NOWHERE) if above else bust
    found = read(replace(whole, moving=tuple(range(len(whole.names)))), scale=0.01)
    assert found.motion.skeleton.names == bust.names
    assert np.allclose(found.motion.root, 0.01 * rig.positions[:, 0], atol=1e-6)


def test_limbs_that_stretch_carry_nothing(read):
    rig = walker()
    rig.positions[:, 6, 0] += np.linspace(0, 3, FRAMES)
    found = read(replace(rig, moving=(0, 6)))
    assert found.motion.skeleton.names[0] == "Hips"
    assert found.warnings == ("positions that vary were replaced by their mean: LeftArm (15.0 mm)",)


@pytest.mark.parametrize("start", [(0, 0), (3, 40), (-200, 10), (500, -60)])
@pytest.mark.parametrize("rest", [True, False])
def test_a_world_with_z_up_is_turned_wherever_the_body_walks(read, rest, start):
    rig = walker()
    rig.positions[:, 0, (0, 2)] += start
    found = read(turned(rig, Z_UP, rest))
    assert np.allclose(places(found), places(read(rig)), atol=1e-6)
    assert found.up == "Z"
    assert bool(found.warnings) == (not rest)


def test_a_rest_pose_whose_bones_all_run_along_one_axis_tells_no_up_axis(read):
    """Every joint's own frame is turned so that its first bone runs along X (LaFAN1)."""
    rig, count = walker(), len(NAMES)
    own = []
    for joint in range(count):
        bones = [OFFSETS[k] for k in range(count) if PARENTS[k] == joint]
        bone = bones[0] if bones else np.array(ENDS[joint], dtype=float)
        own.append(Rotation.align_vectors([bone], [[1.0, 0.0, 0.0]])[0])
    above = [Rotation.identity() if parent < 0 else own[parent] for parent in PARENTS]
    offsets = np.array([above[k].inv().apply(OFFSETS[k]) for k in range(count)])
    ends = {joint: tuple(own[joint].inv().apply(end)) for joint, end in ENDS.items()}
    rotations = [above[k].inv() * rig.rotations[f * count + k] * own[k]
                 for f in range(FRAMES) for k in range(count)]  # fmt: skip
    positions = np.tile(offsets, (FRAMES, 1, 1))
    positions[:, 0] = rig.positions[:, 0]
    bent = replace(rig, offsets=offsets, ends=ends, positions=positions,
                   rotations=Rotation.concatenate(rotations))  # fmt: skip
    for world, up in ((Rotation.identity(), "Y"), (Z_UP, "Z")):
        found = read(turned(bent, world, rest=False))
        assert found.up == up
        assert np.allclose(places(found), places(read(rig)), atol=1e-6)


def test_one_who_lies_stays_lying(read):
    lying = turned(walker(), Z_UP, rest=False)
    count = len(NAMES)
    for height, along in ((12, 300.0), (20, 88.0)):
        places_of = lying.positions.copy()
        places_of[:, 0] = np.array([0.0, height, along]) + 0.1 * np.arange(FRAMES)[:, None]
        assert read(replace(lying, positions=places_of)).up == "Y"
    assert len(lying.rotations) == FRAMES * count


def test_millimetres_are_a_unit(read):
    rig = walker()
    ends = {joint: tuple(10.0 * x for x in end) for joint, end in rig.ends.items()}
    large = replace(rig, offsets=rig.offsets * 10, ends=ends, positions=rig.positions * 10)
    found = read(large)
    assert (found.scale, found.warnings) == (0.001, ())
    assert np.allclose(places(found), places(read(rig)), atol=1e-6)


def test_positions_of_zero_are_refused_where_they_shrink_the_body(read):
    rig = walker()
    everywhere = replace(rig, moving=tuple(range(len(NAMES))))
    rig.positions[:, 1:] = 0.0
    with pytest.raises(InputError, match=r"clip\.bvh: .* found 0 in all frames for Spine, Chest"):
        read(everywhere)
    one = walker()
    one.positions[:, 5] = 0.0
    found = read(replace(one, moving=(0, 5, 6)))
    assert "positions that are 0 replace the OFFSET of LeftShoulder" in found.warnings


def test_bones_may_be_positions_alone(read):
    rig = replace(walker(), offsets=OFFSETS * 0, moving=tuple(range(len(NAMES))))
    found = read(rig)
    assert np.allclose(places(found), places(read(walker())), atol=1e-6)
    assert not found.warnings


def test_a_root_without_positions_is_said_to_stay(read):
    found = read(replace(walker(), moving=()))
    assert found.warnings == ("the root has no position channels: the body stays in its place",)


@pytest.mark.parametrize(
    ("written", "fps", "told"),
    [
        ("0.033", 30, "30.3"), ("0.03", 30, "33.33"), ("0.0333", 30, "30.03"),
        ("0.0167", 60, "59.88"),
        ("0.017", 60, "58.82"), ("0.016667", 60, None), ("0.04", 25, "24 would fit too"),
        ("0.042", 24, "23.81"), ("0.0417", 24, None), ("0.008", 120, "125"),
        ("0.0083", 120, "120.5"),
        ("0.011", 90, "91"), ("0.01", 100, "90 or 120 would fit too"), ("0.02", 50, "60 would"),
        ("0.05", 20, None), ("0.1", 10, None), ("0.025", 40, None), ("0.0334", 1 / 0.0334, None),
        ("0.007", 143, None), ("3.3e-2", 30, "30.3"), ("0.02000", 50, None),
        ("0.033366", 30, None), ("1", 1, None), (".0400", 25, None),
    ],
)  # fmt: skip
def test_a_frame_time_of_few_digits_is_the_usual_rate_that_it_stands_for(read, written, fps, told):
    found = read(walker().text().replace("0.0333333", written))
    assert found.fps == pytest.approx(fps, abs=1e-9)
    if told is None:
        assert not found.warnings
    else:
        assert f"Frame Time {written}" in found.warnings[0]
        assert told in found.warnings[0]
    assert read(walker().text().replace("0.0333333", written), fps=77).fps == 77


def anonymous(rig: Rig) -> Rig:
    return replace(rig, names=tuple(f"bone {k}" for k in range(len(rig.names))))


def mirrored(rig: Rig) -> Rig:
    """The same body with its right limbs listed first."""
    order = [*range(5), *range(9, 13), *range(5, 9), *range(17, 21), *range(13, 17)]
    place = np.argsort(order)
    count = len(order)
    taken = [f * count + k for f in range(FRAMES) for k in order]
    return Rig(
        names=tuple(rig.names[k] for k in order),
        parents=tuple(int(place[rig.parents[k]]) if rig.parents[k] >= 0 else -1 for k in order),
        offsets=rig.offsets[order],
        ends={int(place[joint]): end for joint, end in rig.ends.items()},
        rotations=rig.rotations[taken],
        positions=rig.positions[:, order],
    )


SHAPES: dict[str, Rig] = {
    "as it stands": walker(),
    "right first": mirrored(walker()),
    "Z up": turned(walker(), Z_UP, rest=True),
    "Z up by the root": turned(walker(), Z_UP, rest=False),
    "facing X": turned(walker(), Rotation.from_euler("Y", 1.5), rest=True),
    "below an armature": under(walker(), "root", STILL, NOWHERE),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_where_names_tell_nothing_the_shape_does(read, shape):
    named, found = read(SHAPES[shape]), read(anonymous(SHAPES[shape]))
    assert not named.roles_missing
    assert dict(found.motion.skeleton.roles) == dict(named.motion.skeleton.roles)
    note = next(
        note for note in found.warnings if note.startswith("told from the skeleton's shape")
    )
    assert all(
        f"{role} = bone" in note for role in ROLES if role not in ("pelvis", "spine", "chest")
    )
    assert found.scale == 0.01


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("part", LIMBS)
def test_one_role_that_no_name_tells_is_filled_by_the_shape(read, side, part):
    rig = walker()
    joint = read(rig).motion.skeleton.roles[f"{side}_{part}"]
    names = list(rig.names)
    names[joint] = "thing"
    found = read(replace(rig, names=tuple(names)))
    assert found.motion.skeleton.roles[f"{side}_{part}"] == joint
    assert any(f"{side}_{part} = thing" in note for note in found.warnings)


def test_names_rule_over_the_shape(read):
    """A body whose names have left and right the other way than its feet point."""
    swap = {"Left": "Right", "Right": "Left"}
    rig = walker()
    names = [name if name[:4] not in ("Left", "Righ") else
             swap["Left" if name.startswith("Left") else "Right"] + name.removeprefix(
                 "Left").removeprefix("Right") for name in rig.names]  # fmt: skip
    names[names.index("LeftHand")] = "thing"
    found = read(replace(rig, names=tuple(names)))
    assert found.motion.skeleton.names[found.motion.skeleton.roles["left_wrist"]] == "thing"


@pytest.mark.parametrize("named", [False, True])
def test_without_feet_only_a_name_tells_left_from_right(read, named):
    """Shanks that end in end sites: nothing shows where the body faces."""
    kept = [k for k in range(len(NAMES)) if not NAMES[k].endswith(("Foot", "Toe"))]
    place = {old: new for new, old in enumerate(kept)}
    rig = walker()
    ends = {place[joint]: end for joint, end in ENDS.items() if joint in place}
    ends |= {place[joint]: (0, -41, 0) for joint in (14, 18)}
    names = [f"bone {k}" for k in kept]
    if named:
        names[place[14]] = "LeftShin"
    lame = Rig(
        names=tuple(names),
        parents=tuple(place.get(PARENTS[k], -1) for k in kept),
        offsets=rig.offsets[kept],
        ends=ends,
        rotations=rig.rotations[[f * len(NAMES) + k for f in range(FRAMES) for k in kept]],
        positions=rig.positions[:, kept],
    )
    roles = read(lame, scale=0.01).motion.skeleton.roles
    assert roles["head"] == place[4]
    assert ("left_hip" in roles) == named
    if named:
        assert (roles["left_hip"], roles["right_elbow"]) == (place[13], place[11])


def test_what_is_no_body_gets_no_roles(read):
    arms = [0, 1, 2, *range(5, 13)]
    place = {old: new for new, old in enumerate(arms)}
    rig, count = walker(), len(NAMES)
    puppet = Rig(
        names=tuple(f"bone {k}" for k in arms),
        parents=tuple(place.get(PARENTS[k], -1) for k in arms),
        offsets=rig.offsets[arms],
        ends={place[joint]: end for joint, end in ENDS.items() if joint in place},
        rotations=rig.rotations[[f * count + k for f in range(FRAMES) for k in arms]],
        positions=rig.positions[:, arms],
    )
    found = read(puppet)
    assert "left_hip" in found.roles_missing
    assert not any("shape" in note for note in found.warnings)


@pytest.mark.parametrize("names", [NAMES, [f'bone {k} "\\" \'ä' for k in range(len(NAMES))]])
def test_roles_printed_are_overrides_that_give_the_same_roles(read, tmp_path, names):
    rig = replace(walker(), names=tuple(names))
    found = read(rig)
    text = roles_as_overrides(found)
    assert ("shape" in text) == (names is not NAMES)
    (tmp_path / "overrides.toml").write_text(text, encoding="utf-8")
    again = read(rig)
    assert dict(again.motion.skeleton.roles) == dict(found.motion.skeleton.roles)
    assert not again.warnings


def test_roles_that_cannot_be_named_are_printed_as_comments(read, tmp_path):
    names = ["Toe" if name.endswith("Toe") else name for name in NAMES]
    names[4] = "Neck"
    found = read(replace(walker(), names=tuple(names)))
    text = roles_as_overrides(found)
    assert 'left_toe = "Toe"\n' in text
    assert '# right_toe = "Toe", another joint' in text
    (tmp_path / "overrides.toml").write_text(text, encoding="utf-8")
    assert read(replace(walker(), names=tuple(names))).motion.skeleton.roles["left_toe"] == 16


def test_quaternions_of_a_rig_are_those_of_its_angles(read):
    rig = walker()
    motion = read(rig).motion
    expected = rig.rotations.as_quat(scalar_first=True).reshape(FRAMES, -1, 4)
    assert np.max(quat.geodesic(motion.rotations, expected)) < 1e-7


FAMILIES = (
    "accad_male1_bvh/Male1_C03_Run.bvh", "accad_male1_bvh/Male1_A10_LieToCrouch.bvh",
    "cmu_bvh/02_01.bvh", "cmu_bvh/05_01.bvh", "cmu_bvh/06_01.bvh", "cmu_bvh/09_01.bvh",
    "cmu_from_amc_bvh/16_41.bvh", "cmu_asfamc/02_03.amc", "cmu_asfamc/16_41.amc",
    "other_bvh/cmu_daz_salsa_13.bvh", "other_bvh/reactidle_002_genuine.bvh",
    "other_bvh/rokoko_jesse_dance.bvh", "messy/real_freebvh_55j.bvh",
    "messy/real_mocapbank_crlf.bvh", "messy/real_pybvh_test3_zup_60j.bvh",
    "messy/real_skeleton_one_frame.bvh", "messy/real_walk01_24fps.bvh", "messy/no_end_sites.bvh",
)  # fmt: skip


def assert_shape_tells_what_names_do(path) -> None:
    motion = load_clip(path).motion
    skeleton = motion.skeleton
    found = shape_roles(replace(skeleton, roles={}), motion.rotations, {})
    wrists = {"left_wrist", "right_wrist"} if "lwrist" in skeleton.names else set()
    expected = {role: joint for role, joint in skeleton.roles.items() if role not in wrists}
    assert {role: joint for role, joint in found.items() if role not in wrists} == expected


@pytest.mark.parametrize("name", of_captured(FAMILIES))
def test_the_shape_of_a_captured_body_tells_what_its_names_do(motions, name):
    assert_shape_tells_what_names_do(motions / name)


@pytest.mark.slow
def test_the_shape_of_every_captured_body_tells_what_its_names_do(motions):
    folders = ("accad_male1_bvh", "cmu_bvh", "cmu_asfamc", "cmu_from_amc_bvh", "other_bvh")
    for path in (path for folder in folders for path in clips_under(motions / folder)):
        assert_shape_tells_what_names_do(path)


def test_an_armature_that_stands_a_body_up_is_folded_into_it(read):
    """Blender's: bones rest with Z up, and the armature turns them to a world with Y up."""
    back = turned(turned(walker(), Z_UP, rest=True), Z_UP.inv(), rest=False)
    turning = Rotation.concatenate([Z_UP.inv()] * FRAMES)
    found = read(under(back, "Armature", turning, NOWHERE))
    assert np.allclose(places(found), places(read(walker())), atol=1e-6)
    assert found.up == "Y"
    assert found.scale == 0.01
    assert not found.roles_missing
