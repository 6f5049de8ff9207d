"""`SearchRules`: the numbers that steer the search for cable routes, in one record."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class SearchRules:
    """Rules of the search, the same for all bodies. Shares are of costs, which are as-built errors [m]."""

    # Poses of a network
    max_replays: int = 2  # so often is a pose sought that is also what its contractions lead to from rest
    same_pose: float = 1e-3  # markers nearer than this share of the body's size are at the same place
    opposite_turn: float = 0.2  # share of its range that a winch is turned the other way where a search begins again
    # what a meter of a marker that a pose does not name counts beside one of a marker that it names
    free_marker_weight: float = 0.1
    pose_restarts: int = 1  # restarts from where the first search ended, as rest leads to it
    min_reach: float = 0.01  # a marker that moves less than this share of the body's size is not brought anywhere
    pose_shortfall: float = 0.05  # a pose that misses more than hoped by this share of the whole error is sought again

    # Sets of lines
    winch_sets: int = 100  # sets of winch places that are tried
    line_effort: float = 0.5  # share of the residual that the tension limit is worth
    line_gain: float = 0.01  # what each line more must gain
    slack_rounds: int = 6  # rounds in which slack cables are left out
    line_exchanges: int = 3  # rounds of exchanges of lines
    lines_at_once: int = 64  # lines whose response is found at a time, so that large bodies need little memory
    # share of the gap between cables at which they meet; what is nearer than the gap is pushed apart
    meeting_gap: float = 0.6
    meeting_radii: float = 2.5  # within so many spool radii of a winch its cables may meet

    # Sketches
    tried_ways: tuple[int, int] = (0, 3)  # winches whose ways are all tried while sets of reversed lines are chosen
    winch_places: int = 24  # places where winches are thought of
    improved_sets: int = 5  # sets that are gone over for each that is wanted
    # share by which each further set of lines from the same winch places counts as worse
    same_place_penalty: float = 0.2
    rim_factor: float = 3.0  # how much longer an edge at the rim counts
    still_factor: float = 100.0  # how much longer an edge in a still zone counts
    smoothing_rounds: int = 6  # rounds of smoothing
    side_gaps: float = 0.7  # gaps between cables that a line is at least beside the middle where it ends
    max_side_spacings: float = 2.0  # spacings that a line is moved beside the middle at most
    same_point: float = 1e-6  # points nearer than this [m] are one
    # shares of the way to the clearance, and of the spacing, the first of which does: finer where a corner is cut
    sides: tuple[tuple[float, float], ...] = ((0.85, 1.0), (0.85, 0.5), (0.4, 0.5))
    sketch_reach: float = 0.03  # what is farther than this share of the body's size from a limit is not affected by it

    # Screening of sketches
    screen_ik_steps: int = 5  # steps of inverse kinematics before a sketch is refined
    screen_steps: int = 3  # steps of refinement of each sketch
    screen_more_steps: int = 2  # more steps of the best sketches
    screen_kept: int = 4  # sketches that get more steps
    max_stalled_sketches: int = 6  # sketches in a row that are no better end the screening
    screen_gain: float = 0.02  # a sketch that lowers the cost by less than this share is no better

    # Growth and refinement in rounds
    alike: float = 1e-3  # costs and spreads that differ by less than this share of the cost are of the same network
    growth_far: float = 1.15  # networks so much worse than the best are not refined with the build tolerances
    spare_paths: int = 4  # paths that are priced for each network that is solved: some cannot be built
    max_stalled_cables: int = 3  # cables in a row without gain after which the growth ends
    growth_steps: int = 2  # steps of refinement of each cable that is tried
    growth_more_steps: int = 3  # more steps of the best of them
    growth_gain: float = 0.02  # a cable that lowers the cost by less than this share does not help
    growth_promise: float = 0.03  # a cable is tried if prices promise to lower the cost by this share
    growth_final: int = 3  # networks that are refined with the build tolerances at the end
    growth_candidates: int = 2  # cables that are refined before one is added
    first_candidates: int = 3  # first cables that are tried
    growth_ik_steps: int = 5  # steps of inverse kinematics that tell which of several networks is the best
    round_steps: int = 8  # steps of refinement before the poses are found from rest again
    round_failures: int = 2  # rounds that do not hold from rest end the refinement
    round_gain: float = 0.02  # a round that gains less ends the refinement
    shallow_cost: float = 0.5  # how much more a network costs whose winches are at the edge
    turn_cost: float = 0.2  # how much more a network costs whose cables turn by 1 rad

    # Prices of paths
    shared_edges: float = 0.7  # two paths that share more than this part of their edges are variants of one
    # at most one path in so many, and at least two, stand in one region of winches while there are others
    region_share: int = 4
    lost_moves: float = 1e-4  # share of the squared moves of all edges, across the residual, that may be left out
    capped_moves: float = 10.0  # multiple of the median move of an edge that counts at most

    # Cables along paths
    priced_paths: int = 4  # paths that are priced for each that is tried: the winches of some are deeper in the body
    edge_gain: float = 0.1  # what the gain of a path counts whose winch is at the edge of the body
    weak_winch: float = 0.02  # winches that move the rows less than this share of the strongest are not counted on
    coarse_turn: float = 60.0  # sharpest turn of a path, which is smoothed afterwards [degrees]
    on_mirror: float = 1e-3  # so near to the mirror a point stands in it [m]
    same_winch: float = 1e-9  # winches nearer than this [m] are one
    idle_contraction: float = 1e-6  # a winch that takes in less [m] in every pose is as good as a new one
    # within so many spool radii of its winch a cable may be near another, which may be of the same winch
    crowded_radii: float = 2.5
    forbidden_moves: float = 1e5  # so many times the largest move of an edge
    path_reach: float = 0.03  # what is farther than this share of the body's size from a limit is not affected by it

    # Steps of refinement
    point_step: float = 0.03  # a large step of a via point, as a share of the body's size
    contraction_step: float = 0.2  # a large step of a contraction, as a share of the travel
    felt_limits: float = 0.3  # share of a large step within which limits are felt when a layout is pushed back
    first_damping: float = 0.1  # where the damping begins, as a share of the largest sensitivity
    min_damping: float = 1e-4  # smallest damping
    max_damping: float = 1e3  # largest damping
    good_step: float = 0.6  # share of what a step promised above which the damping falls
    poor_step: float = 0.2  # share below which the damping rises
    step_tries: int = 5  # damped steps that are tried
    contraction_damping: float = 0.1  # damping of contractions against that of the numbers of the layout
    excess_weight: float = 30.0  # how much more the part of a tension beyond its limit weighs
    max_pushes: int = 8  # most steps that push a layout back
    min_spread: float = 0.1  # tolerances that add less than this share of the error are not followed
    limit_precision: float = 2e-5  # what may be left of a limit [m]

    # Order of the search
    processes: int = 2  # processes that share independent networks
    thinner_cost: float = 0.02  # fewer holes may cost so much
    sketch_gain: float = 0.02  # a sketch that lowers the cost by less than this share is none
    strong_effort: float = 0.1  # what the effort of stronger paths counts
    sketches_each: int = 9  # sketches for each network that is grown, and for one more
    spare_sketches: int = 8  # sketches more than are grown that get further cables priced
    refined: int = 2  # networks that are refined to the end
    # the second network is refined only if its error is below this multiple of that of the first
    second_refined: float = 1.03
    min_seconds: float = 1e-3  # time limit of a solve that begins when the time is up [s]

    # Exchanges of cables
    exchange_ik_steps: int = 8  # steps of inverse kinematics from the poses of the network with the cable
    exchange_failures: int = 1  # exchanges in a row that do not help end the round
    exchange_promise: float = 0.03  # an exchange is tried if prices promise to lower the cost by this share
    exchange_gain: float = 0.01  # an exchange must gain so much
    cable_worth: float = 0.02  # a cable whose loss costs less than this share does not earn its place
    winch_worth: float = 0.04  # a winch whose loss costs less than this share does not earn its place

    # Holes left out
    hole_ik_steps: int = 5  # steps of inverse kinematics that tell what a network without a hole misses
    # a hole without which the cost is larger by less than this share does not earn its stitch
    hole_worth: float = 0.003
    hole_promise: float = 4.0  # holes that cost more than this multiple by the linear model are not tried
    hole_failures: int = 4  # holes that had to be kept end it
    min_points: int = 2  # points of the bare part of a cable
    hole_reach: float = 0.005  # limits are felt within this share of the body's size where a hole was left out

    # Final judgement
    # a simpler network is told of where those that are simpler still have so much larger errors
    simpler_cost: float = 0.05
    unjudged_cost: float = 1.1  # a network with so many times the allowed cost is not judged: judging it changes less
    holding_cost: float = 0.15  # errors may be so much larger where motors hold poses for long
    # multiples of their distance to which winches move for motors that hold poses for long
    holding_distances: tuple[float, ...] = (1.1, 1.2, 1.35)
    judged_on_the_way: int = 12  # networks on the way that are judged where no refined one can be built
    judged_late: int = 4  # the same, where the search was ended before
    # multiples of their distance to which winches move whose units meet
    winch_distances: tuple[float, ...] = (1.2, 1.5)
    holding_margin: float = 1e-4  # a limit with a smaller margin than this [m] holds
    grace: float = 1.0  # time that the judgement of networks may take after the first of them is judged [s]

    # Fewest winches
    usual_tolerance: float = 0.01  # the tolerance where none is given, as a share of the body's size
    # share of the tolerance at which no more cables are added: the mean over poses hides the worst
    safe_tolerance: float = 0.6

    # Proposals while posing
    quick_first: int = 3  # sketches that are solved before the first answer
    quick_last: int = 2  # networks that are refined with the build tolerances
    quick_sketches: tuple[int, int] = (2, 6)  # fewest and most sketches that are refined
    quick_work: int = 4000  # coordinates of nodes, times poses, times sketches that are refined
    quick_ik_steps: int = 5  # steps of inverse kinematics that tell how good a sketch is
    travel_precision: float = 1e-5  # contractions may exceed a travel by rounding [m]


RULES = SearchRules()
"""Rules of all searches."""
