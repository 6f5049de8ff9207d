"""Print what supervised networks leave after as many pairs as the thesis's trial and error took (Fig 5.14).

    python lab/reinforcement/equal_networks.py build/hand.model

The 4 x 30 network is that of trial and error. Pairs are drawn evenly; errors are of 1,000 unseen goals, in the
networks of the model: interquartile means of three seeds, with their 95 % intervals.
"""

import sys
import time
from pathlib import Path

from hydrostat.learning import LearnedModel
from hydrostat_lab.policies import Budget, clone_actions, clone_small, drawn_pairs
from hydrostat_lab.run_experiment import finger_pairs
from hydrostat_lab.shared_data import expected_errors
from hydrostat_lab.trial_tables import format_interval
from hydrostat_lab.trials import NetworkReach
from hydrostat_lab.verdict import interquartile

SEEDS, PAIRS = 3, (6_000, 100_000)
WAYS = (("4 x 30", clone_small, 4_000), ("ours", clone_actions, 4_000), ("4 x 30", clone_small, 24_000))


def main() -> None:
    """Print the table."""
    model = LearnedModel.load(Path(sys.argv[1]))
    trials = NetworkReach(model, groups=finger_pairs(model))
    drawn = drawn_pairs(trials, SEEDS, PAIRS[-1])
    print(f"{model.card.robot}, networks of {model.card.samples} equilibria")
    print(f"{'network':10}{'pairs':>9}{'steps':>8}{'error [mm]':>21}{'CPU s':>8}")
    for name, way, steps in WAYS:
        for pairs in PAIRS:
            began = time.process_time()
            act = way(trials, drawn.first(pairs), Budget(steps=steps))
            found = interquartile(10.0 * expected_errors(trials, act, SEEDS).mean(axis=1))
            spent = time.process_time() - began
            print(f"{name:10}{pairs:9,}{steps:8,}{format_interval(found, 2):>21}{spent:8.0f}", flush=True)


if __name__ == "__main__":
    main()
