"""The hierarchy of edges, compiled: connected groups, k-means, binary trees (section 4.1).

Points are edges of one ordered pair of clips, as (frame left, frame entered), in order of both.
"""

import numpy as np

from stimuli.compiled import compiled, inlined
from stimuli.graph.arrays import Rows
from stimuli.motion.quaternions import Array

_ROUNDS = 20  # of k-means at most
_HALVINGS = 10  # rounds of 2-means


@inlined
def _root(above: Rows, point: int) -> int:
    while above[point] != point:
        above[point] = above[above[point]]
        point = above[point]
    return point


@compiled(nogil=True)
def groups(x: Rows, y: Rows) -> Rows:
    """The connected group (E,) of each point by 8 neighbours, numbered in order of first points."""
    above = np.arange(len(x))
    before = 0  # the first point of the row before
    row = 0  # the first point of this row
    for n in range(len(x)):
        if n and x[n] != x[n - 1]:
            before, row = row, n
        if n > row and y[n] == y[n - 1] + 1:
            above[_root(above, n)] = _root(above, n - 1)
        if row > 0 and x[before] == x[n] - 1:
            while before < row and y[before] < y[n] - 1:
                before += 1
            beside = before
            while beside < row and y[beside] <= y[n] + 1:
                above[_root(above, beside)] = _root(above, n)
                beside += 1
            if before == row:
                before = row - 1
    named = np.full(len(x), -1)
    group = np.empty(len(x), np.int64)
    count = 0
    for n in range(len(x)):
        root = _root(above, n)
        if named[root] < 0:
            named[root] = count
            count += 1
        group[n] = named[root]
    return group


@inlined
def _moments(x: Rows, y: Rows, points: Rows) -> tuple[float, float, float, float, float]:
    """Means of x and y, and the covariance's xx, xy, yy."""
    mx = my = 0.0
    for p in points:
        mx += x[p]
        my += y[p]
    mx /= len(points)
    my /= len(points)
    xx = xy = yy = 0.0
    for p in points:
        dx, dy = x[p] - mx, y[p] - my
        xx += dx * dx
        xy += dx * dy
        yy += dy * dy
    return mx, my, xx / len(points), xy / len(points), yy / len(points)


@compiled(nogil=True)
def clusters_wanted(x: Rows, y: Rows, points: Rows) -> int:
    """⌈√(major · minor)⌉: axes in frames of the ellipse that fits a group, each one at least.

    A filled ellipse is four standard deviations long on each of its axes.
    """
    _, _, xx, xy, yy = _moments(x, y, points)
    middle, apart = 0.5 * (xx + yy), np.sqrt(0.25 * (xx - yy) ** 2 + xy * xy)
    major = max(4.0 * np.sqrt(max(middle + apart, 0.0)), 1.0)
    minor = max(4.0 * np.sqrt(max(middle - apart, 0.0)), 1.0)
    return min(int(np.ceil(np.sqrt(major * minor) - 1e-9)), len(points))


@compiled(nogil=True)
def k_means(x: Rows, y: Rows, points: Rows, count: int) -> Rows:
    """The cluster (P,) of each point; fewer than `count` where some would be empty.

    Begun at points that lie far from those taken before (farthest first), from the first one on.
    """
    n = len(points)
    cx, cy = np.empty(count), np.empty(count)
    cluster = np.zeros(n, np.int64)
    if count < 2:
        return cluster
    far = np.full(n, np.inf)
    chosen = 0
    for c in range(count):
        cx[c], cy[c] = x[points[chosen]], y[points[chosen]]
        most = -1.0
        for k in range(n):
            away = (x[points[k]] - cx[c]) ** 2 + (y[points[k]] - cy[c]) ** 2
            far[k] = min(far[k], away)
            if far[k] > most:
                most, chosen = far[k], k
    for _ in range(_ROUNDS):
        changed = _assigned(x, y, points, cx, cy, cluster)
        sums = np.zeros((count, 3))
        for k in range(n):
            sums[cluster[k], 0] += x[points[k]]
            sums[cluster[k], 1] += y[points[k]]
            sums[cluster[k], 2] += 1
        for c in range(count):
            if sums[c, 2]:
                cx[c], cy[c] = sums[c, 0] / sums[c, 2], sums[c, 1] / sums[c, 2]
        if not changed:
            break
    return cluster


@compiled(nogil=True)
def _assigned(x: Rows, y: Rows, points: Rows, cx: Array, cy: Array, cluster: Rows) -> bool:
    """Each point to the nearest centre, the first of equal ones; whether any moved."""
    changed = False
    for k in range(len(points)):
        px, py = float(x[points[k]]), float(y[points[k]])
        best, least = 0, np.inf
        for c in range(len(cx)):
            away = (px - cx[c]) ** 2 + (py - cy[c]) ** 2
            if away < least:
                best, least = c, away
        if best != cluster[k]:
            cluster[k] = best
            changed = True
    return changed


