"""The numbers of OpenSim's muscles, as drakearm's muscles have them."""

from collections import defaultdict
from typing import Any

from drakearm.importing.opensim_file import base_name, base_pose, items
from drakearm.importing.source import SourceMuscle
from drakearm.importing.tissue import ASSUMED

_SHARED = {  # field -> OpenSim's property
    "max_isometric_force": "max_isometric_force",
    "optimal_fiber_length": "optimal_fiber_length",
    "tendon_slack_length": "tendon_slack_length",
    "pennation_angle": "pennation_angle_at_optimal",
    "max_contraction_velocity": "max_contraction_velocity",
    "activation_time": "activation_time_constant",
    "deactivation_time": "deactivation_time_constant",
}
_OWN = {
    "Thelen2003Muscle": {
        "minimum_activation": "minimum_activation",
        "tendon_strain": "FmaxTendonStrain",
        "passive_strain": "FmaxMuscleStrain",
        "passive_shape": "KshapePassive",
        "active_width": "KshapeActive",
        "force_velocity_shape": "Af",
        "eccentric_force": "Flen",
    },
    "Millard2012EquilibriumMuscle": {"minimum_activation": "minimum_activation"},
    "DeGrooteFregly2016Muscle": {
        "tendon_strain": "tendon_strain_at_one_norm_force",
        "passive_strain": "passive_fiber_strain_at_one_norm_force",
    },
}
_NOT_KEPT = {  # properties without a counterpart, and the values that need none
    "Thelen2003Muscle": {"fv_linear_extrap_threshold": 0.95},
    "Millard2012EquilibriumMuscle": {"fiber_damping": 0.0},
    "DeGrooteFregly2016Muscle": {"active_force_width_scale": 1.0, "fiber_damping": 0.0},
}
_FLAGS = ("ignore_activation_dynamics", "ignore_passive_fiber_force")
_LEAST_ACTIVATION = 1e-4


def read_muscles(osim: Any, loaded: Any, state: Any) -> tuple[tuple[SourceMuscle, ...], list[str]]:
    """The muscles of a model at its present posture, and what is left out of the model's forces, in words."""
    muscles = []
    lost = defaultdict(list)  # class, and what is wrong with it -> names
    for force in items(loaded.getForceSet()):
        name, kind = force.getName(), force.getConcreteClassName()
        muscle = osim.Muscle.safeDownCast(force)
        if muscle is None:
            lost[kind].append(name)
        elif kind not in _OWN:
            lost[f"muscles of the class {kind}, where {', '.join(_OWN)} were expected"].append(name)
        elif not force.get_appliesForce():
            lost["muscles that apply no force, as the file says"].append(name)
        else:
            muscles.append(_read(osim, muscle, kind, state))
    return tuple(muscles), [f"{what}: {', '.join(names)}" for what, names in lost.items()]


def _read(osim: Any, muscle: Any, kind: str, state: Any) -> SourceMuscle:
    def number(name: str) -> float:
        return osim.PropertyHelper.getValueDouble(muscle.getPropertyByName(name))

    fields = {**ASSUMED, **{field: number(name) for field, name in {**_SHARED, **_OWN[kind]}.items()}}
    notes = [f"{name} {number(name):g}" for name, usual in _NOT_KEPT[kind].items() if number(name) != usual]
    notes += [
        name
        for name in _FLAGS
        if muscle.hasProperty(name) and osim.PropertyHelper.getValueBool(muscle.getPropertyByName(name))
    ]
    fields["model"] = "thelen2003" if kind == "Thelen2003Muscle" else "degroote2016"
    if kind == "Millard2012EquilibriumMuscle":
        curves = osim.Millard2012EquilibriumMuscle.safeDownCast(muscle)
        fields["tendon_strain"] = curves.getTendonForceLengthCurve().getStrainAtOneNormForce()
        fields["passive_strain"] = curves.getFiberForceLengthCurve().getStrainAtOneNormForce()
        notes.append("the curves of Millard2012EquilibriumMuscle: degroote2016 is used")
    if fields["minimum_activation"] < _LEAST_ACTIVATION:
        notes.append(f"minimum_activation {fields['minimum_activation']:g}: {_LEAST_ACTIVATION:g} is used")
        fields["minimum_activation"] = _LEAST_ACTIVATION
    fields["tendon"] = "rigid" if muscle.get_ignore_tendon_compliance() else "compliant"
    return SourceMuscle(muscle.getName(), fields, *_path(osim, muscle, state), tuple(notes))


def _path(osim: Any, muscle: Any, state: Any) -> tuple[tuple[tuple[str, tuple[float, ...]], ...], frozenset[str]]:
    """The points of a muscle that are in use, and all bodies that the path touches."""
    path = osim.GeometryPath.safeDownCast(muscle.getPath())
    if path is None:  # a function, for example
        return (), frozenset()
    points, bodies = [], set()
    for point in items(path.getPathPointSet()):
        body = base_name(point.getParentFrame())
        bodies.add(body)
        if point.isActive(state):
            place = base_pose(point.getParentFrame()) @ [*point.getLocation(state).to_numpy(), 1.0]
            points.append((body, tuple(place[:3].tolist())))
    wraps = path.getWrapSet()
    for i in range(wraps.getSize()):
        bodies.add(base_name(wraps.get(i).getWrapObject().getFrame()))
    return tuple(points), frozenset(bodies)
