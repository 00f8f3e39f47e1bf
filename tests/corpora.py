"""Captured motions that claims are tested on: the sample motions always, others where they lie.

The sample motions are fetched by `make test`; loops among them are played on for some seconds. What
lies in `../shared/motions` has licences under which it is not passed on.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType

from stimuli.motion import Library, Motion, unroll, user_library
from tests.conftest import SHARED

LOOPED = 240  # frames that a loop is played for, eight seconds


@dataclass(frozen=True)
class Corpus:
    """Clips of some folders by name, and groups of them; clips of a group can be joined."""

    folders: tuple[Path, ...]
    groups: Mapping[str, tuple[str, ...]]

    @cached_property
    def _library(self) -> Library:
        return Library(self.folders)

    @cached_property
    def _played(self) -> dict[str, Motion]:
        return {}

    def __getitem__(self, name: str) -> Motion:
        """A motion without ends in reach: a loop played on, another as it is."""
        if name not in self._played:
            motion = self._library.load(str(name)).motion
            self._played[name] = unroll(motion, 0, LOOPED)[0][:LOOPED] if motion.loop else motion
        return self._played[name]

    def motions(self, group: str) -> list[Motion]:
        """The motions of a group, in its order."""
        return [self[name] for name in self.groups[group]]

    def pairs(self, group: str) -> list[tuple[Motion, Motion]]:
        """Each motion of a group with the next."""
        return list(pairwise(self.motions(group)))


SAMPLE = Corpus(
    (user_library(),),
    MappingProxyType(
        {
            "walks": ("0walk_forward", "humanoid3d_walk", "turn_left0", "turn_left1",
                      "turn_right0", "turn_right1"),
            "runs": ("humanoid3d_run", "humanoid3d_walk"),
            "turning walks": ("turn_left0", "turn_left1", "turn_right0", "turn_right1"),
            "turning runs": ("humanoid3d_run", "turn_left0", "turn_right1"),
            "standing and crouching": ("humanoid3d_getup_faceup", "0walk_forward",
                                       "humanoid3d_getup_facedown"),
            "pairs of walks": ("0walk_forward", "humanoid3d_walk", "turn_left0", "turn_left1",
                               "turn_right0", "turn_right1"),
            "locomotion": ("0walk_forward", "humanoid3d_walk", "turn_left0", "turn_left1",
                           "turn_right0", "turn_right1"),
            "dances": ("humanoid3d_dance_a", "humanoid3d_spin", "humanoid3d_spinkick",
                       "humanoid3d_dance_b"),
        }
    ),
)  # fmt: skip
CAPTURED = Corpus(
    (SHARED / "cmu_bvh", SHARED / "accad_male1_bvh"),
    MappingProxyType(
        {
            "walks": ("35_01", "35_02", "35_03", "35_04", "35_28", "16_15", "16_16", "16_21",
                      "16_31", "16_58"),
            "runs": ("35_17", "35_18", "35_19", "35_20", "09_01", "09_02", "09_03", "09_04",
                     "09_05", "09_06"),
            "turning walks": tuple(f"Male1_{name}" for name in (
                "B1_StandToWalk", "B2_WalkToStand", "B3_Walk", "B9_WalkToTurnLeft90",
                "B10_WalkTurnLeft45", "B12_WalkTurnRight90", "B13_WalkTurnRight45",
                "B15_WalkTurnAround",
            )),
            "turning runs": tuple(f"Male1_{name}" for name in (
                "C01_StandToRun", "C02_RunToStand", "C03_Run", "C04_RunToWalk", "C05_WalkToRun",
                "C12_RunTurnLeft45", "C15_RunTurnRight45", "C17_RunTurnAround",
            )),
            "standing and crouching": ("Male1_B3_Walk", "Male1_A2_Sway", "Male1_A4_LookAround",
                                       "Male1_B2_WalkToStand", "Male1_A1_Stand",
                                       "Male1_B24_WalkToCrouch", "Male1_A5_PickUpBox"),
            "pairs of cmu": ("05_01", "06_01", "07_03", "07_04", "07_06", "08_03", "16_15",
                             "16_16", "16_31", "35_02", "35_03", "35_04", "35_28", "32_01",
                             "32_02"),
            "pairs of accad": (
                "Male1_B1_StandToWalk", "Male1_B3_Walk", "Male1_B2_WalkToStand",
                "Male1_B15_WalkTurnAround", "Male1_B9_WalkToTurnLeft90",
                "Male1_B12_WalkTurnRight90", "Male1_C17_RunTurnAround", "Male1_C05_WalkToRun",
                "Male1_C04_RunToWalk",
            ),
            "locomotion": ("35_01", "35_02", "35_03", "35_04", "16_15", "16_16", "08_01", "08_02",
                           "07_01", "07_02"),
            "dances": ("05_02", "05_06", "05_10", "05_13"),
        }
    ),
)  # fmt: skip
CORPORA: Mapping[str, Corpus] = MappingProxyType(
    {"sample": SAMPLE} | ({"captured": CAPTURED} if SHARED.is_dir() else {})
)
