"""ReferenceSource: the reference that an arm follows, which each context can replace."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, LeafSystem
from pydrake.trajectories import PiecewisePolynomial

from drakearm.model.reference import Reference


@dataclass(frozen=True)
class Course:
    """A reference that begins at a time (s)."""

    reference: Reference
    begin: float
    lookahead: tuple[int, ...]  # control steps

    @cached_property
    def now(self) -> PiecewisePolynomial:
        """The angles q over the time since `begin`."""
        return self.reference.preview_trajectory()

    @cached_property
    def ahead(self) -> PiecewisePolynomial:
        """The angles q at each time of the lookahead."""
        return self.reference.preview_trajectory(self.lookahead)


class ReferenceSource(LeafSystem):
    """Puts out the reference at the present time, and what lies ahead.

    .. pydrake_system::

        name: ReferenceSource
        output_ports:
        - reference
        - preview_q
        - preview_v

    ========= ====================== =========== ==========================================
    port      size                   unit        meaning
    ========= ====================== =========== ==========================================
    reference 2 n_q                  rad, rad/s  desired q and v now
    preview_q n_q len(lookahead)     rad         desired q at each time of the lookahead
    preview_v n_q len(lookahead)     rad/s       desired v at the same times
    ========= ====================== =========== ==========================================

    reference: of the default context, where it begins at time 0. lookahead: in control steps. After its end a reference
    stays at its last sample.
    """

    def __init__(self, reference: Reference, lookahead: tuple[int, ...]):
        super().__init__()
        self._lookahead = lookahead
        n_q = reference.q.shape[1]
        n_preview = n_q * len(lookahead)
        self._course = self.DeclareAbstractState(AbstractValue.Make(self._make_course(reference, 0.0)))
        self.DeclareVectorOutputPort("reference", 2 * n_q, self._calc_reference)
        self.DeclareVectorOutputPort("preview_q", n_preview, self._calc_preview_q)
        self.DeclareVectorOutputPort("preview_v", n_preview, self._calc_preview_v)

    def SetReference(self, root_context: Context, reference: Reference, begin: float = 0.0) -> None:
        """Replaces the reference by another one, which begins at a time (s)."""
        context = self.GetMyMutableContextFromRoot(root_context)
        context.SetAbstractState(self._course, self._make_course(reference, begin))

    def Reference(self, root_context: Context) -> Reference:
        """The reference of a context."""
        return self._get_course(self.GetMyContextFromRoot(root_context)).reference

    def _make_course(self, reference: Reference, begin: float) -> Course:
        return Course(reference, begin, self._lookahead)

    def _get_course(self, context: Context) -> Course:
        course: Course = context.get_abstract_state(self._course).get_value()
        return course

    def _calc_reference(self, context: Context, output: BasicVector) -> None:
        course = self._get_course(context)
        output.SetFromVector(
            np.concatenate([_angles(course.now, course, context), _speeds(course.now, course, context)])
        )

    def _calc_preview_q(self, context: Context, output: BasicVector) -> None:
        course = self._get_course(context)
        output.SetFromVector(_angles(course.ahead, course, context))

    def _calc_preview_v(self, context: Context, output: BasicVector) -> None:
        course = self._get_course(context)
        output.SetFromVector(_speeds(course.ahead, course, context))


def _angles(trajectory: PiecewisePolynomial, course: Course, context: Context) -> np.ndarray:
    return trajectory.value(context.get_time() - course.begin).ravel()


def _speeds(trajectory: PiecewisePolynomial, course: Course, context: Context) -> np.ndarray:
    time = context.get_time() - course.begin
    if time > trajectory.end_time():
        return np.zeros(trajectory.rows())
    return trajectory.EvalDerivative(time, 1).ravel()
