"""Train the policy of examples/python/27_policy.py: 6,000 actions, 8 minutes of a shared core.

pip install -e ".[rl]"
python examples/policies/train_starfish.py build/policy
"""

import sys
from pathlib import Path

import hydrostat as hs
from hydrostat.training import Listener, ReachEnv, ReachOptions, TrainOptions, held_out_goals, policy_of, train


def main() -> None:
    """Train, and write starfish_reach.policy into a folder."""
    folder = Path(sys.argv[1])
    env = ReachEnv(hs.load_robot("gallery:starfish"), options=ReachOptions(steps=10, incremental=True))
    options = TrainOptions(layers=(48, 48), steps=6000, learning_rate=2e-3)
    model, curve = train(env, held_out_goals(env, 20, 1), options, folder, listener=Listener(point=print))
    print(policy_of(model, env, task="reach", error=curve[-1].mean).save(folder / "starfish_reach.policy"))


if __name__ == "__main__":
    main()
