"""The way back to poses: blocks of time, the test beside nearest frames, motion along ways."""

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.manifold import (
    Embedding,
    PoseDecoder,
    along_way,
    decoding_errors,
    embed_motions,
    passing,
    resequenced,
    straight_way,
    train_decoder,
)
from stimuli.manifold.decoder import (
    DEALT,
    dealt_blocks,
    degrees_apart,
    rotations_from_axes,
    two_nearest,
)
from stimuli.manifold.neighbours import pose_rotations
from stimuli.motion import Motion, forward
from stimuli.motion import quaternions as quat
from stimuli.transition import METHODS, transition
from stimuli.transition.route import Piece, Route


def swinging(bodies, frames: int, phase: float = 0.0) -> Motion:
    """A body whose arms and legs swing, two and a half seconds a cycle, as it walks on."""
    motion = bodies.standing(frames)
    angle = 2 * np.pi * np.arange(frames) / 37.3 + phase
    for joint, size, late in ((4, 0.3, 0.0), (7, 0.25, 1.0), (9, 0.3, 2.0), (12, 0.3, 4.0)):
        turns = size * np.stack([np.cos(angle + late), 0 * angle, np.sin(angle)], axis=1)
        motion.rotations[:, joint] = quat.exp(turns)
    motion.root[:, 2] = 0.03 * np.arange(frames)
    return motion


@pytest.fixture(scope="module")
def trained(bodies) -> tuple[Embedding, PoseDecoder]:
    embedding = embed_motions([swinging(bodies, 150)], ("swing",))
    return embedding, train_decoder(embedding, 3, seed=1)


def test_blocks_of_time_are_dealt_whole() -> None:
    sets = dealt_blocks(np.array([0, 90, 150]), np.random.default_rng(0))
    assert sorted(np.concatenate(list(sets.values()))) == list(range(150))
    assert len(sets["training"]) > 90
    for frames in sets.values():
        runs = np.split(frames, np.flatnonzero(np.diff(frames) != 1) + 1)
        assert min(map(len, runs)) >= DEALT - 2
    with pytest.raises(InputError, match="expected 32 frames or more to train and test by"):
        dealt_blocks(np.array([0, 20]), np.random.default_rng(0))


def test_rotations_come_back_from_their_axes() -> None:
    turns = quat.exp(np.random.default_rng(3).normal(0, 1, (7, 4, 3)))
    numbers = 1.7 * quat.axes(turns).reshape(7, -1)
    assert degrees_apart(rotations_from_axes(numbers), turns).max() < 1e-5


def test_the_two_nearest_are_weighed_by_where_between_them_a_place_lies() -> None:
    places = np.array([[0.0, 0.0], [4.0, 0.0], [9.0, 9.0]])
    first, other, share = two_nearest(np.array([[1.0, 0.5], [-1.0, 0.0]]), places)
    assert list(first) == [0, 0]
    assert list(other) == [1, 1]
    assert share == pytest.approx([0.25, 0.0])


def test_a_plain_cycle_is_decoded_to_a_few_degrees(trained) -> None:
    embedding, decoder = trained
    quality = decoding_errors(decoder, embedding)
    assert quality.errors["network"] < 2.0
    assert quality.errors["interpolated"] < quality.errors["nearest"] < 2.0
    role = quality.roles["left_hip"]
    assert set(role) == {"network", "nearest", "interpolated"}
    assert quality.worse == (quality.errors["network"] > quality.errors["nearest"])
    worse = [n for n, e in quality.roles.items() if e["network"] > e["nearest"]]
    assert quality.worse_roles == worse


def test_a_seed_is_one_network(bodies, trained) -> None:
    embedding, decoder = trained
    again = train_decoder(embedding, 3, seed=1)
    assert again.epochs == decoder.epochs
    assert np.array_equal(again.poses(embedding.places), decoder.poses(embedding.places))
    other = dealt_blocks(embedding.starts, np.random.default_rng([2, 1]))
    assert not np.array_equal(other["test"], decoder.sets["test"])


