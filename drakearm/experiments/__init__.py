"""Scenarios, and the steps from a scenario to a plan, a policy, its metrics and a replay.

Each name is imported when it is first used: the command line lists scenarios without loading Drake or PyTorch.
"""

from typing import TYPE_CHECKING

from drakearm.lazy import lazy_attributes

__all__ = [
    "EnvKind",
    "Preset",
    "RunFolder",
    "Scenario",
    "SuccessCriterion",
    "adopt_step",
    "evaluate_step",
    "evaluation_metrics",
    "export_recording",
    "load_scenario",
    "make_env",
    "make_task_env",
    "make_vector_env",
    "perturb_step",
    "plan_step",
    "replay_step",
    "robust_step",
    "run_metrics",
    "run_policy",
    "run_policy_perturbed",
    "run_policy_stochastic",
    "scenario_files",
    "scenario_task",
    "shipped_run",
    "single_step",
    "static_step",
    "train_step",
]

if TYPE_CHECKING:
    from drakearm.experiments.catalog import scenario_files
    from drakearm.experiments.choices import EnvKind, Preset
    from drakearm.experiments.environments import make_env, make_task_env, make_vector_env, scenario_task
    from drakearm.experiments.export import export_recording
    from drakearm.experiments.metrics import evaluation_metrics, run_metrics, run_policy, run_policy_stochastic
    from drakearm.experiments.perturbed import perturb_step, run_policy_perturbed
    from drakearm.experiments.robustness import robust_step, single_step
    from drakearm.experiments.run_folder import RunFolder
    from drakearm.experiments.scenario import Scenario, load_scenario
    from drakearm.experiments.shipped import adopt_step, shipped_run
    from drakearm.experiments.static import static_step
    from drakearm.experiments.steps import evaluate_step, plan_step, replay_step, train_step
    from drakearm.experiments.success import SuccessCriterion
else:
    __getattr__, __dir__ = lazy_attributes(
        __name__,
        {
            "drakearm.experiments.catalog": ("scenario_files",),
            "drakearm.experiments.choices": ("EnvKind", "Preset"),
            "drakearm.experiments.environments": ("make_env", "make_task_env", "make_vector_env", "scenario_task"),
            "drakearm.experiments.export": ("export_recording",),
            "drakearm.experiments.metrics": (
                "evaluation_metrics",
                "run_metrics",
                "run_policy",
                "run_policy_stochastic",
            ),
            "drakearm.experiments.perturbed": ("perturb_step", "run_policy_perturbed"),
            "drakearm.experiments.robustness": ("robust_step", "single_step"),
            "drakearm.experiments.run_folder": ("RunFolder",),
            "drakearm.experiments.scenario": ("Scenario", "load_scenario"),
            "drakearm.experiments.shipped": ("adopt_step", "shipped_run"),
            "drakearm.experiments.static": ("static_step",),
            "drakearm.experiments.steps": ("evaluate_step", "plan_step", "replay_step", "train_step"),
            "drakearm.experiments.success": ("SuccessCriterion",),
        },
    )
