"""`print_steps`: from the files of a printed body to a robot. Times are estimates; none was measured."""

from hydrostat.fabrication.cable_work import CableWork
from hydrostat.fabrication.kit_plan import KitPlan
from hydrostat.fabrication.sheets.steps import AssemblyStep, insert_steps, minutes_text, tie_step, winch_steps


def print_steps(plan: KitPlan) -> tuple[AssemblyStep, ...]:
    """Steps from the files to a robot."""
    work = CableWork.of_robot(plan.drawn, plan.options)
    material = plan.robot.body.material.name or "the material of the robot file"
    return (
        AssemblyStep(
            "Print body and parts",
            15,
            f"body/plate_1.3mf in {material}, as it lies: 0.2 mm layers, 100 % infill, no supports. Dry the filament. "
            "Print slowly, 20 to 30 mm/s: thin hinges must not string. Print the parts (parts/plate_1.3mf) in PLA.",
            wait=f"about {minutes_text(60 * sum(part.volume for part in plan.work.printed) / 7.5e3)} of printing",
        ),
        AssemblyStep("Clear slits and holes", 15, "Cut strings in the slits. Push a wire of 1 mm through each hole."),
        *insert_steps(plan),
        *(
            AssemblyStep(title, minutes, text)
            for title, minutes, text in (
                (
                    "Cut the cables",
                    work.cut,
                    "Cut lines to lists/cable_cuts.csv. Mark the spool mark with a pen, from the end that gets the "
                    "stopper; tape numbers to the ends.",
                ),
                (
                    "Thread the cables",
                    work.route,
                    "Push a thin wire through the hole from the last point to the first, tie the line to it and draw "
                    "the line through. Put the stopper on loosely at the last point.",
                ),
            )
            if plan.robot.cables
        ),
        *winch_steps(plan),
        *((tie_step(plan),) if plan.robot.cables else ()),
    )
