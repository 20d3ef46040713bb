"""The arm live in Meshcat: it reaches for a target at once, from where it is, while the page is open."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from pydrake.systems.framework import DiagramBuilder, OutputPort
from pydrake.systems.primitives import Adder, ConstantVectorSource

from drakearm.diagrams import MakeReachingLoop, MakeSimulator, Perturbation
from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.errors import PlanningError
from drakearm.learning import Policy
from drakearm.model.reference import Reference
from drakearm.model.skeleton_file import LOAD
from drakearm.planning import ReachPlanner, muscle_feasibility, posture_at
from drakearm.repertoire.live_page import FRAME, STOP, LivePage, Slider
from drakearm.repertoire.repertoire import Repertoire
from drakearm.repertoire.to_place import START_DEG

PUSH = (2.0, 1.0)  # Nm, at shoulder and elbow
PUSH_TIME = 0.12  # s
SLIDERS: dict[str, Slider] = {
    "target x (m)": (-0.3, 0.6, 0.01, 0.25),
    "target y (m)": (0.2, 1.2, 0.01, 0.35),
    "time (s)": (0.4, 1.0, 0.05, 0.6),
    "load (kg)": (0.0, 2.0, 0.1, 0.0),
}
REACH, DISTURB = "reach", "disturb"


@dataclass(frozen=True)
class _LivePush(Perturbation):
    """A torque on the joints that can be changed during a simulation."""

    type = ""  # files cannot name it
    sources: list[ConstantVectorSource] = field(default_factory=list)

    def perturb_torque(self, builder: DiagramBuilder, torque: OutputPort, arm: MuscleArm) -> OutputPort:
        n_q = torque.size()
        source = self.add_system(builder, ConstantVectorSource(np.zeros(n_q)))
        total = self.add_system(builder, Adder(2, n_q))
        builder.Connect(torque, total.get_input_port(0))
        builder.Connect(source.get_output_port(), total.get_input_port(1))
        self.sources.append(source)
        return total.get_output_port()


class Live(LivePage):
    """The simulated arm and the page with its controls."""

    def __init__(self, repertoire: Repertoire, policy: Policy, port: int | None = None):
        """port: of the page, on this computer only; by default the first free one from 7000."""
        super().__init__(SLIDERS, (REACH, DISTURB), port)
        arm = repertoire.loaded_arm
        self._arm, self._planner = arm, ReachPlanner(arm)
        start = np.deg2rad(START_DEG)
        task = replace(repertoire.task(self._planner.rest(start)), randomization=())
        self._push = _LivePush()
        self._duration, self._tested = 0.6, task.reference
        self._loop = MakeReachingLoop(
            task,
            policy.act,
            self._plan,
            start,
            self.meshcat,
            perturbations=[self._push],
            variable_load=True,
        )
        self._simulator = MakeSimulator(self._loop.diagram)
        self.context = self._simulator.get_mutable_context()
        self._target = self._loop.diagram.GetInputPort("target")
        self._target.FixValue(self.context, start)
        self._loop.Reset(self.context)
        self._simulator.Initialize()
        self._planner(start, np.zeros_like(start), start, self._duration)  # compiles what the first reach needs
        self._push_end, self._load = 0.0, 0.0

    @property
    def arm_state(self) -> np.ndarray:
        """q and v of the joints, (2 n_q,), rad and rad/s."""
        return self._loop.diagram.GetOutputPort("arm_state").Eval(self.context)

    def Step(self, say: Callable[[str], object] = print) -> bool:
        """Obeys the controls and simulates a frame. Returns whether the stop button has not been pressed.

        say: gets a sentence for each refused target.
        """
        reach = self._clicked(REACH)  # before the sliders, so that what was set before the press counts
        x, y, duration, load = self._values()
        if load != self._load:
            self._load = load
            self._loop.systems.arm.SetBody(self.context, load, 1.0)
            self._planner = ReachPlanner(self._arm, load)
            self._draw_load(self._arm, load)
        if reach:
            self._reach(x, y, duration, say)
        if self._clicked(DISTURB):
            self._push_end = self.context.get_time() + PUSH_TIME
        pushed = self.context.get_time() < self._push_end
        source = self._push.sources[0]
        torque = np.resize(PUSH, len(self._arm.coordinates)) * pushed
        source.get_mutable_source_value(source.GetMyMutableContextFromRoot(self.context)).SetFromVector(torque)
        self._simulator.AdvanceTo(self.context.get_time() + FRAME)
        plant = self._loop.systems.arm.plant
        X_WL = plant.GetBodyByName(LOAD).EvalPoseInWorld(plant.GetMyContextFromRoot(self.context))
        self._move_load(self._arm, X_WL)
        return not self._clicked(STOP)

    def _reach(self, x: float, y: float, duration: float, say: Callable[[str], object]) -> None:
        """Sets a target, if the hand can reach it and the muscles are strong enough."""
        q, v = np.split(self.arm_state, 2)
        try:
            target = posture_at(self._planner.model, x, y, near=q)
            tested = self._planner(q, v, target, duration)
            feasibility = muscle_feasibility(self._arm, tested, self._load)
            if not feasibility.feasible:
                raise PlanningError(feasibility.verdict)
        except PlanningError as error:
            self._show_at((x, y), accepted=False)
            self._write(str(error))
            say(str(error))
            return
        self._show_at((x, y), accepted=True)
        self._write("")
        self._duration, self._tested = duration, tested
        self._target.FixValue(self.context, target)

    def _plan(self, q: np.ndarray, v: np.ndarray, target: np.ndarray, a: np.ndarray) -> Reference:
        """For `ReachSource`: from the present state of the reference, which goes on without a jump, if there is a plan.

        Else from the state of the arm, which was tested.
        """
        try:
            return self._planner(q, v, target, self._duration, a)
        except PlanningError:
            return self._tested

    def _show_at(self, position: tuple[float, float], accepted: bool) -> None:
        """A ball at a position (m) in the plane of the hand."""
        plant = self._loop.systems.arm.plant
        tip = plant.GetFrameByName(self._arm.tip_frame)
        z = tip.CalcPoseInWorld(plant.GetMyContextFromRoot(self.context)).translation()[2]
        self._show_target(self._arm, np.array([*position, z]), accepted)
