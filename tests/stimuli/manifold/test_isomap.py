"""Embeddings of poses whose dimension is known, beside scikit-learn's; pieces are refused."""

import numpy as np
import pytest

from stimuli.errors import InputError
from stimuli.manifold import Embedding, embed_motions, meetings
from stimuli.manifold.neighbours import nearest_frames, pose_distances, pose_rotations
from stimuli.motion import Motion
from stimuli.motion import quaternions as quat


def posed(bodies, turns: dict[int, np.ndarray]) -> Motion:
    """A standing body of which some joints are turned by half rotation vectors (F, 3)."""
    motion = bodies.standing(len(next(iter(turns.values()))))
    for joint, vectors in turns.items():
        motion.rotations[:, joint] = quat.exp(vectors)
    return motion


def around(angles: np.ndarray, radius: float) -> np.ndarray:
    """Half rotation vectors (F, 3) on a circle."""
    return radius * np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)


def circle(bodies, frames: int = 90) -> Motion:
    return posed(bodies, {3: around(np.arange(frames) * 2 * np.pi / frames, 0.3)})


def swiss_roll(bodies) -> Motion:
    """One joint on a spiral, another along a line: a rolled sheet."""
    rng = np.random.default_rng(4)
    turn, across = 1.5 * np.pi * (1 + 2 * rng.uniform(size=900)), rng.uniform(size=900)
    spiral = around(turn, 1.0) * (0.05 * turn[:, None])
    return posed(bodies, {3: spiral, 6: np.outer(1.4 * across, [1.0, 0.0, 0.0])})


def torus(bodies) -> Motion:
    """Three joints, each on a circle of its own: a torus of three, which is flat in six."""
    angles = np.random.default_rng(2).uniform(0, 2 * np.pi, (3, 1500))
    return posed(bodies, {j: around(a, 0.3) for j, a in zip((3, 6, 9), angles, strict=True)})


def test_a_circle_takes_two_dimensions(bodies) -> None:
    found = embed_motions([circle(bodies)])
    assert found.knee == 2
    assert found.residual[0] > 0.4
    assert found.residual[1] < 0.06  # chords are shorter than arcs
    radius = np.linalg.norm(found.places[:, :2], axis=1)
    assert radius.std() < 0.02 * radius.mean()


def test_a_swiss_roll_of_two_joints_takes_two(bodies) -> None:
    found = embed_motions([swiss_roll(bodies)])
    assert found.residual[0] > 3 * found.residual[1]
    assert found.residual[1] < 0.02
    flat = pose_rotations(found.motions)[:, [2, 5], 1:].reshape(900, -1)
    values = np.linalg.svd(flat - flat.mean(axis=0), compute_uv=False) ** 2
    assert values[2] > 0.1 * values.sum()  # principal components need a third


def test_a_torus_of_three_joints_takes_six(bodies) -> None:
    """It has three dimensions, closed in each: as many circles, each flat in two."""
    found = embed_motions([torus(bodies)], neighbours=10)
    falls = -np.diff(found.residual)
    assert falls[:5].min() > 5 * np.abs(falls[5:]).max()
    assert found.knee == 6


def test_places_are_those_of_scikit_learn(bodies) -> None:
    from sklearn.manifold import Isomap

    motion = bodies.wandering(80, 3)
    ours = embed_motions([motion])
    distances = pose_distances(*[pose_rotations([motion])] * 2)
    np.fill_diagonal(distances, 0.0)
    theirs = Isomap(n_neighbors=7, n_components=4, metric="precomputed", eigen_solver="dense")
    places = theirs.fit_transform(distances)
    signs = np.sign((places * ours.places[:, :4]).sum(axis=0))
    np.testing.assert_allclose(ours.places[:, :4], places * signs, atol=1e-6)


def test_landmarks_place_frames_nearly_as_all_do(bodies) -> None:
    motion = bodies.wandering(500, 3)
    whole = embed_motions([motion])
    some = embed_motions([motion], whole=300)
    assert (whole.landmarks, some.landmarks) == (0, 400)
    np.testing.assert_allclose(some.residual, whole.residual, atol=0.02)
    for column in range(3):
        assert abs(np.corrcoef(whole.places[:, column], some.places[:, column])[0, 1]) > 0.99
    again = embed_motions([motion], whole=300)
    assert np.array_equal(some.places, again.places)


def test_nearest_frames_are_those_of_the_whole_matrix(bodies) -> None:
    poses = pose_rotations([bodies.wandering(600, 5)])
    found, far = nearest_frames(poses, 5)
    whole = pose_distances(poses, poses)
    np.fill_diagonal(whole, np.inf)
    np.testing.assert_allclose(far, np.sort(whole, axis=1)[:, :5], atol=2e-3)
    assert not (found == np.arange(600)[:, None]).any()


def apart(bodies) -> list[Motion]:
    """Two circles of poses, far from each other."""
    far = circle(bodies, 30)
    far.rotations[:, 5] = quat.exp(np.array([0.8, 0.0, 0.0]))
    return [circle(bodies, 40), far]


def test_a_graph_in_pieces_is_refused_with_what_would_join_it(bodies) -> None:
    with pytest.raises(InputError) as refused:
        embed_motions(apart(bodies), ("a", "b"))
    told = str(refused.value)
    assert (
        "found 2 pieces with 7 neighbours: 40 frames, a:0 to a:39; 30 frames, b:0 to b:29" in told
    )
    fewest = int(told.split("--neighbours ")[1].split(",")[0])
    assert embed_motions(apart(bodies), ("a", "b"), neighbours=fewest).neighbours == fewest
    with pytest.raises(InputError, match="2 pieces"):
        embed_motions(apart(bodies), ("a", "b"), neighbours=fewest - 1)


def test_what_cannot_be_embedded_is_refused(bodies) -> None:
    with pytest.raises(InputError, match="expected from 1 to 19 neighbours of each of 20 frames"):
        embed_motions([bodies.wandering(20, 1)], neighbours=20)
    with pytest.raises(InputError, match="expected 12 frames or more, found 5"):
        embed_motions([bodies.wandering(5, 1)])


def test_equal_poses_are_neighbours(bodies) -> None:
    motion = bodies.wandering(40, 1)
    twice = embed_motions([motion, motion], ("a", "b"))
    np.testing.assert_allclose(twice.places[:40], twice.places[40:], atol=1e-5)


def test_curves_that_meet_are_told_with_their_cost(bodies) -> None:
    """The second motion goes over the same poses, half a turn later."""
    found: Embedding = embed_motions(
        [bodies.wandering(120, 1)[:80], bodies.wandering(120, 1)[40:]], ("a", "b")
    )
    nearest = meetings(found, 3)[0]
    assert (nearest.from_clip, nearest.to_clip) == ("a", "b")
    assert abs(nearest.i - nearest.j - 40) <= 1
    assert nearest.cheaper < 0.02
    assert abs(nearest.best[0] - nearest.best[1] - 40) <= 1
