"""Whether `drakearm live` keeps real time: its share of one core, and its lag, with the page open in Chromium.

`python tests/benchmarks/live.py` runs the page in real time, with a new target every second, and prints a table. The
process and the browser share the cores that they find; `taskset -c 0` leaves one core to both. `--quick` runs for 2 s.
"""

import argparse
import subprocess
import tempfile
import time
from contextlib import ExitStack

import numpy as np

from drakearm.repertoire.live import REACH, Live
from drakearm.repertoire.shipped import policy_and_repertoire
from drakearm.replay.film import BROWSER_OPTIONS, find_chromium

TARGETS = ((0.25, 0.35), (0.4, 0.6), (0.1, 0.45), (0.35, 0.75))  # m
CHROMIUM = find_chromium()


def click(live: Live, button: str) -> None:
    """What the page sends when a button is pressed: {"type": "button", "name": ...} as MessagePack."""
    texts = b"".join(bytes([0xA0 | len(text)]) + text.encode() for text in ("type", "button", "name", button))
    live.meshcat._InjectWebsocketMessage(message=bytes([0x82]) + texts)


class Reaching(Live):
    """Reaches for the next target every second, and ends after some seconds."""

    seconds: int
    lags: list[float]  # s, one per frame

    def Step(self, refuse=print) -> bool:
        self.lags.append(self.lag)
        time_now = self.context.get_time()
        if time_now >= self.next_target:
            x, y = TARGETS[self.next_target % len(TARGETS)]
            self.meshcat.SetSliderValue("target x (m)", x)
            self.meshcat.SetSliderValue("target y (m)", y)
            click(self, REACH)
            self.next_target += 1
        return super().Step(refuse) and time_now < self.seconds


def open_browser(url: str, stack: ExitStack) -> None:
    """Shows the page in a headless browser until the stack is closed."""
    profile = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
    options = ["--headless=new", *BROWSER_OPTIONS]
    command = [CHROMIUM, *options, f"--user-data-dir={profile}", "--remote-debugging-port=0", url]
    browser = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    stack.callback(browser.wait)
    stack.callback(browser.kill)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="2 s")
    policy, repertoire = policy_and_repertoire(None)
    live = Reaching(repertoire, policy)
    live.seconds, live.lags, live.next_target = (2 if parser.parse_args().quick else 20), [], 0
    with ExitStack() as stack:
        if CHROMIUM:
            open_browser(live.meshcat.web_url(), stack)
            deadline = time.monotonic() + 30.0
            while live.meshcat.GetNumActiveConnections() == 0 and time.monotonic() < deadline:
                time.sleep(0.1)
        else:
            print("not measured: the page in a browser, because chromium is missing")
        connections = live.meshcat.GetNumActiveConnections()
        began = time.process_time()
        live.Run(print)
        used = time.process_time() - began
    lag = 1e3 * np.array(live.lags)
    print("| pages | simulated (s) | share of one core | lag (ms), median | lag (ms), 95 % | lag (ms), largest |")
    print("|---|---|---|---|---|---|")
    print(
        f"| {connections} | {live.context.get_time():.1f} | {used / live.context.get_time():.2f} "
        f"| {np.median(lag):.0f} | {np.percentile(lag, 95):.0f} | {lag.max():.0f} |"
    )


if __name__ == "__main__":
    main()
