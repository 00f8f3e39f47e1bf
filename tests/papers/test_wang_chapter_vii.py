"""Wang 2005, chapter VII.2, "preliminary": what holds of captured motion, and what does not.

Held: the residual variance of walks falls to a knee and stays (Fig. VII.2), their curves wind once
a cycle and close (Fig. VII.3), a dance falls slowly (Fig. VII.5), training is to be stopped early
(VII.2.1). Not held: the knee of a walk is at two dimensions, not three, since one cycle is a closed
curve, which is flat in two; the network's in-between frames are no nearer to captured ones than two
captured frames interpolated, and motion along straight ways is far less natural (VII.2.2).
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from stimuli.manifold import (
    Embedding,
    PoseDecoder,
    decoding_errors,
    embed_motions,
    resequenced,
    train_decoder,
)
from stimuli.manifold.decoder import EPOCHS
from stimuli.motion import Library, Motion
from stimuli.naturalness import score_motion
from stimuli.transition.plants import contacts, spans
from tests.conftest import of_captured

SAMPLE_WALKS = ("humanoid3d_walk", "0walk_forward", "turn_left0", "turn_right1")
CMU_WALKS = ("07_03", "16_15", "35_03")  # 104, 118 and 107 frames: his had 120


@pytest.fixture(scope="module")
def sample(sample_motions: Path) -> Library:
    return Library([sample_motions])


@pytest.fixture(scope="module")
def cmu(motions: Path) -> dict[str, Embedding]:
    library = Library([motions / "cmu_bvh"])
    return {
        name: embed_motions([library.load(name).motion], (name,)) for name in (*CMU_WALKS, "05_02")
    }


def is_a_walks(residual: np.ndarray) -> bool:
    """Near .45 to .51, .05 and .06 in one, two and three dimensions."""
    return (
        0.4 < residual[0] < 0.56 and 0.03 < residual[1] < 0.065 and abs(residual[2] - 0.05) < 0.015
    )


def windings(found: Embedding) -> float:
    """How often a curve goes around its middle in its first two dimensions."""
    at = found.places[:, :2] - found.places[:, :2].mean(axis=0)
    angle = np.unwrap(np.arctan2(at[:, 1], at[:, 0]))
    return float(abs(angle[-1] - angle[0]) / (2 * np.pi))


def cycles(motion: Motion) -> list[tuple[int, int]]:
    """First and last frame of whole cycles: from one plant of the left foot to its next."""
    begun = [first for first, _ in spans(contacts(motion).stands[:, 0]) if first > 0]
    return list(pairwise(begun))


@pytest.mark.parametrize("name", SAMPLE_WALKS)
def test_the_residual_variance_of_a_sample_walk_fig_vii_2(sample: Library, name: str) -> None:
    found = embed_motions([sample.load(name).motion])
    assert is_a_walks(found.residual)
    assert found.knee == 2  # his is at three
    assert np.ptp(found.residual[2:]) < 0.015  # behind it nothing more is won


@pytest.mark.parametrize("name", of_captured(CMU_WALKS))
def test_the_residual_variance_of_a_captured_walk_fig_vii_2(
    cmu: dict[str, Embedding], name: str
) -> None:
    found = cmu[name]
    assert found.neighbours == 7
    assert is_a_walks(found.residual)
    assert found.knee == 2


@pytest.mark.parametrize("name", of_captured(CMU_WALKS))
def test_a_walk_winds_once_a_cycle_fig_vii_3(cmu: dict[str, Embedding], name: str) -> None:
    """The three circles of a walk of three cycles, counted."""
    found = cmu[name]
    period = np.mean([last - first for first, last in cycles(found.motions[0])])
    assert windings(found) == pytest.approx((len(found.places) - 1) / period, abs=0.25)


@pytest.mark.parametrize("name", of_captured(CMU_WALKS))
def test_a_period_closes_fig_vii_3(cmu: dict[str, Embedding], name: str) -> None:
    """The first frame of a cycle has none nearer, but those around it in time, than its last."""
    found = cmu[name]
    for first, last in cycles(found.motions[0]):
        at = found.places[first : last + 1, :3]
        far = np.linalg.norm(at - at[0], axis=1)
        nearest = 5 + int(np.argmin(far[5:]))
        assert last - first - nearest <= 2
        assert far[-1] < 0.25 * far.max()


def test_a_sample_walk_closes(sample: Library) -> None:
    """A loop's first and last frame are among each other's seven neighbours."""
    for name in SAMPLE_WALKS:
        at = embed_motions([sample.load(name).motion]).places[:, :3]
        for one, other in ((0, -1), (-1, 0)):
            far = np.linalg.norm(at - at[one], axis=1)
            assert (far < far[other]).sum() <= 7


@pytest.mark.parametrize("name", of_captured(["05_02"]))
def test_a_dance_has_no_clear_knee_fig_vii_5(cmu: dict[str, Embedding], name: str) -> None:
    """A third dimension halves what two leave, a fourth takes more; a walk gains by neither."""
    dance = cmu[name].residual
    assert dance[2] < 0.5 * dance[1]
    assert dance[3] < 0.8 * dance[2]
    for walk in CMU_WALKS:
        assert cmu[walk].residual[2] > cmu[walk].residual[1]


@pytest.fixture(scope="module")
def decoded(cmu: dict[str, Embedding]) -> tuple[Embedding, PoseDecoder]:
    return cmu["16_15"], train_decoder(cmu["16_15"], 3)


@pytest.mark.usefixtures("motions")
def test_training_is_stopped_when_the_validation_error_rises_vii_2_1(decoded) -> None:
    _, decoder = decoded
    assert decoder.epochs < EPOCHS


@pytest.mark.usefixtures("motions")
def test_the_network_estimates_no_better_than_two_captured_frames_vii_2_2(
    cmu: dict[str, Embedding], decoded
) -> None:
    """Its error beside that of the two nearest frames, interpolated, on blocks not trained by.

    Of 15 clips by 2 seeds it was smaller than the nearest frame's in 18 cases of 30 (median ratio
    .97) and larger than the interpolated one's in 17 (1.03).
    """
    ratios = []
    for name in CMU_WALKS:
        decoder = decoded[1] if name == "16_15" else train_decoder(cmu[name], 3)
        errors = decoding_errors(decoder, cmu[name]).errors
        assert errors["interpolated"] < errors["nearest"]
        assert 0.6 < errors["network"] / errors["nearest"] < 1.5
        ratios.append(errors["network"] / errors["interpolated"])
    assert 0.8 < np.mean(ratios) < 1.25


@pytest.mark.usefixtures("motions")
def test_resequenced_motion_is_less_natural_than_captured_vii_2_2(decoded) -> None:
    """Straight ways cross the inside of the circle, where no captured pose is: the body is pushed
    out of balance. "The current results need further improvement", as he has it."""
    embedding, decoder = decoded
    captured = score_motion(embedding.motions[0]).score
    scores = [
        score_motion(resequenced(embedding, decoder, 150, np.random.default_rng(n)).motion).score
        for n in range(4)
    ]
    assert captured is not None
    assert np.median([score for score in scores if score is not None]) > 3 * captured
