"""Units, axes, rest poses, rates, roles, overrides: what a clip is brought to."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from stimuli.errors import InputError, InputWarning
from stimuli.motion import forward, load_clip
from stimuli.motion import quaternions as quat
from stimuli.motion.formats.source import check_size
from stimuli.motion.resample import resampled
from stimuli.motion.roles import ROLES, resolve_roles

BODY = (  # name, parent, offset in centimetres: a man of 1.70 m who faces +Z
    ("Hips", -1, (0, 0, 0)), ("Spine", 0, (0, 12, 0)), ("Chest", 1, (0, 25, 0)),
    ("Neck", 2, (0, 22, 0)), ("Head", 3, (0, 10, 0)),
    ("LeftShoulder", 2, (5, 18, 0)), ("LeftArm", 5, (13, 0, 0)), ("LeftForeArm", 6, (27, 0, 0)),
    ("LeftHand", 7, (25, 0, 0)),
    ("RightShoulder", 2, (-5, 18, 0)), ("RightArm", 9, (-13, 0, 0)),
    ("RightForeArm", 10, (-27, 0, 0)), ("RightHand", 11, (-25, 0, 0)),
    ("LeftUpLeg", 0, (9, 0, 0)), ("LeftLeg", 13, (0, -42, 0)), ("LeftFoot", 14, (0, -41, 0)),
    ("LeftToeBase", 15, (0, -5, 14)),
    ("RightUpLeg", 0, (-9, 0, 0)), ("RightLeg", 17, (0, -42, 0)), ("RightFoot", 18, (0, -41, 0)),
    ("RightToeBase", 19, (0, -5, 14)),
)  # fmt: skip


def bvh(frames, *, unit=1.0, fps=30, offset=(0, 0, 0), turn=None, ends=True) -> str:
    """A BVH of BODY in some unit (centimetres times it); `frames` are rows of 6 root channels."""
    children = {k: [n for n, (_, p, _) in enumerate(BODY) if p == k] for k in range(len(BODY))}

    def joint(k: int) -> list[str]:
        name, _, place = BODY[k]
        place = np.array(offset if k == 0 else place, dtype=float) * unit
        place = turn(place) if turn else place
        kind = ("ROOT", "6 Xposition Yposition Zposition") if k == 0 else ("JOINT", "3")
        lines = [f"{kind[0]} {name}", "{", "OFFSET " + " ".join(map(str, place)),
                 f"CHANNELS {kind[1]} Zrotation Xrotation Yrotation"]  # fmt: skip
        for child in children[k]:
            lines += joint(child)
        if not children[k] and ends:
            end = np.array([0, 14 if name == "Head" else 0, 0], dtype=float) * unit
            end = turn(end) if turn else end
            lines += ["End Site", "{", "OFFSET " + " ".join(map(str, end)), "}"]
        return [*lines, "}"]

    rows = [" ".join(map(str, [*row, *[0] * 3 * (len(BODY) - 1)])) for row in frames]
    head = ["HIERARCHY", *joint(0), "MOTION", f"Frames: {len(rows)}", f"Frame Time: {1 / fps:.7f}"]
    return "\n".join([*head, *rows]) + "\n"


def standing(unit: float = 1.0, count: int = 4) -> list[list[float]]:
    return [[0, 88 * unit, k * unit, 1, 0, 0] for k in range(count)]


@pytest.fixture
def clip(tmp_path):
    """Writes a text as a clip and loads it."""

    def loaded(text: str, name: str = "clip.bvh", **options):
        (tmp_path / name).write_text(text)
        return load_clip(tmp_path / name, **options)

    return loaded


@pytest.mark.parametrize(("unit", "scale"), [(1.0, 0.01), (0.01, 1.0), (1 / 2.54, 0.0254),
                                             (0.01 / 0.056444, 0.056444)])  # fmt: skip
def test_the_unit_is_the_one_that_makes_a_man(clip, unit, scale):
    found = clip(bvh(standing(unit), unit=unit))
    assert found.scale == scale
    assert not found.warnings
    positions, _ = forward(found.motion.skeleton, found.motion.rotations, found.motion.root)
    assert np.isclose(positions[0, found.motion.skeleton.roles["left_ankle"], 1], 0.05, atol=3e-3)


def test_no_known_unit_scales_to_1_7_metres_and_says_so(clip):
    found = clip(bvh(standing(0.1), unit=0.1))
    stature = 0.1 * (12 + 25 + 22 + 10 + 14 + 9 + 42 + 41)
    assert np.isclose(found.scale * stature, 1.7)
    assert "scaled to 1.7 m" in found.warnings[0]
    assert clip(bvh(standing(0.1), unit=0.1), scale=0.09).scale == 0.09
    with pytest.raises(InputError, match="scale"):
        clip(bvh(standing()), scale="big")


def test_z_up_sources_are_turned(clip):
    upright = clip(bvh(standing())).motion
    frames = [[0, -k, 88, 0, 0, 0] for k in range(4)]
    text = bvh(frames, turn=lambda v: np.array([v[0], -v[2], v[1]]))
    turned = clip(text)
    assert turned.up == "Z"
    p, _ = forward(turned.motion.skeleton, turned.motion.rotations, turned.motion.root)
    q, _ = forward(upright.skeleton, quat.normalise(upright.rotations * 0 + quat.IDENTITY),
                   upright.root)  # fmt: skip
    assert np.allclose(p, q, atol=1e-6)


def test_a_body_stood_up_by_its_root_rotation_is_found(clip):
    frames = [[0, 0.0, 88, 0, 90, 0] for _ in range(4)]  # turned about X: Y-up rest, Z-up world
    found = clip(bvh(frames))
    assert found.up == "Z"
    assert "has Y up" in found.warnings[0]
    p, _ = forward(found.motion.skeleton, found.motion.rotations, found.motion.root)
    assert p[0, found.motion.skeleton.roles["head"], 1] > 1.4
    assert clip(bvh(frames), up="Y").up == "Y"


def test_a_body_that_lies_stays_lying(clip):
    frames = [[0, 12, 260, 0, 90, 0] for _ in range(4)]
    assert clip(bvh(frames)).up == "Y"


@pytest.mark.parametrize(("rest", "kept"), [(1, 6), (2, 5), (3, 4), (4, 7)])
def test_up_to_three_inserted_rest_poses_are_dropped(clip, rest, kept):
    frames = [[0, 88, 0, 0, 0, 0]] * rest + standing(count=7)[: 7 - rest]
    found = clip(bvh(frames[:7]))
    assert found.frames == 7
    assert len(found.motion) == kept
    assert found.seconds == (kept - 1) / 30
    assert bool(found.warnings) == (kept < 7)


def test_a_relative_root_channel_adds_to_its_offset(clip):
    frames = [[0, 0.5 * k, k, 1, 0, 0] for k in range(5)]
    found = clip(bvh(frames, offset=(0, 88, 0)))
    assert np.isclose(found.motion.root[0, 1], 0.88)
    assert "relative" in found.warnings[0]
    absolute = clip(bvh(standing(), offset=(3, 88, -2)))
    assert np.isclose(absolute.motion.root[0, 1], 0.88)
    assert np.isclose(absolute.motion.root[0, 0], 0.0)


def test_frame_k_is_at_k_thirtieths_of_a_second(clip):
    frames = [[0, 88, k, 0.1 * k + 1, 0, 0] for k in range(101)]
    for fps, count in ((120, 26), (30, 101), (24, 126), (60, 51), (100, 31)):
        motion = clip(bvh(frames, fps=fps)).motion
        assert len(motion) == count
        assert np.allclose(motion.root[:, 2], np.arange(count) * fps / 30 / 100)
        turned = 2 * np.degrees(quat.log(motion.rotations[:, 0])[:, 2])
        assert np.allclose(turned, 1 + 0.1 * np.arange(count) * fps / 30, atol=1e-6)


def test_resampling_keeps_whole_frames_exactly():
    rotations = quat.normalise(np.random.default_rng(0).normal(size=(41, 3, 4)))
    root = np.random.default_rng(1).normal(size=(41, 3))
    same, path = resampled(rotations, root, 120.0, 30.0)
    assert np.array_equal(same, rotations[::4])
    assert np.array_equal(path, root[::4])


NAMES = {
    "acclaim": "root lowerback thorax lowerneck head lclavicle lhumerus lradius lhand lfemur "
    "ltibia lfoot ltoes rclavicle rhumerus rradius rhand rfemur rtibia rfoot rtoes",
    "daz": "hip abdomen chest neck head lCollar lShldr lForeArm lHand lThigh lShin lFoot lToe "
    "rCollar rShldr rForeArm rHand rThigh rShin rFoot rToe",
    "blender": "pelvis spine spine.001 neck face shoulder.L upper_arm.L forearm.L hand.L thigh.L "
    "shin.L foot.L toe.L shoulder.R upper_arm.R forearm.R hand.R thigh.R shin.R foot.R toe.R",
    "biped": "Bip01_Pelvis Bip01_Spine Bip01_Spine1 Bip01_Neck Bip01_Head Bip01_L_Clavicle "
    "Bip01_L_UpperArm Bip01_L_Forearm Bip01_L_Hand Bip01_L_Thigh Bip01_L_Calf Bip01_L_Foot "
    "Bip01_L_Toe0 Bip01_R_Clavicle Bip01_R_UpperArm Bip01_R_Forearm Bip01_R_Hand Bip01_R_Thigh "
    "Bip01_R_Calf Bip01_R_Foot Bip01_R_Toe0",
    "3ds max": "Hips Chest Chest2 Neck Head LeftCollar LeftShoulder LeftElbow LeftWrist LeftHip "
    "LeftKnee LeftAnkle LeftToe RightCollar RightShoulder RightElbow RightWrist RightHip RightKnee "
    "RightAnkle RightToe",
    "smpl": "Pelvis Spine1 Spine3 Neck Head L_Collar L_Shoulder L_Elbow L_Wrist L_Hip L_Knee "
    "L_Ankle L_Foot R_Collar R_Shoulder R_Elbow R_Wrist R_Hip R_Knee R_Ankle R_Foot",
    "xsens": "Hips Chest Chest2 Neck Head LeftShoulder LeftUpperArm LeftForeArm LeftHand "
    "LeftUpperLeg LeftLowerLeg LeftFoot LeftToe RightShoulder RightUpperArm RightForeArm RightHand "
    "RightUpperLeg RightLowerLeg RightFoot RightToe",
    "optitrack": "Hip Ab Chest Neck Head LShoulder LUArm LFArm LHand LThigh LShin LFoot LToe "
    "RShoulder RUArm RFArm RHand RThigh RShin RFoot RToe",
    "genea": "b_root b_spine0 b_spine3 b_neck0 b_head b_l_shoulder b_l_arm b_l_forearm b_l_wrist "
    "b_l_upleg b_l_leg b_l_foot b_l_toes b_r_shoulder b_r_arm b_r_forearm b_r_wrist b_r_upleg "
    "b_r_leg b_r_foot b_r_toes",
    "iclone": "CC_Base_Hip CC_Base_Waist CC_Base_Spine02 CC_Base_NeckTwist01 CC_Base_Head "
    "CC_Base_L_Clavicle CC_Base_L_Upperarm CC_Base_L_Forearm CC_Base_L_Hand CC_Base_L_Thigh "
    "CC_Base_L_Calf CC_Base_L_Foot CC_Base_L_ToeBase CC_Base_R_Clavicle CC_Base_R_Upperarm "
    "CC_Base_R_Forearm CC_Base_R_Hand CC_Base_R_Thigh CC_Base_R_Calf CC_Base_R_Foot "
    "CC_Base_R_ToeBase",
    "bandai": "Hips Spine Chest Neck Head Shoulder_L UpperArm_L LowerArm_L Hand_L UpperLeg_L "
    "LowerLeg_L Foot_L Toes_L Shoulder_R UpperArm_R LowerArm_R Hand_R UpperLeg_R LowerLeg_R Foot_R "
    "Toes_R",
    "rokoko": "Hips Spine1 Spine4 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand LeftThigh "
    "LeftShin LeftFoot LeftToe RightShoulder RightArm RightForeArm RightHand RightThigh RightShin "
    "RightFoot RightToe",
    "makehuman": "root spine05 spine01 neck01 head clavicle.L upperarm01.L lowerarm01.L wrist.L "
    "upperleg01.L lowerleg01.L foot.L toe1-1.L clavicle.R upperarm01.R lowerarm01.R wrist.R "
    "upperleg01.R lowerleg01.R foot.R toe1-1.R",
    "second life": "mPelvis mTorso mChest mNeck mHead mCollarLeft mShoulderLeft mElbowLeft "
    "mWristLeft mHipLeft mKneeLeft mAnkleLeft mFootLeft mCollarRight mShoulderRight mElbowRight "
    "mWristRight mHipRight mKneeRight mAnkleRight mFootRight",
    "advanced skeleton": "Root_M Spine1_M Chest_M Neck_M Head_M Scapula_L Shoulder_L Elbow_L "
    "Wrist_L Hip_L Knee_L Ankle_L Toes_L Scapula_R Shoulder_R Elbow_R Wrist_R Hip_R Knee_R Ankle_R "
    "Toes_R",
    "vrm": "J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_Neck J_Bip_C_Head J_Bip_L_Shoulder "
    "J_Bip_L_UpperArm J_Bip_L_LowerArm J_Bip_L_Hand J_Bip_L_UpperLeg J_Bip_L_LowerLeg J_Bip_L_Foot "
    "J_Bip_L_ToeBase J_Bip_R_Shoulder J_Bip_R_UpperArm J_Bip_R_LowerArm J_Bip_R_Hand "
    "J_Bip_R_UpperLeg J_Bip_R_LowerLeg J_Bip_R_Foot J_Bip_R_ToeBase",
    "deepmotion": "hips_JNT spine_JNT spine2_JNT neck_JNT head_JNT l_shoulder_JNT l_arm_JNT "
    "l_forearm_JNT l_hand_JNT l_upleg_JNT l_leg_JNT l_foot_JNT l_toebase_JNT r_shoulder_JNT "
    "r_arm_JNT r_forearm_JNT r_hand_JNT r_upleg_JNT r_leg_JNT r_foot_JNT r_toebase_JNT",
    "genesis": "hip abdomenLower chestUpper neckLower head lCollar lShldrBend lForearmBend lHand "
    "lThighBend lShin lFoot lToe rCollar rShldrBend rForearmBend rHand rThighBend rShin rFoot rToe",
    "theia": "pelvis spine torso neck head l_collar l_uarm l_larm l_hand l_thigh l_shank l_foot "
    "l_toes r_collar r_uarm r_larm r_hand r_thigh r_shank r_foot r_toes",
    "mikumikudance": "センター 上半身 上半身2 首 頭 左肩 左腕 左ひじ 左手首 左足 左ひざ 左足首 "
    "左つま先 右肩 右腕 右ひじ 右手首 右足 右ひざ 右足首 右つま先",
    "hip, knee, foot": "hips spine chest neck head l_clavicle l_shoulder l_elbow l_hand l_hip "
    "l_knee l_foot l_toe r_clavicle r_shoulder r_elbow r_hand r_hip r_knee r_foot r_toe",
    "sides as small letters": "hips spine chest neck head lcollar lshoulder lelbow lwrist lhip "
    "lknee lankle ltoes rcollar rshoulder relbow rwrist rhip rknee rankle rtoes",
    "kinect, with clavicles": "PELVIS SPINE_NAVEL SPINE_CHEST NECK HEAD CLAVICLE_LEFT "
    "SHOULDER_LEFT ELBOW_LEFT WRIST_LEFT HIP_LEFT KNEE_LEFT ANKLE_LEFT FOOT_LEFT CLAVICLE_RIGHT "
    "SHOULDER_RIGHT ELBOW_RIGHT WRIST_RIGHT HIP_RIGHT KNEE_RIGHT ANKLE_RIGHT FOOT_RIGHT",
    "unity": "Hips Spine UpperChest Neck Head LeftShoulder LeftUpperArm LeftLowerArm LeftHand "
    "LeftUpperLeg LeftLowerLeg LeftFoot LeftToes RightShoulder RightUpperArm RightLowerArm "
    "RightHand RightUpperLeg RightLowerLeg RightFoot RightToes",
    "auto-rig pro": "c_root spine_01.x spine_03.x neck.x head.x shoulder.l arm_stretch.l "
    "forearm_stretch.l hand.l thigh_stretch.l leg_stretch.l foot.l toes_01.l shoulder.r "
    "arm_stretch.r forearm_stretch.r hand.r thigh_stretch.r leg_stretch.r foot.r toes_01.r",
    "sides as capitals": "Hips Spine Chest Neck Head ClavicleL UpperArmL ForearmL HandL ThighL "
    "CalfL FootL ToeL ClavicleR UpperArmR ForearmR HandR ThighR CalfR FootR ToeR",
    "unreal": "pelvis spine_01 spine_03 neck_01 head clavicle_l upperarm_l lowerarm_l hand_l "
    "thigh_l calf_l foot_l ball_l clavicle_r upperarm_r lowerarm_r hand_r thigh_r calf_r foot_r "
    "ball_r",
}
MIXAMO = (
    "Hips Spine Spine1 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand LeftUpLeg LeftLeg "
    "LeftFoot LeftToeBase RightShoulder RightArm RightForeArm RightHand RightUpLeg RightLeg "
    "RightFoot RightToeBase"
)
NAMES["mixamo without separators"] = " ".join(f"mixamorig{name}" for name in MIXAMO.split())
NAMES["a character's"] = " ".join(f"Anna_rig01_{name}" for name in MIXAMO.split())
BIPED = (
    "Pelvis Spine Spine4 Neck1 Head1 L_Clavicle L_UpperArm L_Forearm L_Hand L_Thigh L_Calf L_Foot "
    "L_Toe0 R_Clavicle R_UpperArm R_Forearm R_Hand R_Thigh R_Calf R_Foot R_Toe0"
)
NAMES["valve"] = " ".join(f"ValveBiped.Bip01_{name}" for name in BIPED.split())
NAMES["rigify"] = " ".join(f"DEF-{name}" for name in NAMES["blender"].split())
NAMES["words"] = "|".join(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name) for name in MIXAMO.split())
NAMES["a suffix"] = " ".join(f"{name}_bone" for name in MIXAMO.split())
NAMES["mixamo"] = " ".join(f"mixamorig:{name}" for name in MIXAMO.split())
PARENTS = np.array([-1, 0, 1, 2, 3, 2, 5, 6, 7, 0, 9, 10, 11, 2, 13, 14, 15, 0, 17, 18, 19])
ORDER = ["pelvis", "spine", "chest", "neck", "head"] + [
    f"{side}_{limb}" for side in ("left", "right")
    for limb in ("clavicle", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")
]  # fmt: skip


@pytest.mark.parametrize("family", NAMES)
def test_roles_are_resolved_by_conventions_of_names(family):
    names = NAMES[family].split("|" if "|" in NAMES[family] else None)
    moving = quat.about("X", np.array([0.0, 0.3]))[:, None] * np.ones((1, len(names), 1))
    roles = resolve_roles(names, PARENTS, moving)
    assert roles == {role: joint for joint, role in enumerate(ORDER)}


def test_the_spine_is_the_first_joint_above_the_pelvis_that_moves():
    names = NAMES["mixamo"].split()
    rotations = np.tile(quat.IDENTITY, (2, len(names), 1))
    rotations[1, 2] = quat.about("X", 0.3)
    assert resolve_roles(names, PARENTS, rotations)["spine"] == 2


def test_overrides_name_joints_and_settings(clip, tmp_path):
    odd = bvh(standing()).replace("LeftUpLeg", "bone17").replace("RightUpLeg", "bone23")
    assert "left_hip = bone17, right_hip = bone23" in clip(odd).warnings[0]
    (tmp_path / "overrides.toml").write_text(
        'scale = 0.02\n[roles]\nleft_hip = "bone17"\nright_hip = "bone23"\n'
    )
    found = clip(odd)
    assert not found.roles_missing
    assert not found.warnings
    assert found.scale == 0.02
    given = clip(odd, overrides={"roles": {"left_hip": "bone17"}}, scale=0.01)
    assert given.warnings == (
        "told from the skeleton's shape, as no name tells it: right_hip = bone23",
    )


@pytest.mark.parametrize(
    ("text", "told"),
    [('[roles]\nnose = "x"', "nose"), ('[clips.clip.roles]\nleft_hip = "x"', "not there: x"),
     ("colour = 1", "colour"), ("roles = 3", "roles"), ("fps = 0", "fps"), ("= 1", "TOML"),
     ('up = "X"', "up")],
)  # fmt: skip
def test_faults_of_overrides_are_named(clip, tmp_path, text, told):
    (tmp_path / "overrides.toml").write_text(text)
    with pytest.raises(InputError, match=told):
        clip(bvh(standing()))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[roles]\nhead = 3", "roles.head: expected the name of a joint, found 3"),
        (
            '[roles]\nhead = ["Head"]',
            "roles.head: expected the name of a joint, found \\['Head'\\]",
        ),
        ("scale = [1]", "scale: expected auto or metres"),
        ("scale = true", "scale: .* found True"),
        ('scale = "0.01"', "scale: .* found '0.01'"),
        ("fps = true", "fps: .* found True"),
        ("fps = 0.3", "fps: .* 1 to 2000, found 0.3"),
        ("fps = inf", "fps: .* found inf"),
        ("up = 3", "up: expected auto or Y or Z, found 3"),
        ("clips = 3", "clips: expected a table"),
        ("[clips]\nclip = 3", "clips.clip: expected a table"),
        ("[clips.other]\nup = 3", "clips.other.up"),
        ("[clips.clip.bvh]\nup = 'Y'", "clips.clip.bvh: no such setting"),
        (f"fps = {'9' * 5000}", "TOML"),
        ("fps = " + "[" * 5000, "TOML"),
    ],
)
def test_settings_of_another_kind_are_refused_with_file_and_key(clip, tmp_path, text, told):
    (tmp_path / "overrides.toml").write_text(text)
    with pytest.raises(InputError, match=rf"overrides\.toml: .*{told}") as caught:
        clip(bvh(standing()))
    assert len(str(caught.value).splitlines()) <= 2


def test_all_faults_of_overrides_are_told_at_once(clip, tmp_path):
    (tmp_path / "overrides.toml").write_text(
        "scale = true\nup = 3\nhue = 1\n[roles]\nhead = 3\n[clips.other]\nfps = true\n"
    )
    with pytest.raises(InputError) as caught:
        clip(bvh(standing()))
    for key in ("scale", "up", "hue", "roles.head", "clips.other.fps"):
        assert f"{key}: " in str(caught.value)


def test_settings_of_one_clip_rule_over_the_general_ones(clip, tmp_path):
    (tmp_path / "overrides.toml").write_text(
        "scale = 0.02\nfps = 60\n[roles]\nhead = 'Neck'\n"
        "[clips.one]\nscale = 0.03\nfps = 'auto'\n[clips.one.roles]\nhead = 'Head'\n"
        "[clips.'one.bvh']\nscale = 0.04\n[clips.two]\nup = 'Z'\n"
    )
    (tmp_path / "two.bvh").touch()
    one, two = (clip(bvh(standing()), f"{name}.bvh") for name in ("one", "two"))
    assert (one.scale, one.fps, one.up) == (0.04, 30, "Y")
    assert (two.scale, two.fps, two.up) == (0.02, 60, "Z")
    head = [c.motion.skeleton.names[c.motion.skeleton.roles["head"]] for c in (one, two)]
    assert head == ["Head", "Neck"]
    assert clip(bvh(standing()), "one.bvh", scale=0.05).scale == 0.05
    given = {"scale": 0.06, "clips": {"one": {"scale": 0.07}}}
    assert clip(bvh(standing()), "one.bvh", overrides=given).scale == 0.07


def test_a_usual_role_whose_joint_a_clip_lacks_is_told_from_the_names(clip, tmp_path):
    text = "[roles]\nhead = 'Skull'\nleft_hip = 'LeftUpLeg'\n"
    (tmp_path / "overrides.toml").write_text(text)
    found = clip(bvh(standing()))
    assert found.motion.skeleton.names[found.motion.skeleton.roles["head"]] == "Head"
    assert found.warnings == (
        "no joint Skull (head) of overrides.toml here: told from the names instead",
    )
    assert not clip(bvh(standing()).replace("JOINT Head", "JOINT Skull"), "b.bvh").warnings
    for given in (tmp_path / "overrides.toml", {"roles": {"head": "Skull"}}):
        with pytest.raises(InputError, match="not there: Skull"):
            clip(bvh(standing()), overrides=given)


def test_a_table_of_a_clip_that_is_not_there_is_warned_of(clip, tmp_path):
    (tmp_path / "overrides.toml").write_text("[clips.clap]\nscale = 0.02\n[clips.clip]\nfps = 60\n")
    with pytest.warns(InputWarning, match=r"overrides\.toml names clips that are not there: clap$"):
        found = clip(bvh(standing()))
    assert found.fps == 60
    assert found.warnings == ()


def test_a_directory_of_clips_is_warned_of_once_listed_once_and_its_overrides_read_once(
    clip, tmp_path, monkeypatch
):
    (tmp_path / "overrides.toml").write_text("[clips.clap]\nscale = 0.02\n[roles]\nchest = 'Chest'")
    names = [f"{k}.bvh" for k in range(4)]
    for name in names:
        (tmp_path / name).write_text(bvh(standing()))
    calls = []
    for owner, method in ((Path, "iterdir"), (Path, "read_text")):
        known = getattr(owner, method)
        monkeypatch.setattr(
            owner,
            method,
            lambda self, *a, k=known, m=method, **b: calls.append(m) or k(self, *a, **b),
        )
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("default")
        for name in names:
            load_clip(tmp_path / name)
    assert len(told) == 1
    assert sorted(calls) == ["iterdir", "read_text"]
    (tmp_path / "overrides.toml").write_text("fps = 60")
    assert load_clip(tmp_path / "0.bvh").fps == 60
    assert sorted(calls) == ["iterdir", "read_text", "read_text"]


def test_hours_of_motion_are_read_and_days_refused(clip):
    with pytest.raises(InputError, match=r"clip\.bvh.* at most 2,000,000 frames .* at 30 a second"):
        clip(bvh([[0, 88, 0, 1, 0, 0]] * 70_000), fps=1)
    check_size(Path("c.bvh"), 3 * 3600 * 30, 31, 30.0)


@pytest.mark.parametrize("fps", [0.5, 20_000, float("nan"), True, "fast"])
def test_no_rate_beyond_a_capture_can_be_given(clip, fps):
    with pytest.raises(InputError, match=r"clip\.bvh: fps: expected"):
        clip(bvh(standing()), fps=fps)


def test_what_is_there_of_a_clip_is_told(clip):
    found = clip(bvh(standing(count=61), fps=60))
    assert (found.name, found.format, found.frames, found.fps) == ("clip", "bvh", 61, 60.0)
    assert (found.seconds, found.joints, len(found.sha256)) == (1.0, 21, 64)
    assert found.roles_missing == ()
    assert set(found.motion.skeleton.roles) == set(ROLES)


def test_unknown_formats_and_missing_files_are_refused(tmp_path):
    (tmp_path / "a.xyz").write_bytes(b"x")
    for name, told in (("a.xyz", "known format"), ("b.bvh", "none")):
        with pytest.raises(InputError, match=told):
            load_clip(tmp_path / name)
