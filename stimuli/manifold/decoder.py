"""Poses back from an embedding by a small feed-forward network (Wang 2005, VII.2.1).

Frames are dealt in blocks of time: to train by, to stop early by, and to test by. A frame's
neighbours in time are nearly its like, so that frames dealt one by one would test nothing.
"""

import copy
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from stimuli.errors import InputError
from stimuli.manifold.embedding import Embedding
from stimuli.manifold.neighbours import pose_rotations
from stimuli.motion import quaternions as quat
from stimuli.motion.quaternions import Array

DEALT = 8  # frames of a block of time
SHARES = {"training": 0.7, "validation": 0.15, "test": 0.15}
LEAST_BLOCKS = 4
HIDDEN = (128, 128)
EPOCHS = 500
PATIENT_FOR = 80  # epochs that the validation error may fail to fall
_RATE = 3e-3  # of learning, halved whenever half of the patience is spent


@dataclass(frozen=True, eq=False)
class PoseDecoder:
    """A network from places in an embedding to joint rotations, and what it was tested by.

    `sets` are the frames of training, validation and test, `epochs` those until the validation
    error was least. `dimensions` columns of the embedding are its input.
    """

    network: Any
    dimensions: int
    centre: Array
    scale: float
    sets: dict[str, np.ndarray]
    epochs: int

    def poses(self, places: Array) -> Array:
        """Rotations (N, J − 1, 4) at places (N, d or more); the root's is no part of them."""
        inputs = (places[:, : self.dimensions] - self.centre) / self.scale
        return rotations_from_axes(self.network.predict(inputs))


def rotations_from_axes(numbers: Array) -> Array:
    """Rotations (N, J, 4) whose turned X and Y axes are (N, 6 J), made orthonormal.

    Six numbers are continuous in a rotation, which fewer than five cannot be (Zhou 2019).
    """
    from scipy.spatial.transform import Rotation

    pairs = numbers.reshape(len(numbers), -1, 2, 3)
    x = pairs[..., 0, :] / np.maximum(quat.norm(pairs[..., 0, :])[..., None], 1e-12)
    y = pairs[..., 1, :] - np.vecdot(x, pairs[..., 1, :])[..., None] * x
    y /= np.maximum(quat.norm(y)[..., None], 1e-12)
    matrices = np.stack([x, y, quat.cross(x, y)], axis=-1)
    xyzw = Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat()
    return quat.continuous(np.roll(xyzw, 1, axis=-1).reshape(*pairs.shape[:2], 4))


def dealt_blocks(starts: np.ndarray, generator: np.random.Generator) -> dict[str, np.ndarray]:
    """The frames of each set, by blocks of at most DEALT frames that never span two clips.

    InputError for fewer than four blocks in all.
    """
    blocks = [
        part
        for first, end in pairwise(starts)
        for part in np.array_split(np.arange(first, end), max(round((end - first) / DEALT), 1))
    ]
    if len(blocks) < LEAST_BLOCKS:
        raise InputError(
            f"decoder: expected {LEAST_BLOCKS * DEALT} frames or more to train and test by, found "
            f"{int(starts[-1])}.\nTake longer clips, or several."
        )
    order = generator.permutation(len(blocks))
    held = [max(round(SHARES[name] * len(blocks)), 1) for name in ("validation", "test")]
    parts = np.split(order, np.cumsum(held))
    sets = dict(zip(("validation", "test", "training"), parts, strict=True))
    return {name: np.concatenate([blocks[n] for n in np.sort(sets[name])]) for name in SHARES}