def test_resequenced_motion_goes_on_at_the_motions_own_speed(trained) -> None:
    embedding, decoder = trained
    made = resequenced(embedding, decoder, 100, np.random.default_rng(5))
    assert len(made.motion) == 100
    step = embedding.step(3)
    gone = np.linalg.norm(np.diff(made.places, axis=0), axis=1)
    assert gone.max() < step + 1e-9  # a corner is cut, nothing is faster
    assert np.median(gone) == pytest.approx(step)
    assert made.places[0] == pytest.approx(embedding.places[made.stops[0], :3])
    assert np.linalg.norm(quat.norm(made.motion.rotations) - 1) < 1e-9
    on_floor = np.diff(made.motion.root, axis=0)[:, [0, 2]]
    assert np.linalg.norm(on_floor, axis=1) == pytest.approx(0.03, abs=0.004)
    again = resequenced(embedding, decoder, 100, np.random.default_rng(5))
    assert np.array_equal(again.motion.root, made.motion.root)
    with pytest.raises(InputError, match="expected 4 to 3600 frames, found 2"):
        resequenced(embedding, decoder, 2, np.random.default_rng(5))


def test_the_motion_itself_comes_back_along_its_own_curve(trained) -> None:
    embedding, decoder = trained
    motion = along_way(embedding, decoder, embedding.places[:, :3], lock=False)
    off = degrees_apart(motion.rotations[:, 1:], pose_rotations(embedding.motions))
    assert off.mean() < 1.5
    gone = motion.root[-1] - motion.root[0]
    assert np.linalg.norm(gone) == pytest.approx(0.03 * 149, rel=0.01)


def test_a_straight_way_is_as_long_as_the_speed_has_it(trained) -> None:
    embedding, _ = trained
    way = straight_way(embedding, 3, 10, 28)
    far = np.linalg.norm(embedding.places[28, :3] - embedding.places[10, :3])
    assert len(way) - 1 == round(far / embedding.step(3))
    assert way[[0, -1]] == pytest.approx(embedding.places[[10, 28], :3])


@pytest.mark.parametrize("alone", [True, False], ids=["one motion", "two motions"])
def test_the_method_manifold_leaves_a_at_i_and_reaches_b_at_j(bodies, alone: bool) -> None:
    a = swinging(bodies, 120)
    b = a if alone else swinging(bodies, 110, phase=0.4)
    route = passing(a, b, 50, 70)
    assert METHODS["manifold"].through == "embedding"
    done = transition(a, b, 50, 70, method="manifold", route=route)
    assert done.frames == route.frames
    assert np.array_equal(done.motion.rotations[:51], a.rotations[:51])
    assert len(done.motion) == 51 + route.frames + len(b) - 71
    tail = len(done.motion) - done.mixed[1] - 1
    assert np.allclose(
        done.motion.rotations[len(done.motion) - tail :, 1:], b.rotations[len(b) - tail :, 1:]
    )
    positions, _ = forward(done.motion.skeleton, done.motion.rotations, done.motion.root)
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=1)
    assert steps[48 : done.mixed[1] + 2].max() < 2.5 * steps[:48].max()


def test_manifold_says_what_it_lacks(bodies) -> None:
    a = swinging(bodies, 60)
    with pytest.raises(InputError, match="manifold: expected a way through the embedding"):
        transition(a, a, 20, 30, method="manifold")
    with pytest.raises(InputError, match="manifold: expected no length"):
        transition(a, a, 20, 30, method="manifold", frames=10)
    with pytest.raises(InputError, match="expected a frame of B from 1 on, found 0"):
        passing(a, a, 20, 0)
    route = Route("A", 20, 30, (Piece("B", a, 30, 30),), 0.0)
    with pytest.raises(InputError, match="manifold: expected the specification start-end"):
        transition(a, a, 20, 30, method="manifold", specification="center-aligned", route=route)
