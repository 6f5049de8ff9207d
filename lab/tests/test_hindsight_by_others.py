"""The method against others' code and another implementation. Oracles: stable-baselines3's replay buffer, torch.nn."""

from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from hydrostat_lab.hindsight_ddpg import DdpgOptions, HindsightDdpg, rewards  # noqa: E402
from hydrostat_lab.trials import Trials  # noqa: E402

STEPS = 4


class Numbered(Trials):
    """Each place that is reached is a number of its own; goals are below 0."""

    states = goals = actions = 1
    horizon = STEPS

    def __init__(self) -> None:
        self.at = 0.0

    def begin(self, draw, shape):
        self.at += 1.0
        here = torch.full((*shape, 1), self.at)
        return here, here, -torch.rand(*shape, 1, generator=draw)

    def act(self, acts):
        self.at += 1.0
        here = torch.full_like(acts, self.at)
        return here, here

    def distances(self, reached, goals):
        return (reached - goals).abs()[..., 0]


OPTIONS = DdpgOptions(layers=(7, 5), random=1.0, actions=STEPS, tolerance=1.5)


def counted(step: np.ndarray, ahead: np.ndarray) -> np.ndarray:
    """Share of transitions by the step they begin at and how many steps later their goal was reached, -1: their own."""
    table = np.zeros((STEPS, STEPS + 1))
    np.add.at(table, (step.astype(int), ahead.astype(int) + 1), 1.0)
    return table / len(step)


def test_goals_are_taken_as_often_as_by_stable_baselines3() -> None:
    """Shares of each step and goal of 40,000 transitions of the same episodes, and the rewards of the other's."""
    buffers = pytest.importorskip("stable_baselines3.her.her_replay_buffer", reason="no stable-baselines3")
    gymnasium = pytest.importorskip("gymnasium")
    from stable_baselines3.common.vec_env import DummyVecEnv

    learner, episodes = HindsightDdpg(Numbered(), OPTIONS, seeds=1, epochs=1), 10
    for _ in range(episodes):
        learner._roll_out()

    box = gymnasium.spaces.Box(-1e3, 1e3, (1,))

    class Scored(gymnasium.Env):
        observation_space = gymnasium.spaces.Dict(observation=box, achieved_goal=box, desired_goal=box)
        action_space = gymnasium.spaces.Box(-1, 1, (1,))

        def compute_reward(self, achieved, desired, info):
            return -(np.abs(achieved - desired) >= 1.5).astype(float)[..., 0]

    env = DummyVecEnv([Scored])
    other = buffers.HerReplayBuffer(
        100, env.observation_space, env.action_space, env=env, n_sampled_goal=4, goal_selection_strategy="future"
    )
    reached, goals = learner._reached[0, :episodes].numpy(), learner._goals[0, :episodes].numpy()
    for episode in range(episodes):
        for step in range(STEPS):
            now, after = (
                {"observation": at, "achieved_goal": at, "desired_goal": goals[episode][None]}
                for at in (reached[episode, step][None], reached[episode, step + 1][None])
            )
            act = learner._acts[0, episode, step].numpy()[None]
            other.add(now, after, act, -np.ones(1), np.array([step == STEPS - 1]), [{}])

    np.random.seed(0)  # noqa: NPY002
    theirs = other.sample(40_000)
    begun = theirs.observations["observation"].numpy()[:, 0]
    after, goal = theirs.next_observations["achieved_goal"].numpy()[:, 0], theirs.observations["desired_goal"].numpy()
    wanted = counted((begun - 1) % (STEPS + 1), np.where(goal[:, 0] < 0, -1, goal[:, 0] - after))

    state, _, following, ours_reached, ours_goal = (part.numpy()[0, :, 0] for part in learner._drawn(40_000))
    found = counted((state - 1) % (STEPS + 1), np.where(ours_goal < 0, -1, ours_goal - ours_reached))
    assert (following == ours_reached).all()
    np.testing.assert_allclose(found, wanted, atol=0.007)
    assert found[0, 1:] == pytest.approx(np.full(STEPS, 0.25 * 0.8 / STEPS), abs=0.007)

    far = torch.tensor(np.abs(after - goal[:, 0]))
    scored = rewards(far, torch.tensor(1.5), shaped=False).numpy()
    np.testing.assert_array_equal(scored, theirs.rewards.numpy()[:, 0])
    assert 0.2 < -scored.mean() < 0.8


