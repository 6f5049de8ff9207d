"""The panel of the stage "design": what is asked for, the search while it runs, and the networks to choose from."""

from functools import partial

from nicegui import ui

from hydrostat.design import DesignMethod
from hydrostat.drawing import Color
from hydrostat.studio.bell import Topic
from hydrostat.studio.designing.charts import front_chart, growth_chart
from hydrostat.studio.designing.design_work import Candidate
from hydrostat.studio.designing.run import ProgressPoint, share_done, time_left
from hydrostat.studio.face.page import WindowPage, pressable, show_heading
from hydrostat.studio.face.panels.design_limits import design_limits, design_paint
from hydrostat.studio.face.panels.design_method import design_method
from hydrostat.studio.face.panels.finding_list import finding_list
from hydrostat.studio.stage import StageName, format_error
from hydrostat.units import plural


def design_panel(page: WindowPage) -> None:
    """Build the panel."""
    show_heading("Design", 1)
    _poses(page)
    _counts(page)
    design_method(page)
    _go(page)
    _progress(page)
    design_paint(page)
    design_limits(page)
    show_heading("Design review")
    finding_list(page, lambda: page.session.designer.shown_robot)
    with page.bottom:
        design_compare(page)


def _poses(page: WindowPage) -> None:
    """The poses to reach, each to be left out or not."""
    document, designer = page.session.document, page.session.designer
    room = ui.column().classes("w-full gap-2")

    def state() -> tuple[object, ...]:
        return tuple(document.robot.poses), find_wished()

    def find_wished() -> frozenset[str]:
        robot = document.robot
        return frozenset(pose.name for pose in designer.wishes.to_poses(robot)) if robot.poses else frozenset()

    def build() -> None:
        names, on = document.robot.poses, find_wished()
        colors = Color.of_poses(names)
        if not names:
            _no_pose(page)
            return
        show_heading("Poses to reach").style("margin-top: 0")
        with ui.element("div").classes("row").style("gap: 6px"):
            for name in names:
                kind = "design-pose" + (" design-pose-on" if name in on else "")
                chip = pressable(kind, page.doing(designer.wish_pose, name, name not in on), role="checkbox")
                with chip.props(f'aria-checked="{str(name in on).lower()}"'):
                    if len(on) > 1 and name in on:  # the color of its targets in the view
                        ui.element("span").classes("design-dot").style(f"background: {colors[name]}")
                    ui.label(name)

    page.on_new(Topic.ROBOT, state, room, build)


def _no_pose(page: WindowPage) -> None:
    with ui.element("div").classes("studio-card column"):
        ui.label("No poses to design for yet.").style("font-weight: 600")
        ui.label("Drag the body to a target shape and store it as a pose.").classes("studio-hint")
        go = ui.button("Go to Pose", icon="back_hand", on_click=lambda: page.go(StageName.POSE))
        go.props('outline no-caps data-testid="design-to-pose"').classes("w-full")


def _counts(page: WindowPage) -> None:
    """Winches and cables, by steps."""
    designer = page.session.designer
    with ui.column().classes("w-full").style("gap: 4px"):
        winches = _stepper(page, "Winches", "winches", least=0)
        cables = _stepper(page, "Maximum cables", "cables", least=1)
    _simplicity(page)
    hint = ui.label("Fewest winches that reach every pose within the tolerance.").classes("studio-hint")

    def show() -> None:
        wishes = designer.wishes
        winches.set_text(str(wishes.winches) if wishes.winches else "auto")
        cables.set_text(str(wishes.cables))
        hint.set_visibility(wishes.winches == 0)

    page.on(Topic.ROBOT, show)


SIMPLICITIES = {"simple": 4.0, "balanced": 1.0, "exact": 0.0}
"""Label of each choice and its `RouteOptions.simplicity`; at 4 a cable must reduce the error by 8 %."""


def _simplicity(page: WindowPage) -> None:
    """One knob: from few cables and holes to whatever helps at all."""
    designer = page.session.designer
    choices = {value: words for words, value in SIMPLICITIES.items()}
    with ui.element("div").classes("studio-row") as row:
        ui.label("Complexity").classes("flex-1")
        wanted = designer.wishes.options.simplicity
        choice = ui.toggle(choices, value=wanted if wanted in choices else None)
        choice.props('dense no-caps unelevated padding="2px 10px"')
        choice.props("toggle-color=primary color=transparent text-color=primary toggle-text-color=white")
        choice.classes("design-toggle").props('data-testid="wish-simplicity" role="group" aria-label="Complexity"')
        with choice:  # above, for the button to begin with is below
            ui.tooltip("Simple: fewer cables and holes to sew, larger error. Exact: smallest error.").props(
                'anchor="top middle" self="bottom middle"'
            )

    def send(value: float | None) -> None:
        if value is not None and value != designer.wishes.options.simplicity:
            page.act(lambda: designer.wish(simplicity=float(value)))

    def show() -> None:
        wished = designer.wishes.options.simplicity
        choice.set_value(wished if wished in choices else None)
        row.set_visibility(designer.wishes.method is DesignMethod.ROUTES)

    choice.on_value_change(lambda event: send(event.value))
    page.on(Topic.ROBOT, show)


