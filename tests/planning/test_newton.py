"""The Gauss-Newton method: its defects are those of DirectCollocation, and its optimum is that of SNOPT."""

from dataclasses import replace

import numpy as np
import pytest

from drakearm.experiments.scenario import load_scenario
from drakearm.model import load_arm
from drakearm.planning import PlanningModel, collocation, plan
from drakearm.planning.defects import defects
from drakearm.planning.guess import straight_guess
from drakearm.planning.transcription import transcribe

ARM = load_arm("arm14")


@pytest.fixture(scope="module")
def problem():
    movement = load_scenario("timing-0.7s").movement
    model, times = PlanningModel(ARM, 2.0), np.linspace(0.0, 0.7, 9)
    start = (np.zeros(4), model.gravity_torque(movement.start))
    return transcribe(model, movement, times, start, straight_guess(model, movement, times), arrives=True)


def places(problem) -> np.ndarray:
    """The places of the knots' q, v and tau among the variables, (N, 6)."""
    knots = [[*problem.collocation.state(k), *problem.tau(k)] for k in range(len(problem.times))]
    return np.array([problem.prog.FindDecisionVariableIndices(np.array(knot)) for knot in knots])


def test_defects_are_those_of_direct_collocation(problem):
    rng = np.random.default_rng(0)
    for _ in range(5):
        x = problem.prog.initial_guess()
        x[places(problem)] += rng.normal(size=(9, 6))
        theirs = [problem.prog.EvalBinding(binding, x) for binding in problem.prog.generic_constraints()]
        ours, _ = defects(x[places(problem)], problem.times[1], problem.model.dynamics)
        np.testing.assert_allclose(ours, theirs, atol=1e-9)


def test_derivatives_of_the_defects(problem):
    z = problem.prog.initial_guess()[places(problem)] + np.random.default_rng(1).normal(size=(9, 6))
    step, dynamics = problem.times[1], problem.model.dynamics
    _, jacobian = defects(z, step, dynamics)
    for k in (0, 5):
        for j in range(12):
            move = np.zeros_like(z)
            move[k + j // 6, j % 6] = 1e-6
            difference = (defects(z + move, step, dynamics)[0] - defects(z - move, step, dynamics)[0]) / 2e-6
            np.testing.assert_allclose(jacobian[k, :, j], difference[k], rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("name", ["timing-0.4s", "reach-315", "lift-20kg", "obstacle"])
def test_the_optimum_is_that_of_snopt(name, monkeypatch):
    scenario = load_scenario(name)
    request = (ARM, scenario.movement, scenario.load_mass, scenario.obstacle)
    newton = plan(*request)
    assert newton.solver.startswith("Gauss-Newton")
    monkeypatch.setattr(collocation, "solve_newton", lambda problem: (None, 0))
    other = plan(*request)
    assert other.solver == "SNOPT"
    assert sum(newton.costs.values()) == pytest.approx(sum(other.costs.values()), rel=1e-3)
    np.testing.assert_allclose(newton.q, other.q, atol=0.01)


def test_snopt_takes_over_where_newton_does_not_converge(monkeypatch):
    monkeypatch.setattr("drakearm.planning.newton.ITERATIONS", 1)
    found = plan(ARM, replace(load_scenario("timing-0.7s").movement, knots=9))
    assert found.solver == "SNOPT" and found.iterations > 1
