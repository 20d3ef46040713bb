"""The arm live in Meshcat: it reaches for a target at once, from where it is, while the page is open."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from pydrake.geometry import Meshcat, MeshcatParams, Rgba, Sphere
from pydrake.math import RigidTransform
from pydrake.systems.framework import DiagramBuilder, OutputPort
from pydrake.systems.primitives import Adder, ConstantVectorSource

from drakearm.diagrams import MakeReachingLoop, MakeSimulator, Perturbation
from drakearm.diagrams.muscle_arm import MuscleArm
from drakearm.errors import PlanningError
from drakearm.learning import Policy
from drakearm.model import load_arm
from drakearm.model.reference import Reference
from drakearm.planning import ReachPlanner, muscle_feasibility, posture_at
from drakearm.repertoire.move import START_DEG
from drakearm.repertoire.repertoire import Repertoire
from drakearm.systems import upright

FRAME = 0.03  # s, between two looks at the controls
PUSH = (2.0, 1.0)  # Nm, at shoulder and elbow
PUSH_TIME = 0.12  # s
SLIDERS = {  # name: least, most, step, first value
    "target x (m)": (-0.3, 0.6, 0.01, 0.25),
    "target y (m)": (0.2, 1.2, 0.01, 0.35),
    "time (s)": (0.4, 1.0, 0.05, 0.6),
    "load (kg)": (0.0, 2.0, 0.1, 0.0),
}
REACH, DISTURB, STOP, LAG = "reach", "disturb", "stop", "lag (ms)"
_ACCEPTED, _REFUSED = Rgba(0.1, 0.6, 0.2, 0.8), Rgba(0.8, 0.1, 0.1, 0.8)


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


class Live:
    """The simulated arm, the page with its controls, and how far the page lags behind real time.

    `Step` simulates one frame and obeys the controls; `Run` does so until the stop button is pressed.
    """

    def __init__(self, repertoire: Repertoire, policy: Policy, port: int | None = None):
        """port: of the page, on this computer only; by default the first free one from 7000."""
        self.meshcat = Meshcat(MeshcatParams(host="localhost", port=port))
        arm = load_arm(repertoire.arm)
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
        for name, (least, most, step, value) in SLIDERS.items():
            self.meshcat.AddSlider(name, least, most, step, value)
        self.meshcat.AddSlider(LAG, 0.0, 1000.0, 1.0, 0.0)
        for name in (REACH, DISTURB, STOP):
            self.meshcat.AddButton(name)
        self._clicks = {name: 0 for name in (REACH, DISTURB, STOP)}
        self._push_end, self._load = 0.0, 0.0
        self._began = time.monotonic()
        self.lag = 0.0  # s

    @property
    def arm_state(self) -> np.ndarray:
        """q and v of the joints, (2 n_q,), rad and rad/s."""
        return self._loop.diagram.GetOutputPort("arm_state").Eval(self.context)

    def Run(self, refuse: Callable[[str], object]) -> None:
        """Simulates in real time until the stop button is pressed. refuse: gets a sentence for each refused target."""
        self._began = time.monotonic() - self.context.get_time()
        while self.Step(refuse):
            ahead = self.context.get_time() - (time.monotonic() - self._began)
            if ahead > 0.0:
                time.sleep(ahead)
            self.lag = max(0.0, -ahead)
            self.meshcat.SetSliderValue(LAG, round(1000.0 * self.lag))

    def Step(self, refuse: Callable[[str], object] = print) -> bool:
        """Obeys the controls and simulates a frame. Returns whether the stop button has not been pressed."""
        values = {name: self.meshcat.GetSliderValue(name) for name in SLIDERS}
        x, y, duration, load = values.values()
        if load != self._load:
            self._load = load
            self._loop.systems.arm.SetBody(self.context, load, 1.0)
            self._planner = ReachPlanner(self._arm, load)
        if self._clicked(REACH):
            self._reach(x, y, duration, refuse)
        if self._clicked(DISTURB):
            self._push_end = self.context.get_time() + PUSH_TIME
        pushed = self.context.get_time() < self._push_end
        source = self._push.sources[0]
        torque = np.resize(PUSH, len(self._arm.coordinates)) * pushed
        source.get_mutable_source_value(source.GetMyMutableContextFromRoot(self.context)).SetFromVector(torque)
        self._simulator.AdvanceTo(self.context.get_time() + FRAME)
        return not self._clicked(STOP)

    def _reach(self, x: float, y: float, duration: float, refuse: Callable[[str], object]) -> None:
        """Sets a target, if the hand can reach it and the muscles are strong enough."""
        q, v = np.split(self.arm_state, 2)
        try:
            target = posture_at(self._planner.model, x, y, near=q)
            tested = self._planner(q, v, target, duration)
            feasibility = muscle_feasibility(self._arm, tested, self._load)
            if not feasibility.feasible:
                raise PlanningError(feasibility.verdict)
        except PlanningError as error:
            self._show_target((x, y), _REFUSED)
            refuse(str(error))
            return
        self._show_target((x, y), _ACCEPTED)
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

    def _show_target(self, position: tuple[float, float], color: Rgba) -> None:
        """A ball at a position (m) in the plane of the hand, upright like the arm."""
        plant = self._loop.systems.arm.plant
        tip = plant.GetFrameByName(self._arm.tip_frame)
        z = tip.CalcPoseInWorld(plant.GetMyContextFromRoot(self.context)).translation()[2]
        self.meshcat.SetObject("/target", Sphere(0.012), color)
        self.meshcat.SetTransform("/target", upright(self._arm) @ RigidTransform(np.array([*position, z])))

    def _clicked(self, button: str) -> bool:
        clicks = self.meshcat.GetButtonClicks(button)
        fresh, self._clicks[button] = clicks > self._clicks[button], clicks
        return fresh
