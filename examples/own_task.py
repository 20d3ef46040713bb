"""A sense, a reward and a start of your own: trains on the compiled arms, then runs the same task on the Diagram."""

from dataclasses import dataclass, replace

from drakearm.experiments import load_scenario, make_task_env
from drakearm.learning import ArmVectorEnv, PpoSettings, train
from drakearm.model import load_arm
from drakearm.planning import plan
from drakearm.task import OBSERVATIONS, Reward, Sense, Start, StartState

POWER = Sense(  # that the fibers deliver, over 1 kW
    "power",
    reads=("tendon_force", "fiber_velocity"),
    calc=lambda force, velocity: -(force * velocity).sum(axis=-1, keepdims=True),
    size=1,
    scale=lambda arm: 1e-3,
)


@dataclass(frozen=True)
class TrackWithLittleEffort(Reward):
    """Minus the squared errors of the joint angles, minus the squared excitations times their weight."""

    type = "little_effort"  # a scenario file can then say reward: {type: little_effort, effort: 0.01}
    reads = ("arm_state", "reference", "excitation")
    effort: float

    def __call__(self, arm_state, reference, excitation):
        n_q = arm_state.shape[-1] // 2
        error = (reference - arm_state)[..., :n_q]
        return -(error**2).sum(axis=-1) - self.effort * (excitation**2).sum(axis=-1)


@dataclass(frozen=True)
class Anywhere(Start):
    """At a random sample of the reference, moving as it does (Peng et al. 2018)."""

    def __call__(self, reference, rng):
        step = 0 if rng is None else int(rng.integers(len(reference.t) - 1))
        return StartState(reference.q[step], reference.v[step], activation=0.1, step=step)


def main(settings: PpoSettings) -> float:
    scenario = load_scenario("timing-0.7s")
    task = scenario.task(plan(load_arm("arm14"), scenario.movement).reference)
    task = replace(task, senses=(*OBSERVATIONS["full"], POWER), reward=TrackWithLittleEffort(0.01), start=Anywhere())
    policy = train(ArmVectorEnv(task, settings.environments), settings, seed=0)
    env = make_task_env(task)
    observation, _ = env.reset(seed=0)
    total, ended = 0.0, False
    while not ended:
        observation, reward, _, ended, _ = env.step(policy.act(observation))
        total += reward
    print(f"observations of {len(observation)} numbers, return of one episode on the Diagram {total:.3f}")
    return total


if __name__ == "__main__":
    main(PpoSettings(imitation_rounds=0, initial_std=0.3))