@compiled(nogil=True)
def halved(x: Rows, y: Rows, points: Rows) -> int:
    """Puts one half by 2-means before the other, in place; how many points the first half has."""
    n = len(points)
    mx, my, xx, xy, yy = _moments(x, y, points)
    angle = 0.5 * np.arctan2(2.0 * xy, xx - yy)
    ax, ay = np.cos(angle), np.sin(angle)
    side = np.empty(n, np.bool_)
    for k in range(n):
        side[k] = (x[points[k]] - mx) * ax + (y[points[k]] - my) * ay > 0.0
    for _ in range(_HALVINGS):
        sums = np.zeros((2, 3))
        for k in range(n):
            sums[int(side[k]), 0] += x[points[k]]
            sums[int(side[k]), 1] += y[points[k]]
            sums[int(side[k]), 2] += 1
        if sums[0, 2] == 0 or sums[1, 2] == 0:
            break
        x0, y0 = sums[0, 0] / sums[0, 2], sums[0, 1] / sums[0, 2]
        x1, y1 = sums[1, 0] / sums[1, 2], sums[1, 1] / sums[1, 2]
        changed = False
        for k in range(n):
            px, py = x[points[k]], y[points[k]]
            over = (px - x1) ** 2 + (py - y1) ** 2 < (px - x0) ** 2 + (py - y0) ** 2
            changed |= over != side[k]
            side[k] = over
        if not changed:
            break
    first = n - int(np.sum(side))
    if first in (0, n):
        return n // 2
    kept = points.copy()
    low, high = 0, first
    for k in range(n):
        if side[k]:
            points[high] = kept[k]
            high += 1
        else:
            points[low] = kept[k]
            low += 1
    return first


@compiled(nogil=True)
def grow(
    x: Rows, y: Rows, cost: Array, points: Rows, base: int,
    labels: Array, right: Rows, middle: Rows, leaf: Rows,
) -> int:  # fmt: skip
    """Writes the tree of a cluster from node `base` on, in pre-order; the node after its last.

    Labels (from, to, cost) are means of the leaves below; `right` is 0 for a leaf, else the second
    child, the first being the next node; `middle` is the point nearest to the label, `leaf` the
    node of each point.
    """
    stack = np.empty((len(points) + 2, 3), np.int64)
    stack[0] = (0, len(points), -1)
    depth, node = 1, base
    while depth:
        depth -= 1
        start, stop, parent = stack[depth]
        if parent >= 0:
            right[parent] = node
        part = points[start:stop]
        mx = my = mc = 0.0
        for p in part:
            mx += x[p]
            my += y[p]
            mc += cost[p]
        count = stop - start
        labels[node] = (mx / count, my / count, mc / count)
        middle[node] = _nearest(x, y, part, mx / count, my / count)
        if count == 1:
            right[node] = 0
            leaf[part[0]] = node
        else:
            split = start + halved(x, y, part)
            stack[depth] = (split, stop, node)
            stack[depth + 1] = (start, split, -1)
            depth += 2
        node += 1
    return node


@compiled(nogil=True)
def _nearest(x: Rows, y: Rows, points: Rows, mx: float, my: float) -> int:
    """The point nearest to a place, the first of equal ones."""
    best, least = points[0], np.inf
    for p in points:
        away = (x[p] - mx) ** 2 + (y[p] - my) ** 2
        if away < least or (away == least and p < best):
            best, least = p, away
    return best


@compiled(nogil=True)
def forest(x: Rows, y: Rows, cost: Array, pairs: Rows) -> tuple[Array, Rows, Rows, Rows, Rows]:
    """All trees of edges that leave a clip, whose pairs begin at `pairs` (P + 1,).

    Labels (M, 3), `right` (M,), the leaf (M,) nearest to each node's label, roots, and of which
    pair each root is.
    """
    edges = len(x)
    labels = np.empty((2 * edges, 3))
    right, middle = np.zeros(2 * edges, np.int64), np.empty(2 * edges, np.int64)
    leaf = np.empty(edges, np.int64)
    roots, of_pair = np.empty(edges, np.int64), np.empty(edges, np.int64)
    node = count = 0
    for pair in range(len(pairs) - 1):
        first, stop = pairs[pair], pairs[pair + 1]
        group = groups(x[first:stop], y[first:stop])
        order = np.argsort(group, kind="mergesort") + first
        start = 0
        while start < len(order):
            end = start
            while end < len(order) and group[order[end] - first] == group[order[start] - first]:
                end += 1
            points = order[start:end]
            wanted = clusters_wanted(x, y, points)
            cluster = k_means(x, y, points, wanted)
            by_cluster = np.argsort(cluster, kind="mergesort")
            low = 0
            while low < len(points):
                high = low
                while high < len(points) and cluster[by_cluster[high]] == cluster[by_cluster[low]]:
                    high += 1
                roots[count], of_pair[count] = node, pair
                count += 1
                inside = points[by_cluster[low:high]]
                node = grow(x, y, cost, inside, node, labels, right, middle, leaf)
                low = high
            start = end
    for n in range(node):
        middle[n] = leaf[middle[n]]
    return labels[:node], right[:node], middle[:node], roots[:count], of_pair[:count]
