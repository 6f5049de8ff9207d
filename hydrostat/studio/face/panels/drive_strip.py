"""`drive_strip`: the timeline below the view, with its buttons."""

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from nicegui import events, ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.driving.film import FilmKind, film_kinds
from hydrostat.studio.face.elements import TimelineView
from hydrostat.studio.face.messages import sent_number
from hydrostat.studio.face.page import WindowPage, icon_button, name_upload, show_heading
from hydrostat.studio.session import Tone

SPEEDS = {0.1: "0.1x", 0.25: "0.25x", 0.5: "0.5x", 1.0: "1x", 2.0: "2x", 4.0: "4x"}

FILMS = {
    FilmKind.GIF: "GIF, for web pages",
    FilmKind.MP4: "MP4 (needs ffmpeg)",
    FilmKind.GLB: "GLB, for Blender and 3D viewers",
}

Part = TypeVar("Part", bound=ui.element)


def drive_strip(page: WindowPage) -> None:
    """Build it."""
    with ui.element("div").classes("studio-row studio-strip").style("padding: 6px 14px 0 12px; gap: 4px; height: 44px"):
        _player(page)
        ui.space()
        _keys(page)
        ui.separator().props("vertical").style("margin: 6px 6px")
        _poses(page)
        _films(page)
        _tables(page)
    _timeline(page)


def _player(page: WindowPage) -> None:
    """Play, loop, time, length, speed."""
    driver = page.session.driver
    play = ui.button(icon="play_arrow", on_click=page.doing(driver.toggle))
    play.props('unelevated round dense aria-label="Play"')
    release_focus(play).tooltip("Play or stop (Space)").mark("drive-play")
    loop = _button("repeat", "Loop", lambda: page.act(driver.set_loop, not driver.player.loop))
    time = ui.label().classes("studio-figure").style("width: 58px; text-align: right; white-space: nowrap")
    time.mark("drive-time")
    ui.label("of").classes("studio-hint")
    length = ui.number(min=0.1, max=600, step=0.5, format="%.4g")
    length.props(
        'dense borderless debounce=500 aria-label="Length of the timeline"'
        ' input-style="appearance: textfield; text-align: right"'
    ).style("width: 40px")
    length.mark("drive-length")
    ui.label("s").classes("studio-hint")
    ui.separator().props("vertical").style("margin: 6px 10px 6px 4px")
    speed = ui.select(SPEEDS, value=1.0, on_change=lambda event: page.act(driver.set_speed, event.value))
    speed.props('dense borderless options-dense aria-label="Speed"').style("width: 62px")

    def set_length(event: events.GenericEventArguments) -> None:
        seconds = sent_number(event.args)
        if seconds is not None:
            page.act(driver.keyframes.set_length, seconds)

    length.on("update:model-value", set_length)  # only what a person types comes this way

    def show() -> None:
        player = driver.player
        play.set_icon("pause" if player.playing else "play_arrow")
        loop.style(f"color: var(--{'accent' if player.loop else 'muted'})")
        loop.props(f'aria-pressed="{str(player.loop).lower()}"')
        time.set_text(f"{player.time:.2f} s")
        if player.speed in SPEEDS:
            speed.set_value(player.speed)

    def show_length() -> None:
        length.set_value(driver.keyframes.timeline.seconds)

    length.on("blur", show_length)
    page.on(Topic.DRIVE, show)
    page.on(Topic.ROBOT, show_length)


def _keys(page: WindowPage) -> None:
    """Add, duplicate, delete; linear or smooth."""
    driver = page.session.driver
    add = ui.button("Add", icon="add", on_click=page.doing(driver.add_key)).props("unelevated dense no-caps no-wrap")
    add.style("padding: 2px 12px 2px 8px; flex: none")
    release_focus(add).tooltip("Add the knob positions as a keyframe at the playhead").mark("drive-add")
    copy = _button("content_copy", "Duplicate keyframe", page.doing(driver.duplicate_key))
    delete = _button("delete_outline", "Delete keyframe", page.doing(driver.delete_key))
    smooth = ui.toggle({False: "Linear", True: "Smooth"}, value=False)
    smooth.props(
        "dense no-caps unelevated toggle-color=primary color=transparent text-color=grey padding='2px 9px'"
    ).style("border: 1px solid var(--line); border-radius: 8px; margin-left: 6px")
    smooth.props('role="group" aria-label="Between keyframes"')
    release_focus(smooth).on_value_change(lambda event: page.act(driver.keyframes.set_smooth, bool(event.value)))

    def show() -> None:
        chosen = driver.keyframes.chosen_index is not None
        copy.set_enabled(chosen)
        delete.set_enabled(chosen)
        smooth.set_value(driver.keyframes.timeline.smooth)

    page.on((Topic.DRIVE, Topic.ROBOT), show)