def module(numbers: list, seed: int, *, squash: bool) -> "torch.nn.Sequential":
    """A network of one seed, of torch's own layers."""
    layers: list[torch.nn.Module] = []
    for weight, bias in zip(numbers[::2], numbers[1::2], strict=True):
        layer = torch.nn.Linear(weight.shape[1], weight.shape[2])
        layer.weight.data, layer.bias.data = weight.detach()[seed].T.clone(), bias.detach()[seed, 0].clone()
        layers += [layer, torch.nn.ReLU()]
    return torch.nn.Sequential(*layers[:-1], *([torch.nn.Tanh()] if squash else []))


@pytest.mark.parametrize("shaped", [False, True])
@pytest.mark.parametrize("cut", [False, True])
def test_an_update_is_that_of_networks_written_out(shaped: bool, cut: bool) -> None:
    """One step of critic and actor and then of the targets, for each of three seeds with numbers of their own."""
    options = replace(OPTIONS, shaped=shaped, cut=cut, penalty=0.7, actor_rate=2e-3, critic_rate=5e-3, polyak=0.9)
    learner = HindsightDdpg(Numbered(), options, seeds=3, epochs=1)
    draw = torch.Generator().manual_seed(4)
    with torch.no_grad():
        for part in (*learner._followers[0], *learner._followers[1]):
            part += 0.3 * torch.randn(part.shape, generator=draw)
    state, after, reached, goal = (5.0 * torch.rand(3, 64, 1, generator=draw) for _ in range(4))
    act = 2.0 * torch.rand(3, 64, 1, generator=draw) - 1.0
    for running, values in ((learner.policy.states, state), (learner.policy.goals, goal)):
        running.see(values[:, :40])
    learner._drawn = lambda count: (state, act, after, reached, goal)  # type: ignore[method-assign]
    before = [
        [module(some, seed, squash=not at % 2) for seed in range(3)]
        for at, some in enumerate([learner.policy.numbers, learner._critic, *learner._followers])
    ]
    learner._update()
    learner._follow()

    cuts = 0
    for seed in range(3):
        actor, critic, late_actor, late_critic = (each[seed] for each in before)

        def scaled(values: torch.Tensor, of: torch.Tensor) -> torch.Tensor:
            known = of[:40].numpy().astype(float)
            spread = max(known.std(), 0.01)
            return torch.tensor(np.clip((values.numpy() - known.mean()) / spread, -5, 5), dtype=torch.float32)

        wanted = scaled(goal[seed], goal[seed])
        seen = torch.cat([scaled(state[seed], state[seed]), wanted], 1)
        then = torch.cat([scaled(after[seed], state[seed]), wanted], 1)
        far = (reached[seed] - goal[seed]).abs()
        reward = -far if shaped else -(far >= 1.5).float()
        with torch.no_grad():
            target = reward + 0.75 * late_critic(torch.cat([then, late_actor(then)], 1))
            cuts += int(((target > 0) | (target < -4)).sum())
            target = target.clamp(-4.0, 0.0) if cut else target
        step = torch.optim.Adam(critic.parameters(), lr=5e-3)
        torch.nn.functional.mse_loss(critic(torch.cat([seen, act[seed]], 1)), target).backward()
        step.step()
        step = torch.optim.Adam(actor.parameters(), lr=2e-3)
        chosen = actor(seen)
        (0.7 * chosen.square().mean() - critic(torch.cat([seen, chosen], 1)).mean()).backward()
        step.step()
        for numbers, network, slow, late in (
            (learner.policy.numbers, actor, learner._followers[0], late_actor),
            (learner._critic, critic, learner._followers[1], late_critic),
        ):
            ours, theirs = module(numbers, seed, squash=False), network
            behind = module(slow, seed, squash=False)
            rows = zip(ours.parameters(), theirs.parameters(), behind.parameters(), late.parameters(), strict=True)
            for found, oracle, follower, was in rows:
                np.testing.assert_allclose(found.detach(), oracle.detach(), atol=2e-5)
                np.testing.assert_allclose(follower.detach(), 0.9 * was.detach() + 0.1 * oracle.detach(), atol=2e-5)
    assert cuts > 0  # or cutting would not have been tried
