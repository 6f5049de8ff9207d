"""In which order to eliminate nodes, so that little fills in.

Nested dissection (George 1973): a set of nodes that separates a body into two halves is eliminated last, each half is
ordered in the same way. A body is cut across a coordinate, at one of a few shares of its nodes; the smallest set of
nodes that touches every cut edge is the separator: a least vertex cover of a bipartite graph, by Koenig's theorem from
a largest matching (Pothen, Simon and Liou 1990). Of all cuts that with the smallest ratio of the separator to the
product of the halves is taken. Small parts are ordered by minimum degree, which counts the separators around them too.

Without coordinates, distances in the graph from a few far-apart nodes serve as such (Harel and Koren 2002).

A graph is (starts, neighbours): those of node i are neighbours[starts[i]:starts[i + 1]], itself left out.
"""

from typing import no_type_check

import numpy as np
from numba import njit


@njit(cache=True)
@no_type_check
def block_graph(indptr, indices, dim):
    """Which nodes share an entry of a matrix with `dim` degrees of freedom a node."""
    count = (len(indptr) - 1) // dim
    starts = np.zeros(count + 1, np.int64)
    neighbours = np.empty(len(indices), np.int64)
    seen = np.full(count, -1, np.int64)
    filled = 0
    for node in range(count):
        seen[node] = node
        for entry in range(indptr[node * dim], indptr[(node + 1) * dim]):
            other = indices[entry] // dim
            if seen[other] != node:
                seen[other] = node
                neighbours[filled] = other
                filled += 1
        starts[node + 1] = filled
    return starts, neighbours[:filled].copy()


@njit(cache=True)
@no_type_check
def graph_coordinates(starts, neighbours, count):
    """Distances in the graph from `count` nodes, each the farthest from those before it, (nodes, count)."""
    nodes = len(starts) - 1
    coordinates = np.empty((nodes, count))
    nearest = np.full(nodes, np.inf)
    root = _farthest(_distances(starts, neighbours, 0))
    for column in range(count):
        distances = _distances(starts, neighbours, root)
        coordinates[:, column] = distances
        nearest = np.minimum(nearest, distances)
        root = _farthest(nearest)
    return coordinates


@njit(cache=True)
@no_type_check
def _farthest(distances):
    """The node of largest distance."""
    return np.argmax(distances)


@njit(cache=True)
@no_type_check
def _distances(starts, neighbours, root):
    """Edges between each node and `root`; more than there can be where no path leads."""
    nodes = len(starts) - 1
    distances = np.full(nodes, float(nodes))
    queue = np.empty(nodes, np.int64)
    distances[root] = 0.0
    queue[0] = root
    head, tail = 0, 1
    while head < tail:
        node = queue[head]
        head += 1
        for entry in range(starts[node], starts[node + 1]):
            other = neighbours[entry]
            if distances[other] == nodes:
                distances[other] = distances[node] + 1.0
                queue[tail] = other
                tail += 1
    return distances


@njit(cache=True)
@no_type_check
def nested_dissection(starts, neighbours, points, leaf, shares):
    """Order of elimination, (nodes,): the node to eliminate first, second, ...

    Parts of up to `leaf` nodes are not cut. `shares` are the parts of the nodes that a cut may leave on one side; it
    runs across a coordinate, a column of `points`.
    """
    nodes, axes = points.shape
    order = np.arange(nodes)
    place = np.arange(nodes)
    mate = np.full(nodes, -1, np.int64)
    parent = np.full(nodes, -1, np.int64)
    bit = np.full(nodes, -1, np.int64)
    side = np.zeros(nodes, np.int8)
    todo = np.zeros((nodes + 1, 2), np.int64)
    todo[0, 1] = nodes
    waiting = 1
    while waiting > 0:
        waiting -= 1
        low, high = todo[waiting]
        if high - low > leaf:
            part = order[low:high].copy()
            best, least = side[:0], np.inf
            for axis in range(axes):
                for share in shares:
                    sides, size = _separator(starts, neighbours, part, points[:, axis], share, mate, parent, side)
                    near = np.sum(sides == 1)
                    far = len(part) - near - size
                    if near > 0 and far > 0 and size / (float(near) * far) < least:
                        best, least = sides, size / (float(near) * far)
            if len(best) > 0 and np.sum(best == 3) < 0.4 * len(part):
                ends = _arrange(order, place, part, best, points, low)
                todo[waiting, 0], todo[waiting, 1] = low, ends[0]
                todo[waiting + 1, 0], todo[waiting + 1, 1] = ends[0], ends[1]
                waiting += 2
                continue
        if high > low:
            _minimum_degree(starts, neighbours, order, place, low, high, bit)
    return order