def _stepper(page: WindowPage, words: str, name: str, *, least: int) -> ui.label:
    designer = page.session.designer

    def step(change: int) -> None:
        page.act(lambda: designer.wish(**{name: max(least, getattr(designer.wishes, name) + change)}))

    number = ui.label().classes("design-number").props(f'data-testid="design-{name}" role="status"')
    with ui.element("div").classes("design-count") as row:
        ui.label(words).classes("design-name")
        for icon, change in (("remove", -1), ("add", 1)):
            if change > 0:
                number.move(row)
            button = ui.button(icon=icon, color=None, on_click=partial(step, change))
            words_of = "fewer" if change < 0 else "more"
            button.props(f'outline round size=sm aria-label="{words_of} {name}" data-testid="{words_of}-{name}"')
            button.style("color: var(--accent)")
    return number


def _go(page: WindowPage) -> None:
    """The button that everything here is for."""
    designer, jobs, document = page.session.designer, page.session.jobs, page.session.document
    button = ui.button("Design", icon="auto_awesome", on_click=page.doing(designer.design)).classes("design-go")
    button.props('unelevated no-caps data-testid="design-go"')

    def show() -> None:
        button.set_visibility(not designer.running)
        button.set_enabled(bool(document.robot.poses) and not jobs.is_running)

    page.on((Topic.JOB, Topic.ROBOT), show)


def _progress(page: WindowPage) -> None:
    """The search while it runs: the best error so far, how it fell, and a button that ends it."""
    designer, jobs = page.session.designer, page.session.jobs
    with ui.element("div").classes("studio-card column") as card:
        with ui.element("div").classes("studio-row").style("align-items: flex-end"):
            with ui.column().classes("flex-1").style("gap: 2px"):
                error = ui.label().classes("design-figure").props('data-testid="design-error"')
                count = ui.label().classes("studio-hint")
            stop = ui.button("Stop", icon="stop", on_click=page.doing(designer.stop))
            stop.props('flat no-caps color=negative data-testid="design-stop"')
            stop.tooltip("End the search and list its best network")
        chart = ui.html("", sanitize=False).classes("w-full")
        bar = ui.linear_progress(value=0.0, show_value=False).props('rounded size=6px aria-label="Search"')
        with ui.element("div").classes("studio-row").style("align-items: flex-start"):
            stage = ui.label().classes("studio-hint flex-1").style("min-width: 0").props('data-testid="design-stage"')
            stage.props("role=status")
            left = ui.label().classes("studio-hint studio-figure").props('data-testid="design-left"')
        take = ui.button("Take best", icon="check", on_click=page.doing(designer.take_best)).classes("w-full")
        take.props('unelevated no-caps data-testid="design-take"')
        take.tooltip("End the search and put its best network into the robot")
    outcome = ui.label().props('data-testid="design-outcome" role="status"')
    told: dict[float, float] = {}  # share of the search that was shown, by when it began: it never falls

    def show() -> None:
        state, run = jobs.state, designer.run
        card.set_visibility(designer.running)
        outcome.set_visibility(bool(designer.outcome) and not designer.running)
        outcome.set_text(f"{designer.outcome[:1].upper()}{designer.outcome[1:]}")
        failed = designer.has_failed
        outcome.classes(add="design-bad" if failed else "studio-hint", remove="studio-hint" if failed else "design-bad")
        if not designer.running or run is None or state is None:
            return
        best = run.trail[-1] if run.trail else None
        error.set_text("Searching" if best is None else f"{format_error(best.error)} as built")
        count.set_text(_so_far(best.winches, best.cables) if best else f"{1e3 * run.rest:.3g} mm error at rest")
        chart.set_content(growth_chart(run, designer.seconds))
        share = share_done(run.request, state.stage, state.done, state.total)
        if told.get(run.began, 0.0) > (share or 0.0):
            share = told[run.began]
        told.clear()
        told[run.began] = share or 0.0
        is_open = run.request.is_open
        bar.props(add="indeterminate" if is_open else "", remove="" if is_open else "indeterminate")
        bar.set_value(share or 0.0)
        stage.set_text("Finishing with the best so far" if state.stopping else _stage(state.stage, best))
        left.set_text("" if state.stopping else time_left(designer.seconds, share))
        stop.set_text("Stop now" if state.stopping else "Stop")
        take.set_enabled(best is not None and not state.stopping)

    page.on(Topic.JOB, show)
    ui.timer(1.0, lambda: show() if designer.running else None)


def _stage(stage: str, best: ProgressPoint | None) -> str:
    """Status of the search, and the source of its best network."""
    if best is None or not best.words:
        return stage
    tried = f" after {plural(best.num_evaluated, 'network')}" if best.num_evaluated else ""
    return f"{stage}. Last gain{tried}: {best.words}"


def _so_far(winches: int, cables: int) -> str:
    return f"with {plural(winches, 'winch')} and {plural(cables, 'cable')} so far"


