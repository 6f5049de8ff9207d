"""What a robot is: frozen records, checked when made, and the robot.toml they live in."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.robot.body import Body, Source, Volume, mesh_body, outline_body
    from hydrostat.robot.cable import Cable
    from hydrostat.robot.checks import Point
    from hydrostat.robot.closed_mesh import ClosedMesh, closed_mesh
    from hydrostat.robot.contact import Contact, Obstacle, ObstacleShape
    from hydrostat.robot.face import Face
    from hydrostat.robot.gallery import gallery_folder, gallery_names
    from hydrostat.robot.gravity import STANDARD_GRAVITY
    from hydrostat.robot.inflated import inflated_robot
    from hydrostat.robot.marker import Marker, Pose
    from hydrostat.robot.materials import MATERIALS, Material, Relaxation, find_material
    from hydrostat.robot.obstacle_lines import obstacle_lines, rims
    from hydrostat.robot.pin import Pin
    from hydrostat.robot.read import load_robot
    from hydrostat.robot.risks import find_risks
    from hydrostat.robot.robot import Robot
    from hydrostat.robot.sewn import face_words, sewn_robot, sewn_sides
    from hydrostat.robot.sketch import sketch_robot
    from hydrostat.robot.sketch_space import SurfaceSketch, sketch_mesh, sketch_surface
    from hydrostat.robot.winch import Mount, Winch
    from hydrostat.robot.write import replace_file, robot_hash, robot_text, save_robot

__all__ = [
    "MATERIALS",
    "STANDARD_GRAVITY",
    "Body",
    "Cable",
    "ClosedMesh",
    "Contact",
    "Face",
    "Marker",
    "Material",
    "Mount",
    "Obstacle",
    "ObstacleShape",
    "Pin",
    "Point",
    "Pose",
    "Relaxation",
    "Robot",
    "Source",
    "SurfaceSketch",
    "Volume",
    "Winch",
    "closed_mesh",
    "face_words",
    "find_material",
    "find_risks",
    "gallery_folder",
    "gallery_names",
    "inflated_robot",
    "load_robot",
    "mesh_body",
    "obstacle_lines",
    "outline_body",
    "replace_file",
    "rims",
    "robot_hash",
    "robot_text",
    "save_robot",
    "sewn_robot",
    "sewn_sides",
    "sketch_mesh",
    "sketch_robot",
    "sketch_surface",
]

open_package(__name__)
