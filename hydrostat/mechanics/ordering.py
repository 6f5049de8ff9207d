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

from hydrostat.kernel import INNER, Kernel, njit

Graph = tuple[np.ndarray, np.ndarray]

_LARGEST = 0.4
"""A separator may have this share of the nodes that it separates."""


def block_graph(indptr: np.ndarray, indices: np.ndarray, dim: int) -> Graph:
    """Which nodes share an entry of a matrix with `dim` degrees of freedom a node."""
    count = (len(indptr) - 1) // dim
    starts, neighbours = np.zeros(count + 1, np.int64), np.empty(len(indices), np.int64)
    _block_graph(indptr, indices, dim, starts, neighbours, np.full(count, -1))
    return starts, neighbours[: starts[-1]].copy()


@Kernel
@no_type_check
def _block_graph(indptr, indices, dim, starts, neighbours, seen):
    """Fill `starts` and `neighbours`; `seen` is -1 for every node."""
    filled = 0
    for node in range(len(seen)):
        seen[node] = node
        for entry in range(indptr[node * dim], indptr[(node + 1) * dim]):
            other = indices[entry] // dim
            if seen[other] != node:
                seen[other] = node
                neighbours[filled] = other
                filled += 1
        starts[node + 1] = filled


def graph_coordinates(starts: np.ndarray, neighbours: np.ndarray, count: int) -> np.ndarray:
    """Distances in the graph from `count` nodes, each the farthest from those before it, (nodes, count)."""
    nodes = len(starts) - 1
    queue = np.empty(nodes, np.int64)
    distances = np.full((count + 1, nodes), float(nodes))
    _distances(starts, neighbours, 0, distances[count], queue)
    root = np.argmax(distances[count])
    for column in range(count):
        _distances(starts, neighbours, root, distances[column], queue)
        root = np.argmax(distances[: column + 1].min(axis=0))
    return distances[:count].T


@Kernel
@no_type_check
def _distances(starts, neighbours, root, distances, queue):
    """Edges between each node and `root`; left as they are, the number of nodes, where no path leads."""
    far = distances[root]
    distances[root] = 0.0
    queue[0] = root
    head, tail = 0, 1
    while head < tail:
        node = queue[head]
        head += 1
        for entry in range(starts[node], starts[node + 1]):
            other = neighbours[entry]
            if distances[other] == far:
                distances[other] = distances[node] + 1.0
                queue[tail] = other
                tail += 1


def nested_dissection(
    starts: np.ndarray, neighbours: np.ndarray, points: np.ndarray, leaf: int, shares: np.ndarray
) -> np.ndarray:
    """Order of elimination, (nodes,): the node to eliminate first, second, ...

    Parts of up to `leaf` nodes are not cut. `shares` are the parts of the nodes that a cut may leave on one side; it
    runs across a coordinate, a column of `points`.
    """
    nodes = len(starts) - 1
    points = np.ascontiguousarray(points.T)
    lines = np.argsort(points, axis=1, kind="stable")
    order, work = np.zeros(nodes, np.int64), np.full((3, nodes), -1)
    sides, todo = np.zeros((3, nodes), np.int64), np.zeros((nodes + 1, 2), np.int64)
    room = np.empty((3, nodes), np.int64)
    _dissect(starts, neighbours, points, lines, leaf, shares, order, work, sides, todo, room)
    return order


@Kernel
@no_type_check
def _dissect(starts, neighbours, points, lines, leaf, shares, order, work, sides, todo, room):
    """Fill `order`. `lines` are the nodes sorted by each coordinate, at first all of them, in the end part by part.

    `work` is -1, `sides` 0 everywhere; `todo` and `room` hold anything.
    """
    place, best = sides[1], sides[2]
    for position in range(len(order)):
        place[lines[0, position]] = position
    todo[0, 0], todo[0, 1] = 0, len(order)
    waiting = 1
    while waiting > 0:
        waiting -= 1
        low, high = todo[waiting, 0], todo[waiting, 1]
        least = np.inf
        if high - low > leaf:
            for axis in range(len(lines)):
                line = lines[axis, low:high]
                for which in range(len(shares)):
                    half = int(len(line) * shares[which])
                    score = _separator(starts, neighbours, line, half, work, sides[0], room)
                    if score < least:
                        least = score
                        for node in line:
                            best[node] = sides[0, node]
                    for node in line:
                        sides[0, node] = 0
        if least < np.inf:
            middle, end = _arrange(lines, points, order, place, best, low, high, room[0])
            todo[waiting, 0], todo[waiting, 1] = low, middle
            todo[waiting + 1, 0], todo[waiting + 1, 1] = middle, end
            waiting += 2
        elif high > low:
            _minimum_degree(starts, neighbours, lines[0, low:high], order, place, low, work[0], room[0])


