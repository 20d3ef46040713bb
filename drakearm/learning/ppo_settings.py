"""The settings of PPO: those of drakearm, which are the defaults, and those of the paper."""

from typing import Annotated

from pydantic import Field, model_validator

from drakearm.files.checked_dataclass import checked_dataclass
from drakearm.files.fields import Finite, Fraction, Positive, Whole
from drakearm.learning.policy_file import Layers

_MOST_TRANSITIONS = 500_000  # per batch: more could exhaust the memory
_Std = Annotated[Positive, Field(ge=1e-6, le=1e6)]


@checked_dataclass()
class PpoSettings:
    """How to train. The defaults start from imitation. `PAPER`, as in the paper, starts from random weights."""

    batches: Annotated[Whole, Field(gt=0, le=1_000_000)] = 60  # rounds of collecting and updating
    environments: Annotated[Whole, Field(gt=0, le=4096)] = 64  # arms: the vector environment must hold as many
    steps: Annotated[Whole, Field(gt=0, le=100_000)] = 75  # control steps per environment and batch
    epochs: Annotated[Whole, Field(gt=0, le=100)] = 5  # passes over a batch
    minibatches: Annotated[Whole, Field(gt=0, le=10_000)] = 16  # parts of a batch; each is one update
    learning_rate: Annotated[Positive, Field(le=1.0)] = 3e-5  # the actor's in the first batch
    target_kl: Positive | None = 0.1  # nats per batch, held by the learning rate; None: this falls linearly to 0
    critic_learning_rate: Annotated[Positive, Field(le=1.0)] = 1e-3  # in the first batch; it falls linearly to 0
    critic_share: Fraction = 0.08  # of the batches, at the beginning, in which only the critic learns
    gamma: Fraction = 0.97  # discount per control step
    gae_lambda: Fraction = 0.95  # 0: one-step advantages, 1: returns minus values
    clip: Positive = 0.2  # epsilon: probability ratios that differ from 1 by more than this bring no more gain
    max_grad_norm: Positive = 0.5  # longer gradients are scaled down to this norm
    value_weight: Positive = 0.5  # factor of the loss of the critic, which is its mean squared error
    initial_std: _Std = 0.02  # standard deviation of the actions at the beginning, in their unit
    final_std: _Std | None = 0.001  # the same at the end, reached geometrically; None: it is learned
    imitation_rounds: Annotated[Whole, Field(ge=0, le=1_000_000)] = 4  # before PPO; 0: no imitation
    imitation_stiffness: Annotated[Positive, Field(ge=1.0, le=1e5)] = 400.0  # 1/s^2, of the expert's feedback
    initial_action: Finite = 0.15  # mean of the actions before the training, in their unit
    actor_layers: Layers = (64,) * 5  # widths of the hidden layers, tanh
    critic_layers: Layers = (64,) * 3  # widths of the hidden layers, PReLU

    @model_validator(mode="after")
    def _fits_into_memory(self) -> "PpoSettings":
        transitions = self.environments * self.steps
        if transitions > _MOST_TRANSITIONS:
            raise ValueError(
                f"found {self.environments} environments and {self.steps} steps, expected at most "
                f"{_MOST_TRANSITIONS:,} transitions per batch"
            )
        return self


PAPER = PpoSettings(
    batches=200,
    environments=32,
    epochs=5,
    minibatches=8,
    learning_rate=1e-3,
    target_kl=None,
    gamma=0.95,
    initial_std=0.3,
    final_std=0.015,
    critic_share=0.0,
    imitation_rounds=0,
)
