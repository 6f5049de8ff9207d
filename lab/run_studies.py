"""Run the studies that need no other simulator, model or training, in sizes that end in minutes; prints their tables.

    python lab/run_studies.py [--full] [--jobs 2] [--logs build/studies] [STUDY ...]

Each study is a program of its own. One that fails does not end the others: a line for each says how it ended, and its
output is in the folder of logs. Ends with 1 if one failed. With --full each runs in its own default size, for hours.
"""

import argparse
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

LAB = Path(__file__).resolve().parent
STUDIES: dict[str, str] = {
    "ablation/ablation": "--count 5",
    "ablation/newton_steps": "--count 4 --only starfish",
    "cable_friction/friction": "--quick",
    "coarseness/coarseness": "",
    "coarseness/pins": "",
    "coarseness/space": "",
    "designs/design_random": "--count 20 pig",
    "designs/designs": "--bodies pig --random 20",
    "designs/drawn_networks": "puppy",
    "faults/faults": "mutations --count 60",
    "flat_or_round/flat_or_round": "--bodies starfish",
    "gallery_poses/example_poses": "--quick",
    "gallery_poses/gallery_poses": "trunk",
    "gallery_poses/thumbs": "--count 9",
    "grasping/causes": "caging_gripper --factors friction --step 8",
    "grasping/grasp": "caging_gripper --closings 1 --step 8",
    "grasping/objects": "",
    "grasping/pen": "--friction 0.5",
    "grasping/sequences": "rock --friction 0.5",
    "hidden_twins/hidden_twins": "--twins 1",
    "house/house": "--no-flows",
    "hysteresis_and_walking/walk": "--tries 2 --cycles 3",
    "ik_methods/ik_methods": "starfish --count 5",
    "ik_methods/ik_sofa": "--repeats 2",
    "kits/kits": "--robots starfish",
    "kits/motor_kits": "--robots starfish --motors n20",
    "kits/shared_winches": "",
    "large_bodies/factorization": "--repeat 3 --largest 2000",
    "large_bodies/large": "--sizes 4.7",
    "large_bodies/many": "--poses 40 --rounds 1 --bodies starfish",
    "locking/bending": "",
    "locking/locking": "--repeat 2 --random 5",
    "motors/homing": "XL330",
    "motors/moves_alone": "esp32s3 60",
    "moulds/moulds": "trunk",
    "path_dependence/path_dependence": "starfish --count 4 --random 1",
    "proposals/drag": "starfish --steps 60",
    "proposals/proposals": "--robots starfish --rounds 1",
    "push_and_twist/twist": "caging_gripper --step 0.05",
    "push_and_twist/twist_learning": "--draws 2 --search 0",
    "reinforcement/learning_costs": "",
    "sewn/sewn": "whale fish --size 200,60",
    "shared_body/shared_body": "",
    "strangers/strangers": "kinds reports",
    "teleoperation/glove": "",
    "teleoperation/glove_delay": "--moves 5",
    "teleoperation/ten_winches": "--seconds 10",
    "time_integration/dynamics": "--quick",
}
"""Studies with their arguments for a short run, by file."""

NEED_MORE = {
    "classroom/classroom": "the extra studio, and a machine without other work",
    "designs/design_held_out": "hours",
    "designs/design_meshes": "a design",
    "hysteresis_and_walking/hysteresis": "PyTorch",
    "hysteresis_and_walking/walk_learned": "PyTorch and stable-baselines3",
    "learned_ik/learned_doubt": "a robot, samples or a model",
    "learned_ik/learned_drag": "a robot, samples or a model",
    "learned_ik/learned_finer": "a robot, samples or a model",
    "learned_ik/learned_ik": "a robot, samples or a model",
    "learned_ik/learned_speed": "a robot, samples or a model",
    "learned_ik/learned_steps": "a robot, samples or a model",
    "learned_ik/learned_tensions": "a robot, samples or a model",
    "learned_ik/learned_thesis": "a robot, samples or a model",
    "learned_ik/sample_starts": "a robot and samples",
    "peers/peers": "other simulators",
    "push_and_twist/push_learning": "PyTorch and stable-baselines3",
    "reinforcement/equal_networks": "PyTorch and a model",
    "reinforcement/large_curricula": "PyTorch and a model",
    "solver_floor/floor": "a C++ trial",
    "spool_layers/spool_layers": "a robot",
    "teleoperation/glove_poses": "poses of `hydrostat mimic`",
    "tetwild/tetwild": "fTetWild",
}
"""Studies that are run by hand, with what they need."""


def run_study(name: str, arguments: list[str], logs: Path) -> bool:
    """Run one study, write its output to a log, print how it ended; return True if it did not fail."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    began = time.monotonic()
    log = logs / f"{Path(name).name}.txt"
    with log.open("w", encoding="utf-8") as output:
        command = [sys.executable, str(LAB / f"{name}.py"), *arguments]
        code = subprocess.run(command, env=environment, stdout=output, stderr=subprocess.STDOUT, check=False).returncode
    print(f"| {name} | {' '.join(arguments)} | {time.monotonic() - began:.0f} | {code} |", flush=True)
    return code == 0


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("studies", nargs="*", metavar="STUDY", help="names such as friction; all if left out")
    parser.add_argument("--full", action="store_true", help="in the size of each study's own defaults")
    parser.add_argument("--jobs", type=int, default=1, help="studies at a time; more than one disturbs timings")
    parser.add_argument("--logs", type=Path, default=Path("build/studies"), help="folder of their output")
    options = parser.parse_args()
    chosen = {
        name: [] if options.full else words.split()
        for name, words in STUDIES.items()
        if not options.studies or Path(name).name in options.studies
    }
    if missing := set(options.studies) - {Path(name).name for name in chosen}:
        parser.error(f"unknown study {', '.join(sorted(missing))}. Available: {', '.join(map(_stem, STUDIES))}.")
    options.logs.mkdir(parents=True, exist_ok=True)
    print("| study | arguments | s | exit code |\n|---|---|---|---|", flush=True)
    with ThreadPoolExecutor(options.jobs) as pool:
        ended = list(pool.map(lambda name: run_study(name, chosen[name], options.logs), chosen))
    for name in chosen:
        print(f"\n## {name}\n\n{(options.logs / f'{_stem(name)}.txt').read_text(encoding='utf-8')}")
    print(f"{sum(ended)} of {len(ended)} studies ended well; logs in {options.logs}")
    return 0 if all(ended) else 1


def _stem(name: str) -> str:
    return Path(name).name


if __name__ == "__main__":
    sys.exit(main())
