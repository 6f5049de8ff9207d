"""A program: a studio whose stages are toys, so that its tests wait for no solver. Prints its address."""

import sys
from collections.abc import Sequence
from dataclasses import replace

from hydrostat.robot import gallery_folder
from hydrostat.studio.face.classroom import Classroom
from hydrostat.studio.face.rooms import Rooms
from hydrostat.studio.face.serve import serve
from hydrostat.studio.session import Session
from hydrostat.studio.stage import Hit, Stage, StageName
from hydrostat.studio.view.robot_items import robot_items
from hydrostat.studio.view.scene_items import RobotShape, SceneItem, rest_shape


class Toy(Stage):
    """The body goes wherever the pointer is; the key "stumble" is a mistake of the program."""

    def __init__(self, session: Session) -> None:
        self.session, self.place = session, (0.0, 0.0)

    def shape(self) -> RobotShape:
        shape = rest_shape(self.session.document.robot)
        return replace(shape, nodes=shape.nodes + self.place)

    def scene_items(self) -> Sequence[SceneItem]:
        return robot_items(self.session.document.robot)

    def grab(self, hit: Hit) -> bool:
        if hit.key == "stumble":
            raise KeyError(hit.key)
        return True

    def drag(self, hit: Hit) -> None:
        self.place = hit.world


def main(host: str, many: str = "") -> None:
    """Serve until the program is ended; one room for all, or a class."""
    if many:
        rooms = Rooms(first=gallery_folder("starfish"))
        serve(rooms, host=host, show=False, classroom=Classroom(rooms, key="k" * 24), announce=announce)
        return
    session = Session()
    session.open_folder(gallery_folder("starfish"))
    session.stages = {**session.stages, StageName.POSE: Toy(session)}
    serve(Rooms(session), host=host, show=False, announce=announce)


def announce(address: str) -> None:
    """Tell who started this program."""
    sys.stdout.write(f"{address}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
