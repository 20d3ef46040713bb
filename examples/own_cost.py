"""Plans a movement with a cost of your own, and prints what each cost contributes."""

from dataclasses import replace

import numpy as np
from pydantic.dataclasses import dataclass

from drakearm.experiments.scenario import load_scenario
from drakearm.model import load_arm
from drakearm.planning import CostPiece, Plan, plan


@dataclass(frozen=True, kw_only=True)
class Power(CostPiece):
    """The mechanical power of the joints squared, integrated over time."""

    type = "power"  # once this module is imported, a scenario file can list {type: power, weight: 0.01}
    weight: float  # 1/(W^2 s)

    def add(self, problem):
        n = len(problem.coordinates)

        def squared(x, share):  # x: speeds and torques of a knot; returns value (1,) and gradient (1, 2 n)
            v, tau = x[:n], x[n:]
            power = v @ tau
            gradient = np.concatenate([tau, v])
            return self.weight * share * np.array([power**2]), self.weight * share * 2.0 * power * gradient[None, :]

        return [
            problem.add_cost(lambda x, share=share: squared(x, share), np.concatenate([problem.v(k), problem.tau(k)]))
            for k, share in enumerate(problem.shares)
        ]


def main() -> Plan:
    movement = load_scenario("timing-0.7s").movement
    found = plan(load_arm("arm14"), replace(movement, costs=[*movement.costs, Power(weight=0.01)]))
    for name, value in found.costs.items():
        print(f"{name} {value:.3g}")
    return found


if __name__ == "__main__":
    main()