def train_decoder(embedding: Embedding, dimensions: int, seed: int = 0) -> PoseDecoder:
    """The network of an embedding in so many dimensions, trained until its validation error rises.

    The seed deals the blocks and starts the network.
    """
    from sklearn.neural_network import MLPRegressor

    generator = np.random.default_rng([seed, 1])
    sets = dealt_blocks(embedding.starts, generator)
    places = embedding.places[:, :dimensions]
    centre = places[sets["training"]].mean(axis=0)
    scale = max(float(places[sets["training"]].std(axis=0).max()), 1e-9)
    inputs = (places - centre) / scale
    targets = quat.axes(pose_rotations(embedding.motions)).reshape(len(places), -1)
    train, check = sets["training"], sets["validation"]
    network = MLPRegressor(
        hidden_layer_sizes=HIDDEN, activation="relu", alpha=1e-5, learning_rate_init=_RATE,
        batch_size=min(max(16, len(train) // 32), len(train)),
        random_state=int(generator.integers(2**31)),
    )  # fmt: skip
    best, weights, reached = np.inf, None, 0
    for epoch in range(1, EPOCHS + 1):
        network.partial_fit(inputs[train], targets[train])
        error = float(np.square(network.predict(inputs[check]) - targets[check]).mean())
        if error < best:
            best, reached = error, epoch
            weights = copy.deepcopy((network.coefs_, network.intercepts_))
        elif epoch - reached >= PATIENT_FOR:
            break
        elif epoch - reached == PATIENT_FOR // 2:
            network._optimizer.learning_rate_init *= 0.5
    assert weights is not None, "an error is finite, and less than infinite"
    network.coefs_, network.intercepts_ = weights
    return PoseDecoder(network, dimensions, centre, scale, sets, reached)


def degrees_apart(p: Array, q: Array) -> Array:
    """The angles (...,) between rotations (..., 4), degrees: twice the geodesic distance."""
    return np.degrees(2 * quat.geodesic(p, q))


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """Mean errors over the test frames in degrees, each of all joints and by role.

    Of the network, of the nearest frame in the embedding that it was not tested by, and of the two
    nearest, interpolated.
    """

    errors: dict[str, float]
    roles: dict[str, dict[str, float]]

    @property
    def worse(self) -> bool:
        """Whether the network is worse than the nearest frame."""
        return self.errors["network"] > self.errors["nearest"]

    @property
    def worse_roles(self) -> list[str]:
        """The roles of which it is."""
        return [name for name, e in self.roles.items() if e["network"] > e["nearest"]]


def decoding_errors(decoder: PoseDecoder, embedding: Embedding) -> Reconstruction:
    """How far decoded poses of the test set are from the captured ones, beside what is easier."""
    poses = pose_rotations(embedding.motions)
    test = decoder.sets["test"]
    known = np.concatenate([decoder.sets["training"], decoder.sets["validation"]])
    places = embedding.places[:, : decoder.dimensions]
    first, other, share = two_nearest(places[test], places[known])
    one, two = poses[known[first]], poses[known[other]]
    guesses = {
        "network": decoder.poses(embedding.places[test]),
        "nearest": one,
        "interpolated": quat.slerp(one, two, share[:, None]),
    }
    off = {name: degrees_apart(guess, poses[test]) for name, guess in guesses.items()}
    errors = {name: float(each.mean()) for name, each in off.items()}
    skeleton = embedding.motions[0].skeleton
    roles = {
        role: {name: float(each[:, joint - 1].mean()) for name, each in off.items()}
        for role, joint in sorted(skeleton.roles.items(), key=lambda pair: pair[1])
        if joint > 0
    }
    return Reconstruction(errors, roles)


def two_nearest(at: Array, places: Array) -> tuple[np.ndarray, np.ndarray, Array]:
    """The two nearest of `places` (M, d) to each of `at` (N, d), and where between them each lies.

    (N,) rows each; the share (N,) is 0 at the nearest and 1 at the other.
    """
    far = np.linalg.norm(at[:, None] - places, axis=-1)
    near = np.argsort(far, axis=1, kind="stable")[:, :2]
    one, two = places[near[:, 0]], places[near[:, 1]]
    across = two - one
    length = np.maximum(np.vecdot(across, across), 1e-12)
    return near[:, 0], near[:, 1], np.clip(np.vecdot(at - one, across) / length, 0.0, 1.0)
