"""Proprioception: the observation of a task, which a controller of the arm gets."""

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drakearm.task import TrackingTask, signal_size


class Proprioception(LeafSystem):
    """Computes the observation of a task from the signals of its Diagram.

    .. pydrake_system::

        name: Proprioception
        input_ports:
        - one per signal that the task's senses read
        output_ports:
        - observation

    ============== ==================== ======== ===============================================
    port           size                 unit     meaning
    ============== ==================== ======== ===============================================
    each signal    `signal_size` of it  SI       see `drakearm.task.SIGNALS`
    observation    `Observation.size`   1        the task's senses, scaled, in their order
    ============== ==================== ======== ===============================================
    """

    def __init__(self, task: TrackingTask):
        super().__init__()
        self.observation = task.observation
        self._signals = {
            name: self.DeclareVectorInputPort(name, signal_size(name, task.arm, task.lookahead))
            for name in self.observation.reads
        }
        tickets = {port.ticket() for port in self._signals.values()}
        self.DeclareVectorOutputPort("observation", self.observation.size, self._calc_observation, tickets)

    def _calc_observation(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.observation({name: port.Eval(context) for name, port in self._signals.items()}))
