"""Compiled loops of the search for paths: turns that are allowed, leads, labels that grow edge by edge."""

import math
from typing import no_type_check

from hydrostat.kernel import INNER, KERNEL, njit

FINE = {"contract", "reassoc"}  # what of floating point may be rearranged: sums, so that they run in vector registers


@njit(**KERNEL)
@no_type_check
def count_turns(points, offsets, sources, targets, reverses, blocked, least, counts, before):
    """Directed edges after which each one may follow, by the cosine of the turn; counted, and listed if there is room.

    `before` of no length only counts. A cable does not turn back on its edge, nor pass through a blocked point.
    """
    total = 0
    for edge in range(sources.shape[0]):
        here, there = sources[edge], targets[edge]
        counts[edge] = total
        if blocked[here]:
            continue
        for back in range(offsets[here], offsets[here + 1]):
            came = targets[back]
            if came == there:
                continue
            dot, one, two = 0.0, 0.0, 0.0
            for axis in range(points.shape[1]):
                first = points[here, axis] - points[came, axis]
                second = points[there, axis] - points[here, axis]
                dot += first * second
                one += first * first
                two += second * second
            if dot >= least * math.sqrt(one * two):
                if total < before.shape[0]:
                    before[total] = reverses[back]
                total += 1
    counts[sources.shape[0]] = total
    return total


@njit(**KERNEL)
@no_type_check
def spread_leads(turns, before, lengths, leads, origins, longest):
    """Shortest lead to the start of each directed edge, by sweeps until nothing changes; `leads` is 0 at winches.

    `origins` is the directed edge by which a lead comes, -1 at a winch.
    """
    changed = True
    while changed:
        changed = False
        for edge in range(leads.shape[0]):
            for slot in range(turns[edge], turns[edge + 1]):
                came = before[slot]
                lead = leads[came] + lengths[came]
                if lead < leads[edge] - 1e-12 and lead <= longest:
                    leads[edge] = lead
                    origins[edge] = came
                    changed = True


