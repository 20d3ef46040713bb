// The clock and the controls of a replay. All scenes show the same time: that of this page, or those in its frames.
{
  const PAUSE = 0.15; // s of the movement, between the end and the next start
  const frames = [...document.querySelectorAll("iframe")];
  const loaded = frame => new Promise(done => { frame.onload = () => done(frame.contentWindow); });
  const windows = frames.length ? Promise.all(frames.map(loaded)) : Promise.resolve([window]);

  const controls = document.getElementById("replay-controls");
  const [slider, clock, speeds] = ["input", "output", "select"].map(name => controls.querySelector(name));
  const play_button = document.getElementById("replay-play"), loop_button = document.getElementById("replay-loop");
  const view_buttons = [...controls.querySelectorAll("[data-view]")];
  const duration = Number(slider.max);

  // Time, in s of the movement.
  let time = 0, playing = true, loop = true, speed = Number(speeds.value), scenes = [], shown = NaN;
  window.replay_time = () => Math.min(time, duration); // for films
  const show = () => {
    const now = replay_time();
    if (now === shown) return;
    shown = now;
    for (const scene of scenes) scene.show(now);
    slider.value = now;
    clock.value = now.toFixed(2) + " s";
  };
  const set_playing = value => {
    playing = value;
    play_button.textContent = playing ? "Pause" : "Play";
    for (const scene of scenes) scene.set_moving(playing);
  };
  const seek = value => {
    set_playing(false);
    time = Math.min(Math.max(value, 0), duration);
    show();
  };
  const toggle = () => {
    if (!playing && !loop && time >= duration) time = 0;
    set_playing(!playing);
  };
  const seek_address = () => {
    const value = new URLSearchParams(location.hash.slice(1)).get("t");
    if (value !== null && Number.isFinite(Number(value))) seek(Number(value));
  };
  play_button.onclick = toggle;
  loop_button.onclick = () => {
    loop = !loop;
    loop_button.setAttribute("aria-pressed", loop);
  };
  slider.oninput = () => seek(slider.valueAsNumber);
  speeds.onchange = () => { speed = Number(speeds.value); };
  window.onhashchange = seek_address;
  const obey_key = event => {
    const step = { ArrowLeft: -0.01, ArrowRight: 0.01 }[event.code];
    if (event.code === "Space") toggle();
    else if (step) seek(replay_time() + step);
    else return;
    event.preventDefault();
    event.stopPropagation();
    document.activeElement.blur();
  };
  let last = NaN; // ms, the moment of the last frame
  const tick = now => {
    if (playing && now > last) time += speed * (now - last) / 1000;
    last = now;
    if (loop && time > duration + PAUSE) time = 0;
    if (!loop && playing && time >= duration) seek(duration);
    show();
    requestAnimationFrame(tick);
  };

  const show_view = name => {
    for (const scene of scenes) scene.show_view(name);
    for (const button of view_buttons) button.setAttribute("aria-pressed", button.dataset.view === name);
  };
  for (const button of view_buttons) button.onclick = () => show_view(button.dataset.view);

  windows.then(all => Promise.all(all.map(each => each.replay_scene)).then(ready => {
    scenes = ready;
    for (const each of new Set([window, ...all])) each.addEventListener("keydown", obey_key, true);
    show_view("oblique");
    set_playing(playing);
    seek_address();
    show();
    requestAnimationFrame(tick);
    document.body.dataset.replay = "ready"; // for tests and films
  }));
}
