"""The web page of a replay: Meshcat's page with a title, a legend and controls for the time."""

import html
from string import Template

import numpy as np
from pydrake.geometry import Rgba

from drakearm.replay.scene import GHOST_COLOR, PATH_COLOR
from drakearm.systems.muscle_visualizer import activation_color

# Lets the browser refuse every request to another place: all that the page may load is inside of it.
_POLICY = """
<meta http-equiv="Content-Security-Policy" content="default-src 'unsafe-inline' 'unsafe-eval' data: blob:">
"""
# Meshcat's page runs each command as soon as it is decoded, in any order. But an animation of colors only works on
# objects that exist already. This script makes the page run the commands in their original order.
_ORDER = """
<script>
  const unordered_fetch = window.fetch;
  let commands = Promise.resolve();
  window.fetch = request => {
    const command = unordered_fetch(request).then(response => response.arrayBuffer());
    const turn = commands = commands.then(() => command);
    return Promise.resolve({ arrayBuffer: () => turn });
  };
</script>
"""
_OVERLAY = Template("""
<style>
  .replay { position: fixed; left: 28px; user-select: none; }
  .replay { font: 15px/1.5 system-ui, sans-serif; color: #2b3440; }
  #replay-caption { top: 22px; pointer-events: none; }
  #replay-caption h1 { font-size: 22px; font-weight: 600; margin: 0; }
  #replay-legend { bottom: 76px; pointer-events: none; }
  #replay-legend i { display: inline-block; width: 96px; height: 12px; margin-right: 10px; }
  #replay-legend i { vertical-align: middle; }
  #replay-time { right: 28px; bottom: 22px; display: flex; gap: 14px; align-items: center; }
  #replay-time input { flex: 1; accent-color: #51606f; }
  #replay-time button { font: inherit; width: 76px; padding: 4px 0; }
  #replay-time output { width: 62px; font-variant-numeric: tabular-nums; text-align: right; }
  .dg.main { opacity: 0.3; } .dg.main:hover { opacity: 1; }
</style>
<div class="replay" id="replay-caption"><h1>$title</h1>slow motion, $speed of real time</div>
<div class="replay" id="replay-legend">
  <div><i style="background: linear-gradient(90deg, $ramp)"></i>muscle activation, 0 to 1</div>
  <div><i style="background: $ghost"></i>reference</div>
  <div><i style="height: 3px; background: $path"></i>path of the hand</div>
</div>
<div class="replay" id="replay-time">
  <button>Pause</button>
  <input type="range" min="0" max="$duration" step="0.001" value="0">
  <output></output>
</div>
<script>
  {
    window.fetch = unordered_fetch;
    const speed = $rate, duration = $duration;
    const [button, slider, clock] = document.getElementById("replay-time").children;
    const animator = viewer.animator;
    const set_playing = playing => {
      playing ? animator.play() : animator.pause();
      button.textContent = playing ? "Pause" : "Play";
    };
    const seek = time => {
      set_playing(false);
      animator.seek(time / speed);
      animator.display_progress(time / speed);
    };
    const seek_address = () => {
      const time = new URLSearchParams(location.hash.slice(1)).get("t");
      if (time !== null) seek(Number(time));
    };
    button.onclick = () => set_playing(!animator.playing);
    slider.oninput = () => seek(slider.valueAsNumber);
    window.onhashchange = seek_address;
    const show_time = () => {
      const time = Math.min(animator.time * speed, duration);
      slider.value = time;
      clock.value = time.toFixed(2) + " s";
      requestAnimationFrame(show_time);
    };
    commands.then(() => setTimeout(() => { seek_address(); show_time(); }));
  }
</script>
""")


def make_page(meshcat_html: str, title: str, speed: float, duration: float) -> str:
    """Adds a caption, a legend and time controls to the page of `Meshcat.StaticHtml()`.

    title: any text. speed: of the animation, as a fraction of real time. duration: s, of the movement in real time.
    """
    title = html.escape(title)
    overlay = _OVERLAY.substitute(
        title=title,
        speed=f"{speed:.0%}",
        ramp=", ".join(_css(Rgba(*c)) for c in activation_color(np.linspace(0.0, 1.0, 6))),
        ghost=_css(GHOST_COLOR),
        path=_css(PATH_COLOR),
        rate=repr(float(speed)),
        duration=repr(float(duration)),
    )
    page = meshcat_html.replace("<title>Drake MeshCat</title>", f"<title>{title}</title>")
    page = page.replace("<head>", f"<head>{_POLICY}", 1).replace("</head>", f"{_ORDER}</head>")
    return page.replace("</body>", f"{overlay}</body>")


def _css(color: Rgba) -> str:
    red, green, blue = (round(255 * c) for c in (color.r(), color.g(), color.b()))
    return f"rgba({red}, {green}, {blue}, {color.a():g})"