def design_compare(page: WindowPage) -> None:
    """Build the strip below the view; it is not there while there is nothing to compare."""
    designer, document = page.session.designer, page.session.document
    room = ui.element("div").classes("w-full")

    def own() -> tuple[int, ...]:
        cables = document.robot.cables
        return tuple(one.number for one in designer.candidates if one.robot.cables == cables)

    def build() -> None:
        candidates = designer.candidates
        room.set_visibility(bool(candidates))
        if candidates:
            with ui.element("div").classes("design-strip"):
                _front(page, candidates)
                with ui.element("div").classes("design-shelf"):
                    _head(page, own())
                    _cards(page, candidates, own())

    def state() -> tuple[object, ...]:
        refused = tuple(bool(document.judge.is_refused(one.robot)) for one in designer.candidates)
        return tuple(one.number for one in designer.candidates), designer.chosen, designer.pose, own(), refused

    page.on_new((Topic.JOB, Topic.ROBOT), state, room, build)


def _front(page: WindowPage, candidates: tuple[Candidate, ...]) -> None:
    designer = page.session.designer
    with ui.element("div").classes("design-front"):
        show_heading(f"Error vs. {candidates[0].craft.work} time").style("margin: 0 0 8px")
        ui.html(front_chart(candidates, designer.trail, designer.chosen), sanitize=False).classes("w-full")


def _head(page: WindowPage, own: tuple[int, ...]) -> None:
    """The poses of the chosen network, and what can be done with it."""
    designer = page.session.designer
    chosen = designer.candidate
    with ui.element("div").classes("studio-row").style("min-height: 36px"):
        if chosen is None:
            ui.label("Select a network to show it").classes("studio-hint flex-1")
        else:
            with ui.element("div").classes("row flex-1").style("gap: 6px; min-width: 0"):
                _pose_chip(page, chosen, None, "rest")
                for reach in chosen.reaches:
                    _pose_chip(page, chosen, reach.pose.name, f"{reach.pose.name}, {format_error(reach.error)}")
        clear = ui.button("Clear", on_click=page.doing(designer.clear)).props("flat no-caps dense")
        clear.props('data-testid="design-clear"').tooltip("Clear results")
        accept = ui.button("Accept", icon="check", on_click=page.doing(designer.accept)).props("unelevated no-caps")
        accept.props('data-testid="design-accept"').tooltip("Use this network in the robot")
        accept.set_enabled(chosen is not None and chosen.number not in own)


def _pose_chip(page: WindowPage, chosen: Candidate, pose: str | None, words: str) -> None:
    designer = page.session.designer
    kind = "design-pose" + (" design-pose-on" if designer.pose == pose else "")
    chip = pressable(kind, page.doing(designer.show, chosen.number, pose))
    chip.props(f'aria-pressed="{str(designer.pose == pose).lower()}"')
    with chip.props(f'data-testid="design-show-{"rest" if pose is None else "pose"}"'):
        ui.label(words)


def _cards(page: WindowPage, candidates: tuple[Candidate, ...], own: tuple[int, ...]) -> None:
    designer = page.session.designer
    with ui.element("div").classes("design-cards"):
        for one in candidates:
            now = one.number == designer.chosen
            pose = designer.pose if now or designer.pose in {reach.pose.name for reach in one.reaches} else None
            show = page.doing(designer.show, one.number, pose)
            card = pressable("design-card" + (" design-card-on" if now else ""), show)
            card.props(f'aria-pressed="{str(now).lower()}"')
            with card.props('data-testid="design-card"').tooltip(_more(one)):
                ui.html(designer.sketch(one), sanitize=False).classes("w-full")
                ui.html(
                    _words(one, own, refused=bool(page.session.document.judge.is_refused(one.robot))), sanitize=False
                )


def _words(one: Candidate, own: tuple[int, ...], *, refused: bool) -> str:
    """Error once built, whether a kit is refused, counts, minutes, price, crossings if any, as lines of HTML."""
    craft = one.craft
    lines = [
        one.counts,
        f"{craft.minutes:.0f} min of {craft.work}",
        f"{craft.price:.0f} USD, {plural(craft.motors, 'motor')}",
    ]
    if craft.crossings:
        lines.append(plural(craft.crossings, "crossing"))
    if one.number in own or not one.complete:
        lines.append("in the robot" if one.number in own else "stopped early")
    mark = '<i class="design-bad">cannot be built</i>' if refused else ""
    return f"<b>{format_error(one.expected_error)} as built</b>{mark}" + "".join(
        f"<span>{line}</span>" for line in lines
    )


def _more(one: Candidate) -> str:
    """Details of a candidate for the tooltip of its card."""
    craft = one.craft
    return (
        f"Model error {format_error(one.error)}; {plural(craft.holes, 'hole')}, "
        f"{1e3 * one.length:.0f} mm of cable, maximum tension {one.tension:.1f} N. "
        "The price covers motors, power and cables. The kit's list adds cloth, screws and full packs"
    )
