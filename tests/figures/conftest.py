"""An arm with muscles of every kind."""

from dataclasses import replace

import pytest


@pytest.fixture(scope="session")
def small(arm):
    """Muscles of every kind: partly slack, slack everywhere, rigid, of the other model."""
    muscles = {m.name: m for m in arm.muscles}
    biceps, wrist = muscles["BIClong"], muscles["FCU"]
    return replace(
        arm,
        muscles=(
            replace(biceps, tendon_slack_length=1.25 * biceps.tendon_slack_length),
            replace(wrist, tendon_slack_length=1.5 * wrist.tendon_slack_length),
            replace(muscles["BRA"], tendon="rigid"),
            replace(muscles["ANC"], model="degroote2016"),
        ),
    )