def _poses(page: WindowPage) -> None:
    """Keys from stored poses."""
    driver, document = page.session.driver, page.session.document
    button = _button("accessibility_new", "Keyframe from a pose", None)
    with button:
        menu = _menu()

    async def add(name: str) -> None:
        button.props("loading")
        words = await page.act_slowly(driver.key_from_pose, name)
        button.props(remove="loading")
        if words:
            page.tell(words, Tone.GOOD)

    def build() -> None:
        for name in document.robot.poses:
            ui.menu_item(name, on_click=partial(add, name))
        if not document.robot.poses:
            ui.menu_item("No poses yet. Store one in Pose.", auto_close=True).props("disable")

    page.on_new(Topic.ROBOT, lambda: tuple(document.robot.poses), menu, build)


def _films(page: WindowPage) -> None:
    """Record a film, see how far it is, take it home."""
    recorder = page.session.driver.recorder
    asked: list[Any] = []
    with ui.element("div").classes("studio-row").style("width: 168px; gap: 6px") as busy:
        words = ui.label().classes("studio-hint").style("white-space: nowrap; flex: 1; text-align: right")
        _button("close", "Stop recording", recorder.stop)
    button = _button("movie", "Record video", None)

    def start(kind: FilmKind) -> None:
        asked[:] = [recorder.latest]
        page.act(recorder.start, kind)

    def save() -> None:
        if recorder.latest is not None:
            ui.download.content(recorder.latest.content, recorder.latest.name)

    with button, _menu():
        for kind, title in FILMS.items():
            item = ui.menu_item(title, on_click=partial(start, kind)).mark(f"film-{kind}")
            item.set_enabled(kind in film_kinds())
        again = ui.menu_item("", on_click=save)

    def show() -> None:
        state, latest = recorder.state, recorder.latest
        running = state is not None and state.running
        busy.set_visibility(running)
        button.set_visibility(not running)
        again.set_visibility(latest is not None)
        if state is not None and running:
            words.set_text(f"{state.stage} {100 * state.done // state.total if state.total else 0} %")
        if latest is not None:
            again.clear()
            with again:
                ui.label(f"Download {latest.name} again")
        if asked and not running:
            before = asked.pop()
            if latest is not None and latest is not before:
                save()
                page.tell(f"{latest.name}: {len(latest.content) / 1e6:.1f} MB", Tone.GOOD)
            elif state is not None and state.error:
                page.tell(state.error, Tone.BAD)

    page.on((Topic.JOB, Topic.DRIVE), show)


def _tables(page: WindowPage) -> None:
    """Contractions as a CSV."""
    session = page.session
    driver = session.driver

    def export() -> None:
        content = page.act(driver.table)
        if content is not None:
            ui.download.content(content, f"{session.document.robot.name}.csv")

    largest = 4_000_000  # no table is larger [bytes]
    with ui.dialog() as dialog, ui.card().classes("q-pa-md").style("min-width: 380px"):
        show_heading("Import contractions", 1)
        ui.label("A table with the column time_s and a column for each winch, under its name, in millimeters. "
                 "It replaces the keyframes; undo restores them.").classes("studio-hint")  # fmt: skip

        async def load(event: events.UploadEventArguments) -> None:
            content = await event.file.read()
            upload.reset()
            dialog.close()
            page.act(driver.load_table, event.file.name, content)

        upload = ui.upload(
            label="Choose or drop a CSV", auto_upload=True, max_file_size=largest, on_upload=load,
            on_rejected=lambda: page.tell("a table may have 4 MB", Tone.BAD),
        ).props("accept=.csv flat bordered").classes("w-full")  # fmt: skip
        name_upload(upload, "Choose a CSV")
    with _button("table_view", "Contraction table", None), _menu():
        ui.menu_item("Export CSV", on_click=export).mark("drive-export")
        ui.menu_item("Import CSV", on_click=dialog.open)


def _timeline(page: WindowPage) -> None:
    """The keys in time."""
    driver, document = page.session.driver, page.session.document
    view = TimelineView().style("width: 100%; padding-bottom: 6px").mark("drive-timeline")
    view.on_word("seek", lambda time: page.act(driver.seek, time), "time")
    view.on_word("choose", lambda index: page.act(driver.choose, int(index)), "index")
    view.on_word("move", lambda index, time: page.act(driver.move_key, int(index), time), "index", "time")
    view.on_word("drop", page.doing(driver.drop_key))

    def add(time: float) -> None:
        page.act(driver.seek, time)
        page.act(driver.add_key)

    view.on_word("add", add, "time")

    def show() -> None:
        view.show_keys(document.robot, driver.keyframes.timeline, driver.keyframes.chosen_index)
        view.show_player(driver.player)

    page.on((Topic.ROBOT, Topic.DRIVE), show)


def _menu() -> ui.menu:
    """One that opens upwards: below the strip is no room."""
    return ui.menu().props('anchor="top right" self="bottom right"')


def _button(icon: str, words: str, action: Callable[[], Any] | None) -> ui.button:
    return release_focus(icon_button(icon, words, action).classes("studio-tool"))


def release_focus(part: Part) -> Part:
    """Release the keyboard focus after a mouse click, so that Space still plays."""
    part.on("mousedown", js_handler="(event) => event.preventDefault()")
    return part
