"""skrl on many arms at once: `FinalObservations` gives its agents the last observation of each episode.

Needs `pip install skrl`. `drakearm.learning` itself has its own PPO and does not need it.
"""

from typing import Any

import numpy as np
import torch


class FinalObservations:
    """Goes before an agent of skrl, so that it learns from the last observation of each episode:

        class ArmPPO(FinalObservations, PPO):
            pass

        env = wrap_env(ArmVectorEnv(task, 64), wrapper="gymnasium")
        agent = ArmPPO(..., cfg=PPO_CFG(time_limit_bootstrap=True))

    For vector environments that reset in the step in which an episode ends (AutoresetMode.SAME_STEP). What they return
    as the next observation is then the first one of the next episode. skrl's agents would take it for the one after the
    action, and PPO would add its value to the reward of a truncated episode. This class replaces it by
    `infos["final_obs"]`. PPO needs `time_limit_bootstrap` as well: without it, PPO does not see that an episode was
    truncated. There must be at least two environments, because skrl resets a single one itself.
    """

    def record_transition(
        self,
        *,
        next_observations: torch.Tensor,
        terminated: torch.Tensor,
        truncated: torch.Tensor,
        infos: dict[str, Any],
        **others: Any,
    ) -> None:
        """As skrl's agents do it, with the observations after the action: a tensor (num_envs, n_obs)."""
        ended = (terminated | truncated).flatten()
        if ended.any():
            next_observations = next_observations.clone()  # the trainer acts on its own one
            final = np.stack(infos["final_obs"][ended.cpu().numpy()])
            next_observations[ended] = torch.as_tensor(final, device=next_observations.device)
        super().record_transition(  # type: ignore[misc]
            next_observations=next_observations, terminated=terminated, truncated=truncated, infos=infos, **others
        )
