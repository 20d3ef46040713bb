"""TrackingReward: the reward of a task, and the tracking error."""

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drakearm.task import TrackingTask, signal_size
from drakearm.task.rewards import check_computed


class TrackingReward(LeafSystem):
    """Computes the reward of a task from the signals of its Diagram, and the tracking error.

    .. pydrake_system::

        name: TrackingReward
        input_ports:
        - arm_state
        - reference
        - one per other signal that the task's reward reads
        output_ports:
        - reward
        - tracking_error

    ================ ==================== =========== ========================================
    port             size                 unit        meaning
    ================ ==================== =========== ========================================
    arm_state        2 n_q                rad, rad/s  q and v
    reference        2 n_q                rad, rad/s  desired q and v
    each signal      `signal_size` of it  SI          see `drakearm.task.SIGNALS`
    reward           1                    1           the task's `Reward`
    tracking_error   n_q                  rad         q minus desired q
    ================ ==================== =========== ========================================
    """

    def __init__(self, task: TrackingTask):
        super().__init__()
        self._reward, self._n_q = task.reward, len(task.arm.coordinates)
        self._signals = {
            name: self.DeclareVectorInputPort(name, signal_size(name, task.arm, task.lookahead))
            for name in dict.fromkeys(("arm_state", "reference", *task.reward.reads))
        }
        tickets = {name: port.ticket() for name, port in self._signals.items()}
        of_reward = {tickets[name] for name in task.reward.reads}
        self.DeclareVectorOutputPort("reward", 1, self._calc_reward, of_reward)
        of_error = {tickets["arm_state"], tickets["reference"]}
        self.DeclareVectorOutputPort("tracking_error", self._n_q, self._calc_error, of_error)

    def _calc_reward(self, context: Context, output: BasicVector) -> None:
        computed = self._reward(*(self._signals[name].Eval(context) for name in self._reward.reads))
        output[0] = check_computed(self._reward, computed)

    def _calc_error(self, context: Context, output: BasicVector) -> None:
        q, desired_q = (self._signals[name].Eval(context)[: self._n_q] for name in ("arm_state", "reference"))
        output.SetFromVector(q - desired_q)
