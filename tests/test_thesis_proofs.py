"""Statements of docs/thesis.md and the tests that run them. Oracle: the files of these tests."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.robot import MATERIALS, Cable
from hydrostat.simulation import Simulation

ROOT = Path(__file__).parents[1]
PROOFS = {
    "tests/mechanics/test_energies.py": {"R16 R19": "test_energy_keeps_its_contract"},
    "tests/mechanics/test_newton.py": {
        "R15 R17 E6": "test_it_converges_to_a_minimum_and_says_so",
        "M4": "test_it_converges_to_a_ten_billionth_of_the_largest_force",
    },
    "tests/mechanics/test_neo_hookean.py": {
        "R21": "test_simple_shear",
        "R22": "test_uniaxial",
        "E7": "test_a_block_under_an_end_load_takes_its_closed_form",
        "E8": "test_hydrostatic",
    },
    "tests/mechanics/test_tension_law.py": {
        "R25": "test_energy_tension_and_tangent_are_continuous_at_the_joints",
        "R26": "test_each_is_the_derivative_of_the_one_before",
        "E1 E2": "test_a_cable_at_rest_has_neither_tension_nor_energy_nor_stiffness",
        "E3": "test_the_stiffness_is_that_of_the_taut_cable",
    },
    "tests/mechanics/test_inertia.py": {
        "E4 E5": "test_inertia_keeps_the_contract_of_energies",
    },
    "tests/mechanics/test_contact.py": {"M18": "test_a_block_pressed_against_a_plane"},
    "tests/mechanics/test_friction.py": {"E14": "test_capstan_while_a_cable_is_taken_in_and_let_out"},
    "tests/geometry/test_mesh.py": {"R20": "test_counts"},
    "tests/geometry/test_anchors.py": {"R24": "test_affine_functions_exactly"},
    "tests/simulation/test_simulation.py": {
        "R7 R23": "test_markers_and_tensions_belong_to_the_pose",
        "R14 E11": "test_a_sheathed_run_exerts_nothing_inside",
        "R29": "test_pins_balance_the_cable_that_comes_from_the_world",
        "E12": "test_slack_is_taken_in_first",
    },
    "tests/simulation/test_dynamics.py": {"R18 M3": "test_it_settles_to_the_statics_at_any_step"},
    "tests/simulation/test_jacobian.py": {
        "R33": "test_the_jacobian_is_the_derivative_of_the_pose",
        "E16": "test_the_projected_hessian_would_give_another_answer",
    },
    "tests/simulation/test_path_dependence.py": {"E20": "test_an_arch_rests_up_or_down"},
    "tests/simulation/test_sliders.py": {"F4 E32": "test_a_stretched_bar_draws_the_loop_of_iwan"},
    "tests/cli/test_commands.py": {"R57": "test_simulate_writes_what_the_library_solves"},
    "tests/robot/test_records.py": {
        "E9": "test_lame",
        "E10": "test_pin_between_nodes",
    },
    "tests/robot/test_materials.py": {"M1 E30": "test_bounds"},
    "tests/robot/test_gallery_bodies.py": {
        "R50": "test_bodies",
        "R51 R64 N3": "test_hands_are_as_in_the_thesis",
        "M6": "test_the_scripts_write_the_files",
    },
    "tests/robot/test_sketch_space.py": {"R56": "test_a_dirty_surface_is_kept_healed"},
    "tests/ik/test_objectives.py": {"R31 E19": "test_values_of_the_others"},
    "tests/ik/test_solve_ik.py": {
        "R32": "test_the_gradient_of_the_objective",
        "E15": "test_cables_that_all_hang_loose_are_recruited",
        "E18": "test_contractions_stay_within_travel_and_release",
        "M7": "test_targets_far_out_of_reach_take_few_steps",
    },
    "tests/ik/test_inverse_page.py": {"E17": "test_the_targets_of_the_page_are_reached"},
    "tests/ik/test_tracker.py": {"R30": "test_a_moving_target_is_followed_by_real_poses"},
    "tests/ik/test_solve_ik_trajectory.py": {
        "R72": "test_every_keyframe_is_the_pose_that_inverse_kinematics_finds",
    },
    "tests/studio/driving/test_hardware.py": {"R34": "test_a_pose_that_is_dragged_streams_its_iterates"},
    "tests/studio/driving/test_driver.py": {"R58": "test_motors_follow_at_their_speed"},
    "tests/studio/designing/test_designer.py": {"R2": "test_one_pose_at_least_is_reached"},
    "tests/design/test_activation.py": {
        "R36": "test_a_reachable_pose_is_reached_by_muscles_that_pull",
        "R38": "test_least_effort_meets_the_conditions_of_an_optimum",
        "E26 M8": "test_more_effort_leaves_more_error_and_weaker_muscles",
    },
    "tests/design/test_fibres.py": {
        "R37": "test_element_fibres_run_from_side_to_side_through_the_centroid",
        "E21": "test_edge_fibres_are_the_edges",
    },
    "tests/design/test_grow_routes.py": {
        "R39": "test_the_strongest_fibres",
        "R40": "test_the_nearer_then_the_stronger_fibre_is_joined",
    },
    "tests/design/test_winch_trees.py": {
        "R41 M10": "test_the_best_tree_of_all_places_and_subsets",
        "R42 R43 E22 E23": "test_the_score_by_hand",
    },
    "tests/design/test_constraints.py": {"R44": "test_every_constraint_is_checked"},
    "tests/design/test_design_cables.py": {
        "R35 R55 E25": "test_a_design_has_what_was_asked_for",
        "R45 E24": "test_the_errors_told_are_those_of_the_robot",
    },
    "tests/design/test_design_routes.py": {"E28": "test_the_error_told_is_what_its_user_finds"},
    "tests/design/test_design_fewest.py": {
        "F1": "test_every_pose_is_within_the_tolerance",
        "F2": "test_the_front_holds_every_size_once",
    },
    "tests/design/test_request.py": {"M9": "test_every_number_has_its_range"},
    "tests/cli/test_design_requests.py": {"R46": "test_knobs_of_the_thesis_have_the_same_names_everywhere"},
    "tests/fabrication/test_kit.py": {"R9": "test_a_kit_is_true_to_its_robot"},
    "tests/fabrication/test_pattern.py": {"R10": "test_pinholes_on_the_back_are_an_option"},
    "tests/fabrication/lists/test_line.py": {"R11": "test_strength_of_a_line"},
    "tests/fabrication/lists/test_bill.py": {"N2": "test_a_hand_of_foam_costs_what_the_thesis_paid"},
    "tests/fabrication/parts/test_winch_unit.py": {
        "R12": "test_units_of_the_gallery",
        "E13": "test_long_travel_lies_in_layers_and_says_how_much_the_radius_grows",
    },
    "tests/fabrication/parts/test_stopper.py": {"R13": "test_nothing_is_in_the_way_until_the_cable_is_pressed_flat"},
    "tests/fabrication/parts/test_base_plate.py": {"R54": "test_everything_fits_on_the_base"},
    "tests/fabrication/parts/test_motor.py": {
        "M15": "test_every_motor_is_stronger_than_the_one_before_and_says_where_its_figures_are_from",
    },
    "tests/fabrication/moulds/test_casting.py": {"R52": "test_silicone_for_two_pours"},
    "tests/design/test_skin_region.py": {"R53": "test_a_design_on_the_skin_is_sewn_as_it_was_simulated"},
    "tests/grasp/test_pull_out.py": {
        "R59 N4 E31": "test_the_object_is_held_and_comes_free",
    },
    "tests/training/test_pushing.py": {"R60 F12": "test_a_gripper_turns_its_disc"},
    "tests/training/test_walking.py": {"R48": "test_the_gallery_s_puppy_is_put_on_the_ground"},
    "tests/learning/test_sampling.py": {
        "R63": "test_a_sample_is_what_the_simulator_finds",
        "R65": "test_draws_keep_to_what_they_say",
    },
    "tests/learning/test_learning.py": {
        "R62 R73": "test_networks_expect_what_the_simulator_finds",
        "R67": "test_answers_rolled_out_in_the_simulator",
        "E41": "test_the_way_back_learns_what_a_model_answers",
    },
    "tests/teleop/test_mimicry.py": {
        "R68": "test_the_glove_tells_its_sensors_to_half_a_step",
        "R69 E43": "test_a_hundred_and_twenty_poses",
        "M13": "test_the_penalty_is_chosen_by_poses_left_out",
        "E44 M14": "test_errors_of_poses_left_out_are_those_of_fits_made_anew",
    },
    "tests/teleop/test_lesson.py": {"R70": "test_forty_poses_of_a_person_who_holds_still"},
    "tests/teleop/test_camera_hand.py": {"F8": "test_pictures_become_bends"},
    "tests/test_thesis_proofs.py": {
        "R27": "test_cables_of_a_winch_share_its_contraction",
        "R28": "test_a_cable_has_two_points_at_least",
        "M2 M5": "test_values_that_it_never_gives_are_positive",
        "N5 N6": "test_its_numbers_of_materials_are_told",
    },
    "lab/tests/test_hindsight_ddpg.py": {
        "R74": "test_a_point_learns_to_go_where_it_should",
        "R76": "test_rewards_by_hand",
        "R83 F10": "test_tolerances_go_on_when_nine_of_ten_succeed",
        "E53": "test_discounts_and_cut_targets_by_hand",
    },
    "lab/tests/test_hindsight_by_others.py": {
        "R77": "test_goals_are_taken_as_often_as_by_stable_baselines3",
    },
    "lab/tests/test_experiments.py": {
        "R75 E45": "test_the_simulator_judges_where_contractions_lead",
        "R79 R80 R84 R85 R87 E47 E54": "test_every_claim_can_be_judged",
        "R86": "test_one_number_moves_the_one_or_the_other_winch",
    },
    "lab/tests/test_policies.py": {"R88 R89 R90 E61 F11": "test_others_learn_from_what_was_tried"},
    "lab/tests/test_reference.py": {"R78 E49": "test_settings_are_the_published_ones"},
    "lab/tests/test_study.py": {
        "R66 N9 N11 E33 E36 E37 E38 E39 M19": "test_the_tables_and_figures_of_the_thesis",
        "E65": "test_options_of_a_size",
    },
    "lab/tests/test_verdict.py": {"E62 F13": "test_verdicts"},
    "lab/tests/test_glove_poses.py": {"R71": "test_a_straight_hand_shows_what_the_robot_does"},
    "lab/tests/test_catalog.py": {
        "N13 N14 N15 N16 E63": "test_each_result_stands_in_the_file_that_it_names",
    },
}
"""Tests by their files, each with the codes of the statements that it runs."""

WORDS = {
    "aims and comparisons": "R1 R3 R4 R5 R6 R8 R61 N7 N10 M20",
    "readings of its text": "E29 E34 E35 E40 E42 E46 E48 E50 E51 E52 E55 E56 E57 E58 E59 E60 E64 M11 M12 R81 R82 N17",
    "figures of long runs": "R49 N1 N8 N12 E27 E66 M16 F3 F7 F9",
    "robots that were built": "R47 M17 F5 F6",
}
"""Statements that no cheap run can hold, by their kind."""


def listed() -> list[str]:
    text = (ROOT / "docs" / "thesis.md").read_text(encoding="utf-8")
    return re.findall(r"^\| ([RNEMF][0-9]+) \|", text, re.MULTILINE)


def proved() -> list[str]:
    return [code for tests in PROOFS.values() for codes in tests for code in codes.split()]


def test_every_statement_has_a_test_or_says_why_not() -> None:
    told = [code for codes in WORDS.values() for code in codes.split()]
    assert sorted(proved() + told) == sorted(listed())


def test_the_tests_are_there() -> None:
    assert missing(PROOFS) == []
    assert missing({"tests/test_thesis.py": {"R1": "test_nothing"}}) == ["tests/test_thesis.py::test_nothing"]


def test_cables_of_a_winch_share_its_contraction() -> None:
    """Oracle: two winches that take in as much each."""
    made = strip_robot(columns=4, rows=1)
    at, (upper, lower) = made.winches[0].at, made.cables
    lower = replace(lower, points=(at, *lower.points[1:]))
    two = replace(made, winches=(made.winches[0], replace(made.winches[1], at=at)), cables=(upper, lower))
    one = replace(made, winches=made.winches[:1], cables=(upper, replace(lower, winch="up")))
    apart, joined = Simulation(two).solve({"up": 0.01, "down": 0.01}), Simulation(one).solve({"up": 0.01})
    assert abs(apart.nodes - made.body.mesh.nodes).max() > 1e-3
    np.testing.assert_allclose(joined.nodes, apart.nodes, atol=1e-9)


def test_a_cable_has_two_points_at_least() -> None:
    with pytest.raises(InputError, match="at least 2 points"):
        Cable(winch="up", points=((0.0, 0.0),))
    assert len(Cable(winch="up", points=((0.0, 0.0), (0.1, 0.0))).points) == 2


def test_values_that_it_never_gives_are_positive() -> None:
    """Oracle: a robot whose file says none of them."""
    robot = strip_robot(columns=2, rows=1)
    assert min(robot.pins[0].stiffness, robot.cables[0].smoothing, robot.body.thickness or 0.0) > 0
    assert Cable(winch="up", points=((0.0, 0.0), (0.1, 0.0))).stiffness > 0


def test_its_numbers_of_materials_are_told() -> None:
    """Oracle: REQUIREMENTS of this project, copied from the thesis by hand."""
    page = (ROOT / "docs" / "plush_or_foam.md").read_text(encoding="utf-8")
    assert [
        number
        for number in ("1.07 g", "1.03 g", "0.16 g", "48 h", "3.026 MPa", "0.531 MPa", "2.4 lb")
        if number not in page
    ] == []
    assert MATERIALS["flexfoam-it x"].density == 160


def missing(proofs: dict[str, dict[str, str]]) -> list[str]:
    """Tests that are not in their files."""
    return [
        f"{file}::{name}"
        for file, tests in proofs.items()
        for name in tests.values()
        if f"\ndef {name}(" not in (ROOT / file).read_text(encoding="utf-8")
    ]