@njit(cache=True)
@no_type_check
def _separator(starts, neighbours, part, values, share, mate, parent, side):
    """Side of each node of `part` (1, 2; 3 on the separator) where `share` of them is cut off; the separator's size.

    `mate` and `parent` are -1 and `side` 0 everywhere before and after.
    """
    ranks = np.argsort(values[part])
    half = int(len(part) * share)
    for rank in range(len(part)):
        side[part[ranks[rank]]] = 1 if rank < half else 2
    queue = np.empty(len(part), np.int64)
    touched = np.empty(len(part), np.int64)
    border = np.empty(len(part), np.int64)
    bordering = 0
    for node in part:
        if side[node] == 1:
            for entry in range(starts[node], starts[node + 1]):
                if side[neighbours[entry]] == 2:
                    border[bordering] = node
                    bordering += 1
                    break
    border = border[:bordering]
    for node in border:
        for entry in range(starts[node], starts[node + 1]):
            other = neighbours[entry]
            if side[other] == 2 and mate[other] < 0:
                mate[other], mate[node] = node, other
                break
    for node in border:
        if mate[node] < 0:
            queue[0] = node
            reached = _alternate(starts, neighbours, side, mate, parent, queue, 1, touched, True)
            for position in range(reached):
                parent[touched[position]] = -1
    free = 0
    for node in border:
        if mate[node] < 0:
            queue[free] = node
            free += 1
    reached = _alternate(starts, neighbours, side, mate, parent, queue, free, touched, False)
    size = 0
    for node in border:
        if mate[node] >= 0:
            size += 1
            # Cover: on the far side what an alternating path from a free node reaches, on the near side the rest.
            if parent[mate[node]] >= 0:
                side[mate[node]] = 3
            else:
                side[node] = 3
    sides = side[part]
    for node in part:
        mate[node] = -1
        parent[node] = -1
        side[node] = 0
    return sides, size


@njit(cache=True)
@no_type_check
def _alternate(starts, neighbours, side, mate, parent, queue, tail, touched, augment):
    """Breadth-first search along alternating paths from the nodes in `queue`; how many far nodes it reached.

    With `augment` it ends at the first free far node, and the matching grows by the path to it.
    """
    head = reached = 0
    while head < tail:
        node = queue[head]
        head += 1
        for entry in range(starts[node], starts[node + 1]):
            other = neighbours[entry]
            if side[other] != 2 or parent[other] >= 0:
                continue
            parent[other] = node
            touched[reached] = other
            reached += 1
            if mate[other] >= 0:
                queue[tail] = mate[other]
                tail += 1
            elif augment:
                while other >= 0:
                    node = parent[other]
                    following = mate[node]
                    mate[other], mate[node] = node, other
                    other = following
                return reached
    return reached


@njit(cache=True)
@no_type_check
def _arrange(order, place, part, sides, points, low):
    """Write the two sides and then the separator to `order` from `low` on; where the sides end."""
    ends = np.zeros(2, np.int64)
    at = low
    for which in range(1, 3):
        for position in range(len(part)):
            if sides[position] == which:
                order[at] = part[position]
                place[part[position]] = at
                at += 1
        ends[which - 1] = at
    separator = part[sides == 3]
    # Along its longest axis, so that what lies together is numbered together.
    widest, axis = -1.0, 0
    for column in range(points.shape[1]):
        values = points[separator, column]
        width = values.max() - values.min() if len(values) > 0 else 0.0
        if width > widest:
            widest, axis = width, column
    for rank in np.argsort(points[separator, axis]):
        order[at] = separator[rank]
        place[separator[rank]] = at
        at += 1
    return ends


@njit(cache=True)
@no_type_check
def _minimum_degree(starts, neighbours, order, place, low, high, bit):
    """Reorder the nodes order[low:high] by least degree in what is left, counting neighbours that are ordered later.

    Neighbourhoods are sets of bits: eliminating a node joins its neighbourhood to that of each of its neighbours. `bit`
    is -1 everywhere before and after.
    """
    size = high - low
    part = order[low:high].copy()
    bits = size
    for node in part:
        bit[node] = place[node] - low
        for entry in range(starts[node], starts[node + 1]):
            other = neighbours[entry]
            if not low <= place[other] < high and bit[other] < 0:
                bit[other] = bits
                bits += 1
    words = (bits + 63) // 64
    sets = np.zeros((size, words), np.uint64)
    one = np.uint64(1)
    degree = np.zeros(size, np.int64)
    for position in range(size):
        node = part[position]
        for entry in range(starts[node], starts[node + 1]):
            other = bit[neighbours[entry]]
            sets[position, other >> 6] |= one << np.uint64(other & 63)
        degree[position] = starts[node + 1] - starts[node]
    for step in range(size):
        pivot = np.argmin(degree)
        order[low + step] = part[pivot]
        degree[pivot] = 1 << 60
        row = sets[pivot]
        for position in range(size):
            if degree[position] == 1 << 60 or (row[position >> 6] >> np.uint64(position & 63)) & one == 0:
                continue
            count = 0
            for word in range(words):
                joined = sets[position, word] | row[word]
                if word == pivot >> 6:
                    joined &= ~(one << np.uint64(pivot & 63))
                if word == position >> 6:
                    joined &= ~(one << np.uint64(position & 63))
                sets[position, word] = joined
                count += _bits(joined)
            degree[position] = count
    for node in part:
        bit[node] = -1
        for entry in range(starts[node], starts[node + 1]):
            bit[neighbours[entry]] = -1
    for step in range(low, high):
        place[order[step]] = step


@njit(cache=True)
@no_type_check
def _bits(word):
    """How many bits of 64 are set."""
    word = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    word = (word & np.uint64(0x3333333333333333)) + ((word >> np.uint64(2)) & np.uint64(0x3333333333333333))
    word = (word + (word >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return np.int64((word * np.uint64(0x0101010101010101)) >> np.uint64(56))
