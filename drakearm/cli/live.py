"""`drakearm live`."""

from drakearm.cli.console import say
from drakearm.cli.options import LearnedPolicy, Port


def live(policy: LearnedPolicy = None, port: Port = None) -> None:
    """Let the arm reach in the browser, in real time, for a target that you set with sliders.

    The page is only for this computer. Its controls: the target of the hand (x forward, y up), the time that the reach
    takes, a load that the policy is not told, and buttons to reach, to disturb the arm and to stop. A green ball is a
    target that the muscles can reach, a red one is refused. The page shows by how much it lags behind real time.

    Press stop on the page, or Ctrl-C, to end.
    """
    from drakearm.repertoire.live import Live
    from drakearm.repertoire.shipped import policy_and_repertoire

    chosen, repertoire = policy_and_repertoire(policy)
    page = Live(repertoire, chosen, port)
    say(f"open {page.meshcat.web_url()} in a browser, and there Open Controls")
    page.Run(say)
