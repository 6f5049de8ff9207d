"""Robot model: frozen records, checked when created, and the robot.toml that stores them."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.robot.body import Body, Source
    from hydrostat.robot.cable import Cable
    from hydrostat.robot.cable_side import CableSide
    from hydrostat.robot.contact import DISTANCE, Contact, Obstacle, ObstacleShape, closed_mesh, edge_points
    from hydrostat.robot.element_kind import ElementKind, Plane, Volume
    from hydrostat.robot.fixed_drives import with_fixed_drives
    from hydrostat.robot.gravity import DIRECTIONS, direction_of, gravity_along
    from hydrostat.robot.inflated import describe_cable_side, inflated_robot, sewn_robot, sewn_sides
    from hydrostat.robot.load import Load
    from hydrostat.robot.load_drive import LoadDrive
    from hydrostat.robot.marker import Marker, PoseTarget
    from hydrostat.robot.material import FOAM_POISSON_LIMIT, FoamTerm, Material, PrandtlElement, PronyTerm
    from hydrostat.robot.materials import FOAMS, MATERIALS, get_material
    from hydrostat.robot.merge import comments, lost_comments, merged_text
    from hydrostat.robot.mirror import MIRROR_TOLERANCE, find_mirror, measure_asymmetry
    from hydrostat.robot.obstacle_lines import obstacle_lines, rims
    from hydrostat.robot.own_materials import own_materials, save_own_material
    from hydrostat.robot.part import BodyPart
    from hydrostat.robot.part_elements import find_part_facets, find_rings
    from hydrostat.robot.pin import Pin
    from hydrostat.robot.pin_drive import PinDrive
    from hydrostat.robot.read import FILE, GALLERY, RobotReader, gallery_folder, is_of_gallery, list_gallery, load_robot
    from hydrostat.robot.risks import SEWN_DEPTH, find_far_targets, find_risks, limit_travels
    from hydrostat.robot.risks.body_risks import FEW_ELEMENTS, MIN_ELEMENTS_ACROSS
    from hydrostat.robot.robot import Robot
    from hydrostat.robot.rod import Rod
    from hydrostat.robot.scaled import scaled_robot
    from hydrostat.robot.sensor import Sensor, SensorKind
    from hydrostat.robot.sheet import Membrane, SheetSide
    from hydrostat.robot.sketch import choose_plane, sketch_robot
    from hydrostat.robot.sketch_space import SurfaceSketch, describe_filled_holes, inflate_outline, sketch_mesh
    from hydrostat.robot.skin_cables import lay_cables_on_skin
    from hydrostat.robot.tables_file import TablesFile
    from hydrostat.robot.winch import Mount, Winch
    from hydrostat.robot.winch_bodies import check_winch_bodies, fit_winch_bodies
    from hydrostat.robot.write import robot_hash, robot_text, save_robot, with_values

__all__ = [
    "DIRECTIONS",
    "DISTANCE",
    "FEW_ELEMENTS",
    "FILE",
    "FOAMS",
    "FOAM_POISSON_LIMIT",
    "GALLERY",
    "MATERIALS",
    "MIN_ELEMENTS_ACROSS",
    "MIRROR_TOLERANCE",
    "SEWN_DEPTH",
    "Body",
    "BodyPart",
    "Cable",
    "CableSide",
    "Contact",
    "ElementKind",
    "FoamTerm",
    "Load",
    "LoadDrive",
    "Marker",
    "Material",
    "Membrane",
    "Mount",
    "Obstacle",
    "ObstacleShape",
    "Pin",
    "PinDrive",
    "Plane",
    "PoseTarget",
    "PrandtlElement",
    "PronyTerm",
    "Robot",
    "RobotReader",
    "Rod",
    "Sensor",
    "SensorKind",
    "SheetSide",
    "Source",
    "SurfaceSketch",
    "TablesFile",
    "Volume",
    "Winch",
    "check_winch_bodies",
    "choose_plane",
    "closed_mesh",
    "comments",
    "describe_cable_side",
    "describe_filled_holes",
    "direction_of",
    "edge_points",
    "find_far_targets",
    "find_mirror",
    "find_part_facets",
    "find_rings",
    "find_risks",
    "fit_winch_bodies",
    "gallery_folder",
    "get_material",
    "gravity_along",
    "inflate_outline",
    "inflated_robot",
    "is_of_gallery",
    "lay_cables_on_skin",
    "limit_travels",
    "list_gallery",
    "load_robot",
    "lost_comments",
    "measure_asymmetry",
    "merged_text",
    "obstacle_lines",
    "own_materials",
    "rims",
    "robot_hash",
    "robot_text",
    "save_own_material",
    "save_robot",
    "scaled_robot",
    "sewn_robot",
    "sewn_sides",
    "sketch_mesh",
    "sketch_robot",
    "with_fixed_drives",
    "with_values",
]

open_package(__name__)