@njit(**INNER)
@no_type_check
def _visits(parents, sources, targets, hop, label, slots, point):
    """Whether the path of a label runs through a point."""
    if targets[label // slots] == point:
        return True
    while True:
        if sources[label // slots] == point:
            return True
        if hop == 0:
            return False
        label = parents[hop, label]
        hop -= 1


@njit(fastmath=FINE, **INNER)
@no_type_check
def _dot(first, one, second, two, pose):
    total = 0.0
    for row in range(first.shape[2]):
        total += first[one, pose, row] * second[two, pose, row]
    return total


@njit(**INNER)
@no_type_check
def decrease(pull, square, ridge, most):
    """What a path gains in one pose: max over t in [0, most] of t pull - t^2 (square + ridge) / 2."""
    if pull <= 0.0:
        return 0.0
    stiff = square + ridge
    if pull >= most * stiff:
        return most * (pull - 0.5 * most * stiff)
    return 0.5 * pull * pull / stiff


@njit(fastmath=FINE, **KERNEL)
@no_type_check
def edge_products(moves, residual, pulls, squares):
    """Find r . m and |m|^2 of each undirected edge in each pose; m is (edges, poses, rows), r (1, poses, rows)."""
    for edge in range(moves.shape[0]):
        for pose in range(moves.shape[1]):
            pulls[edge, pose] = _dot(residual, 0, moves, edge, pose)
            squares[edge, pose] = _dot(moves, edge, moves, edge, pose)


@njit(**KERNEL)
@no_type_check
def first_labels(
    sources, targets, edge_of, lengths, begins, rooms, moves, pulls, squares, ridge, most, labels, sums, marks,
    values, parents,
):  # fmt: skip
    """Labels of one edge, in the first slot of each directed edge that may begin a path. Layout: see `grow_labels`."""
    poses, slots = ridge.shape[0], values.shape[0] // edge_of.shape[0]
    for edge in range(edge_of.shape[0]):
        for slot in range(slots):
            values[edge * slots + slot] = -math.inf
            parents[edge * slots + slot] = -1
        own, label = edge_of[edge], edge * slots
        if begins[edge] <= 0.0 or lengths[own] > rooms[edge]:
            continue
        value = 0.0
        for pose in range(poses):
            value += decrease(pulls[own, pose], squares[own, pose], ridge[pose], most)
            sums[label, pose] = pulls[own, pose]
            sums[label, poses + pose] = squares[own, pose]
        sums[label, 2 * poses] = rooms[edge] - lengths[own]
        sums[label, 2 * poses + 1] = begins[edge]
        values[label] = value * begins[edge]
        marks[label] = 1 << (sources[edge] & 63) | 1 << (targets[edge] & 63)
        for pose in range(poses):
            for row in range(moves.shape[2]):
                labels[label, pose, row] = moves[own, pose, row]


@njit(fastmath=FINE, **KERNEL)
@no_type_check
def grow_labels(
    turns, before, sources, targets, edge_of, blocked, lengths, moves, pulls, squares, ridge, most, hop, labels,
    sums, marks, values, parents, longer, longer_sums, longer_marks, best, ranked, chosen,
):  # fmt: skip
    """Paths of one edge more: each directed edge keeps the best that end with it.

    Label `edge * slots + slot` is a path that ends with a directed edge. Its row of `labels` is what it moves; of
    `sums` r . J of each pose, |J|^2 of each pose, the length it may still grow by, and the factor of its value.
    `marks` has a bit set for each of its points, by their numbers modulo 64: a bit that is not set rules a point out.
    `values[hop]` is what it gains, -inf for none; `parents[hop]` the label it grew from. The first half of the slots is
    for the largest gains, the rest for the largest r . J of those that are left: a long strong path that is not yet
    well aimed survives. `best`, `ranked` and `chosen` are room for the slots.
    """
    poses, slots = ridge.shape[0], best.shape[0]
    sharp = (slots + 1) // 2
    for edge in range(edge_of.shape[0]):
        own, mark = edge_of[edge], 1 << (targets[edge] & 63)
        for slot in range(slots):
            best[slot] = -math.inf
            ranked[slot] = -math.inf
            chosen[slot] = -1
        if not blocked[edge]:
            for place in range(turns[edge], turns[edge + 1]):
                came = before[place]
                for label in range(came * slots, came * slots + slots):
                    if values[hop - 1, label] == -math.inf or lengths[own] > sums[label, 2 * poses]:
                        continue
                    value, price = 0.0, 0.0
                    for pose in range(poses):
                        cross = _dot(labels, label, moves, own, pose)
                        pull = sums[label, pose] + pulls[own, pose]
                        square = sums[label, poses + pose] + 2.0 * cross + squares[own, pose]
                        value += decrease(pull, square, ridge[pose], most)
                        price += pull
                    value *= sums[label, 2 * poses + 1]
                    price *= sums[label, 2 * poses + 1]
                    if value <= best[sharp - 1] and (slots == sharp or price <= ranked[slots - 1]):
                        continue
                    if marks[label] & mark and _visits(parents, sources, targets, hop - 1, label, slots, targets[edge]):
                        continue
                    _insert(label, value, price, sharp, best, ranked, chosen)
        for slot in range(slots):
            label, grown = chosen[slot], edge * slots + slot
            values[hop, grown] = best[slot]
            parents[hop, grown] = label
            if label < 0:
                continue
            for pose in range(poses):
                cross = _dot(labels, label, moves, own, pose)
                longer_sums[grown, pose] = sums[label, pose] + pulls[own, pose]
                longer_sums[grown, poses + pose] = sums[label, poses + pose] + 2.0 * cross + squares[own, pose]
            longer_marks[grown] = marks[label] | mark
            longer_sums[grown, 2 * poses] = sums[label, 2 * poses] - lengths[own]
            longer_sums[grown, 2 * poses + 1] = sums[label, 2 * poses + 1]
            for pose in range(poses):
                for row in range(moves.shape[2]):
                    longer[grown, pose, row] = labels[label, pose, row] + moves[own, pose, row]


@njit(**INNER)
@no_type_check
def _insert(label, value, price, sharp, best, ranked, chosen):
    """Sort a candidate into the slots by gain; what falls out of them, into those by price."""
    if value > best[sharp - 1]:
        label, value, price = _sift(label, value, price, 0, sharp, best, best, ranked, chosen)
    if label >= 0 and best.shape[0] > sharp and price > ranked[best.shape[0] - 1]:
        _sift(label, value, price, sharp, best.shape[0], ranked, best, ranked, chosen)


@njit(**INNER)
@no_type_check
def _sift(label, value, price, begin, end, keys, best, ranked, chosen):
    """Insert into slots sorted by `keys`; returns what falls out at the end."""
    by_price = begin > 0
    for slot in range(begin, end):
        if (price if by_price else value) > keys[slot]:
            label, chosen[slot] = chosen[slot], label
            value, best[slot] = best[slot], value
            price, ranked[slot] = ranked[slot], price
    return label, value, price


@njit(**KERNEL)
@no_type_check
def walk_back(parents, sources, targets, slots, hops, labels, paths):
    """Points of each path from its last to its first, (paths, hops + 1); -1 beyond it."""
    for row in range(labels.shape[0]):
        label, hop = labels[row], hops[row]
        paths[row, 0] = targets[label // slots]
        for place in range(1, paths.shape[1]):
            paths[row, place] = -1
            if hop >= 0:
                paths[row, place] = sources[label // slots]
                label = parents[hop, label]
                hop -= 1


@njit(**KERNEL)
@no_type_check
def next_unlike(paths, begin, others, usable, alike):
    """Find the first usable path from `begin` on unlike all others; as many as there are paths if there is none.

    It shares at most `alike` of its edges, either way round, with each, as a part of the shorter of the two, and is the
    same as none of them.
    """
    for index in range(begin, paths.shape[0]):
        if not usable[index]:
            continue
        unlike = True
        for row in range(others.shape[0]):
            if _share(paths, index, others, row) > alike or _same(paths, index, others, row):
                unlike = False
                break
        if unlike:
            return index
    return paths.shape[0]


@njit(**INNER)
@no_type_check
def _same(paths, index, others, row):
    differing = 0
    for place in range(paths.shape[1]):
        differing += paths[index, place] != others[row, place]
    return differing == 0


@njit(**INNER)
@no_type_check
def _share(paths, index, others, row):
    """Share of their edges that two paths have in common."""
    same, own, their = 0, 0, 0
    while own + 1 < paths.shape[1] and paths[index, own + 1] >= 0:
        own += 1
    while their + 1 < others.shape[1] and others[row, their + 1] >= 0:
        their += 1
    for one in range(own):
        here, there = paths[index, one], paths[index, one + 1]
        for two in range(their):
            first, second = others[row, two], others[row, two + 1]
            if (here == first and there == second) or (here == second and there == first):
                same += 1
    return same / min(own, their)
