"""Every figure of the experiments: labelled axes, and legends that cover nothing."""

from dataclasses import replace

import pytest

from drakearm.reproduction.catalog import EXPERIMENTS

DRAWN = {
    "reaching": ["fig4-reaching"],
    "timing": ["fig5-timing", "fig6-learning"],
    "lifting": ["fig7-lifting", "fig8-muscle-load", "fig8-activations"],
    "obstacle": ["fig9-obstacle"],
}


def assert_labelled(figure):
    """The last row says what is to the right. The first column says what is upwards, or has names at its ticks."""
    places = [(panel, panel.get_subplotspec()) for panel in figure.axes if panel.get_subplotspec()]
    assert all(panel.get_xlabel() for panel, place in places if place.is_last_row())
    for panel in (panel for panel, place in places if place.is_first_col()):
        assert panel.get_ylabel() or panel.get_yticklabels()[0].get_text().replace(" ", "_").isidentifier()


def assert_legends_beside(figure):
    for legend in figure.legends:
        box = legend.get_window_extent()
        assert not [panel for panel in figure.axes if box.overlaps(panel.get_tightbbox())]
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1


@pytest.mark.parametrize("name", DRAWN)
def test_figures_are_labelled_and_legends_cover_nothing(name, make_outcome):
    experiment = EXPERIMENTS[name]
    figures = experiment.figures([make_outcome(trial) for trial in experiment.trials(seeds=1)])
    assert list(figures) == DRAWN[name]
    for figure in figures.values():
        figure.draw_without_rendering()
        assert_labelled(figure)
        assert_legends_beside(figure)


@pytest.mark.parametrize("name", ["reaching", "timing", "lifting"])
def test_a_method_may_be_missing(name, make_outcome):
    experiment = EXPERIMENTS[name]
    trials = [trial for trial in experiment.trials(seeds=1) if trial.method == "default"]
    assert list(experiment.figures([make_outcome(trial) for trial in trials])) == DRAWN[name]


def test_perturbed_runs_may_be_missing(make_outcome):
    outcomes = [replace(make_outcome(trial), perturbed=()) for trial in EXPERIMENTS["timing"].trials(seeds=1)]
    figures = EXPERIMENTS["timing"].figures(outcomes)
    figures["fig5-timing"].draw_without_rendering()
    assert all(row.values for row in EXPERIMENTS["timing"].rows(outcomes) if row.group != "perturbed runs")
