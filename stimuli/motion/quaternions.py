"""Unit quaternions (w, x, y, z) on the last axis: pure functions that broadcast over the others.

The logarithm of a unit quaternion is half its rotation vector, so the geodesic distance of the
dissertation (Wang 2005, II.3.2), the norm of a logarithm, is half the angle of rotation.
"""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

IDENTITY: Array = np.array([1.0, 0.0, 0.0, 0.0])
_AXES = {"X": 1, "Y": 2, "Z": 3}
_FEW = 4096  # numbers; below, calls cost more than arithmetic and a bilinear form takes fewest


def multiply(p: Array, q: Array) -> Array:
    """Hamilton product p q, (..., 4): the rotation q, then the rotation p."""
    if p.size + q.size < _FEW:
        return _of_pairs(p, q, _PRODUCT)
    pw, px, py, pz = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    qw, qx, qy, qz = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    product = np.empty(np.broadcast_shapes(p.shape, q.shape))
    product[..., 0] = pw * qw - px * qx - py * qy - pz * qz
    product[..., 1] = pw * qx + px * qw + py * qz - pz * qy
    product[..., 2] = pw * qy - px * qz + py * qw + pz * qx
    product[..., 3] = pw * qz + px * qy - py * qx + pz * qw
    return product


def _bilinear() -> tuple[Array, Array]:
    """The product as a form (16, 4) of component pairs, and the rotation matrix as one (16, 9)."""
    product = np.zeros((4, 4, 4))
    for a, b, c, sign in (
        (0, 0, 0, 1), (1, 1, 0, -1), (2, 2, 0, -1), (3, 3, 0, -1),
        (0, 1, 1, 1), (1, 0, 1, 1), (2, 3, 1, 1), (3, 2, 1, -1),
        (0, 2, 2, 1), (2, 0, 2, 1), (3, 1, 2, 1), (1, 3, 2, -1),
        (0, 3, 3, 1), (3, 0, 3, 1), (1, 2, 3, 1), (2, 1, 3, -1),
    ):  # fmt: skip
        product[a, b, c] = sign
    conjugate = np.diag([1.0, -1.0, -1.0, -1.0])
    matrix = np.einsum("ajx,xby,bc->acyj", product, product, conjugate)[:, :, 1:, 1:]
    return product.reshape(16, 4), matrix.reshape(16, 9)


_PRODUCT, _MATRIX = _bilinear()


def inverse(q: Array) -> Array:
    """Inverse (the conjugate) of unit quaternions, (..., 4)."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def cross(u: Array, v: Array) -> Array:
    """Cross product of vectors, (..., 3)."""
    product = np.empty(np.broadcast_shapes(u.shape, v.shape))
    product[..., 0] = u[..., 1] * v[..., 2] - u[..., 2] * v[..., 1]
    product[..., 1] = u[..., 2] * v[..., 0] - u[..., 0] * v[..., 2]
    product[..., 2] = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return product


def rotate(q: Array, v: Array) -> Array:
    """Vectors v (..., 3) turned by q (..., 4)."""
    if q.size + v.size < _FEW:
        matrices = _of_pairs(q, q, _MATRIX).reshape(*q.shape[:-1], 3, 3)
        return np.asarray(np.vecdot(matrices, v[..., None, :]))
    twice = 2.0 * cross(q[..., 1:], v)
    return v + q[..., :1] * twice + cross(q[..., 1:], twice)


def _of_pairs(p: Array, q: Array, form: Array) -> Array:
    """A bilinear form (16, N) of the components of p and q: (..., N)."""
    products = p[..., :, None] * q[..., None, :]
    values = products.reshape(-1, 16) @ form
    return np.asarray(values.reshape(*products.shape[:-2], form.shape[1]))


def norm(v: Array) -> Array:
    """Lengths (...,) of vectors (..., N): NumPy's norm, at half the price of a call on few."""
    return np.asarray(np.sqrt(np.vecdot(v, v)))


def normalise(q: Array) -> Array:
    """Quaternions (..., 4) scaled to unit length; a zero one becomes the identity."""
    size = norm(q)[..., None]
    return np.where(size > 0, q / np.where(size > 0, size, 1.0), IDENTITY)


def shorter(q: Array) -> Array:
    """Of q and −q, which are one rotation, the one with w ≥ 0 (the shorter arc)."""
    return np.where(q[..., :1] < 0, -q, q)


def log(q: Array) -> Array:
    """Logarithm of unit quaternions, (..., 4) → (..., 3): half the rotation vector, radians."""
    vector = q[..., 1:]
    sine = norm(vector)[..., None]
    angle = np.arctan2(sine, q[..., :1])
    small = sine < 1e-12
    return np.asarray(vector * np.where(small, 1.0, angle / np.where(small, 1.0, sine)))


def exp(v: Array) -> Array:
    """Unit quaternion whose logarithm is v, (..., 3) → (..., 4)."""
    angle = norm(v)[..., None]
    return np.concatenate([np.cos(angle), np.sinc(angle / np.pi) * v], axis=-1)


def geodesic(p: Array, q: Array) -> Array:
    """min(‖log(q⁻¹p)‖, ‖log(−q⁻¹p)‖), (...,): half the angle between two rotations (II.3.2).

    From the chord between them, which keeps its precision where the arc cosine loses it.
    """
    chord = np.minimum(norm(p - q), norm(p + q))
    return np.asarray(2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))


