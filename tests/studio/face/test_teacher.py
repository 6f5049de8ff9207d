"""The page of a teacher, without a browser. Oracle: the work that is begun, and the buttons."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from nicegui import Client, core, events, ui

from hydrostat.robot import gallery_folder
from hydrostat.studio.face.classroom import Classroom
from hydrostat.studio.face.rooms import Rooms, new_key
from hydrostat.studio.face.teacher import build_teacher
from hydrostat.studio.jobs import Jobs, JobState


class NotedJobs(Jobs):
    """Begins no process, and notes what is asked."""

    asked: list[str]

    def start(self, title: str, *arguments: Any, **calls: Any) -> None:
        self.asked.append(title)
        self.state = JobState(title=title)

    def stop(self) -> None:
        self.asked.append("stop")


def test_a_double_click_on_pack_packs_once(tmp_path: Path) -> None:
    classroom = Classroom(Rooms(state=tmp_path, first=gallery_folder("starfish")))
    classroom.jobs.__class__, classroom.jobs.asked = NotedJobs, []  # type: ignore[attr-defined]
    classroom.rooms.enter(new_key(), name="Ada")

    async def run() -> None:
        core.loop = asyncio.get_running_loop()
        client = Client(ui.page("/"), request=None)
        with client:
            build_teacher(classroom, "http://127.0.0.1/", "/pictures")

            def button(words: str) -> Any:
                (found,) = (
                    each for each in client.elements.values() if isinstance(each, ui.button) and each.text == words
                )
                return found

            pack, stop = button("Pack"), button("Stop")
            assert (pack.enabled, stop.visible) == (True, False)
            (listener,) = (each for each in pack._event_listeners.values() if each.type == "click")
            for _ in range(2):
                events.handle_event(
                    listener.handler, events.GenericEventArguments(sender=pack, client=client, args=None)
                )
            assert (pack.visible, pack.enabled, stop.visible) == (True, False, True), "Stop does not take its place"
        client.delete()

    try:
        with ThreadPoolExecutor(1) as apart:
            apart.submit(lambda: asyncio.run(run())).result()
    finally:
        classroom.close()
        classroom.rooms.close()
    assert classroom.jobs.asked == ["Packing"]  # type: ignore[attr-defined]