@njit(**INNER)
@no_type_check
def _separator(starts, neighbours, line, half, work, side, room):
    """Ratio of a separator to the product of the halves, where the first `half` nodes of `line` are cut off.

    It is infinite where a half is empty, or where the separator is too large. `side` becomes 1 and 2, 3 on the
    separator; it is 0 before, and `work` is -1 before and after.
    """
    mate, parent = work[0], work[1]
    queue, touched, border = room[0], room[1], room[2]
    for rank in range(len(line)):
        side[line[rank]] = 1 if rank < half else 2
    bordering = 0
    for rank in range(half):
        node = line[rank]
        for entry in range(starts[node], starts[node + 1]):
            other = neighbours[entry]
            if side[other] == 2:
                if mate[node] < 0:
                    border[bordering] = node
                    bordering += 1
                    mate[node] = node
                if mate[other] < 0:
                    mate[other], mate[node] = node, other
                    break
    grow = np.int64(1)
    for rank in range(bordering):
        node = border[rank]
        if mate[node] == node:
            queue[0] = node
            reached = _alternate(starts, neighbours, side, mate, parent, queue, grow, touched, grow)
            for position in range(reached):
                parent[touched[position]] = -1
    free = np.int64(0)
    for rank in range(bordering):
        if mate[border[rank]] == border[rank]:
            queue[free] = border[rank]
            free += 1
    _alternate(starts, neighbours, side, mate, parent, queue, free, touched, grow - 1)
    size = near = 0
    for rank in range(bordering):
        node = border[rank]
        if mate[node] != node:
            size += 1
            # Cover: on the far side what an alternating path from a free node reaches, on the near side the rest.
            if parent[mate[node]] >= 0:
                side[mate[node]] = 3
            else:
                side[node] = 3
                near -= 1
    near += half
    for node in line:
        mate[node] = -1
        parent[node] = -1
    far = len(line) - near - size
    if near == 0 or far == 0 or size > _LARGEST * len(line):
        return np.inf
    return size / (float(near) * far)


@njit(**INNER)
@no_type_check
def _alternate(starts, neighbours, side, mate, parent, queue, tail, touched, grow):
    """Breadth-first search along alternating paths from the nodes in `queue`; how many far nodes it reached.

    A near node without a mate is its own. With `grow` the search ends at the first free far node, and the matching
    grows by the path to it.
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
            elif grow:
                following = other
                while following != node:
                    other = following
                    node = parent[other]
                    following = mate[node]
                    mate[other], mate[node] = node, other
                return reached
    return reached


@njit(**INNER)
@no_type_check
def _arrange(lines, points, order, place, side, low, high, spare):
    """Sort each line from `low` to `high` into the two sides and the separator, and order the latter; where they end.

    The separator is ordered along its longest axis, so that what lies together is numbered together.
    """
    widest = -1.0
    middle = end = low
    for axis in range(len(lines)):
        at = low
        for which in range(1, 4):
            if which == 2:
                middle = at
            elif which == 3:
                end = at
            for position in range(low, high):
                node = lines[axis, position]
                if side[node] == which:
                    spare[at] = node
                    at += 1
        for position in range(low, high):
            lines[axis, position] = spare[position]
        if end < high:
            width = points[axis, spare[high - 1]] - points[axis, spare[end]]
            if width > widest:
                widest = width
                for position in range(end, high):
                    order[position] = spare[position]
    for position in range(low, end):
        place[lines[0, position]] = position
    for position in range(end, high):
        place[order[position]] = position
    return middle, end


@njit(**INNER)
@no_type_check
def _minimum_degree(starts, neighbours, part, order, place, low, bit, degree):
    """Order the nodes of `part`, from `low` on, by least degree in what is left, counting neighbours ordered later.

    Neighbourhoods are sets of bits: eliminating a node joins its neighbourhood to that of each of its neighbours. `bit`
    is -1 everywhere before and after.
    """
    size = len(part)
    bits = size
    for position in range(size):
        node = part[position]
        bit[node] = position
        for entry in range(starts[node], starts[node + 1]):
            other = neighbours[entry]
            if (place[other] < low or place[other] >= low + size) and bit[other] < 0:
                bit[other] = bits
                bits += 1
    words = (bits + 63) >> 6
    one = np.uint64(1)
    sets = np.zeros(size * words, np.uint64)
    for position in range(size):
        node = part[position]
        for entry in range(starts[node], starts[node + 1]):
            other = bit[neighbours[entry]]
            sets[position * words + (other >> 6)] |= one << np.uint64(other & 63)
        degree[position] = starts[node + 1] - starts[node]
    gone = 1 << 60
    for step in range(size):
        pivot = 0
        for position in range(1, size):
            if degree[position] < degree[pivot]:
                pivot = position
        order[low + step] = part[pivot]
        degree[pivot] = gone
        for position in range(size):
            inside = sets[pivot * words + (position >> 6)] >> np.uint64(position & 63)
            if degree[position] == gone or inside & one == 0:
                continue
            own = position * words
            for word in range(words):
                sets[own + word] |= sets[pivot * words + word]
            sets[own + (pivot >> 6)] &= ~(one << np.uint64(pivot & 63))
            sets[own + (position >> 6)] &= ~(one << np.uint64(position & 63))
            count = np.int64(0)
            for word in range(words):
                count += _bits(sets[own + word])
            degree[position] = count
    for node in part:
        bit[node] = -1
        for entry in range(starts[node], starts[node + 1]):
            bit[neighbours[entry]] = -1
    for step in range(low, low + size):
        place[order[step]] = step


@njit(**INNER)
@no_type_check
def _bits(word):
    """How many bits of 64 are set."""
    word = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    word = (word & np.uint64(0x3333333333333333)) + ((word >> np.uint64(2)) & np.uint64(0x3333333333333333))
    word = (word + (word >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return np.int64((word * np.uint64(0x0101010101010101)) >> np.uint64(56))