def axes(rotations: Array) -> Array:
    """The turned X and Y axes (..., 6) of rotations (..., 4), which are alike for q and −q."""
    w, x, y, z = (rotations[..., k] for k in range(4))
    return np.stack(
        [
            1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),
            2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
        ],
        axis=-1,
    )  # fmt: skip


def slerp(p: Array, q: Array, weight: Array | float) -> Array:
    """Spherical interpolation on the shorter arc, p at weight 0 and ±q at 1; weight (...,)."""
    weight = np.asarray(weight, dtype=float)[..., None]
    dot = np.vecdot(p, q)[..., None]
    q = np.where(dot < 0, -q, q)
    angle = np.arccos(np.minimum(np.abs(dot), 1.0))
    near = angle < 1e-4
    sine = np.where(near, 1.0, np.sin(angle))
    first = np.where(near, 1.0 - weight, np.sin((1.0 - weight) * angle) / sine)
    second = np.where(near, weight, np.sin(weight * angle) / sine)
    return normalise(first * p + second * q)


def about(axis: str, angle: Array | float) -> Array:
    """Rotation by `angle` (...,) radians about the axis "X", "Y" or "Z"."""
    half = 0.5 * np.asarray(angle, dtype=float)
    q = np.zeros((*half.shape, 4))
    q[..., 0] = np.cos(half)
    q[..., _AXES[axis]] = np.sin(half)
    return q


def from_euler(angles: Array, order: str) -> Array:
    """Intrinsic rotations: angles (..., N) radians about the axes named in `order`, in turn."""
    if len(set(order)) == 3:
        return _tait_bryan(angles, order)
    q = about(order[0], angles[..., 0])
    for place, axis in enumerate(order[1:], start=1):
        q = multiply(q, about(axis, angles[..., place]))
    return q


def _tait_bryan(angles: Array, order: str) -> Array:
    """The product of three rotations about three axes, written out; the parity of `order` signs."""
    i, j, k = (_AXES[axis] for axis in order)
    parity = 1.0 if order in "XYZXY" else -1.0
    cosines, sines = np.cos(0.5 * angles), np.sin(0.5 * angles)
    c1, c2, c3 = cosines[..., 0], cosines[..., 1], cosines[..., 2]
    s1, s2, s3 = sines[..., 0], sines[..., 1], sines[..., 2]
    both, neither, first, second = s1 * s2, c1 * c2, s1 * c2, c1 * s2
    q = np.empty((*angles.shape[:-1], 4))
    q[..., 0] = neither * c3 - parity * (both * s3)
    q[..., i] = first * c3 + parity * (second * s3)
    q[..., j] = second * c3 - parity * (first * s3)
    q[..., k] = neither * s3 + parity * (both * c3)
    return q


def to_zyx(q: Array) -> Array:
    """Intrinsic Z, Y, X angles in radians of q, (..., 3); at gimbal lock the X angle is 0."""
    w, x, y, z = (q[..., k] for k in range(4))
    sine = np.clip(2.0 * (w * y - z * x), -1.0, 1.0)
    locked = np.abs(sine) > 1.0 - 1e-14
    free_z = np.arctan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)
    free_x = np.arctan2(2.0 * (w * x + y * z), w * w - x * x - y * y + z * z)
    # arcsin loses half its digits near ±90 degrees; the other two columns keep them
    cosine = np.hypot(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)
    lock_z = np.arctan2(2.0 * (w * z - x * y), w * w - x * x + y * y - z * z)
    return np.stack(
        [
            np.where(locked, lock_z, free_z),
            np.arctan2(sine, cosine),
            np.where(locked, 0.0, free_x),
        ],
        axis=-1,
    )


def yaw(q: Array) -> Array:
    """Angle (...,) about +Y of the twist of q around the vertical axis, radians."""
    return 2.0 * np.arctan2(q[..., 2], q[..., 0])


def continuous(q: Array) -> Array:
    """Signs chosen along axis 0 so that successive quaternions (F, ..., 4) lie near each other."""
    dots = np.vecdot(q[1:], q[:-1])
    flips = np.cumprod(np.where(dots < 0, -1.0, 1.0), axis=0)
    chosen = q.copy()
    chosen[1:] *= flips[..., None]
    return chosen


def angular_velocity(q: Array) -> Array:
    """log(q[t−1]⁻¹ q[t+1]) / 2 along axis 0, shorter arc, (F, ..., 4) → (F, ..., 3).

    Half-angle radians a frame; one-sided, and then not halved, at the two ends.
    """
    if len(q) < 2:
        return np.zeros((*q.shape[:-1], 3))
    step = np.empty((*q.shape[:-1], 3))
    step[1:-1] = 0.5 * log(shorter(multiply(inverse(q[:-2]), q[2:])))
    step[0] = log(shorter(multiply(inverse(q[0]), q[1])))
    step[-1] = log(shorter(multiply(inverse(q[-2]), q[-1])))
    return step


def linear_velocity(x: Array) -> Array:
    """(x[t+1] − x[t−1]) / 2 along axis 0, one-sided at the two ends; units a frame."""
    return np.gradient(x, axis=0) if len(x) > 1 else np.zeros_like(x)
