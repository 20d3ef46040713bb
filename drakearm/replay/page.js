// Controls of the replay: time, speed, views, the strip of angles and activations, and names at the pointer.
{
  window.fetch = unordered_fetch;
  const data = JSON.parse(document.getElementById("replay-data").textContent);
  const animator = viewer.animator;
  const controls = document.getElementById("replay-controls");
  const [slider, clock, speeds] = ["input", "output", "select"].map(name => controls.querySelector(name));
  const play_button = document.getElementById("replay-play"), loop_button = document.getElementById("replay-loop");
  let loop = true;

  // Time, in s of the movement. The animation was recorded at data.speed of real time.
  const set_playing = playing => {
    playing ? animator.play() : animator.pause();
    play_button.textContent = playing ? "Pause" : "Play";
  };
  const seek = time => {
    set_playing(false);
    time = Math.min(Math.max(time, 0), data.duration);
    animator.seek(time / data.speed);
    animator.display_progress(time / data.speed);
  };
  const time_now = () => Math.min(animator.time * data.speed, data.duration);
  window.replay_time = time_now; // for films
  const set_speed = speed => {
    speeds.value = speed;
    animator.mixer.timeScale = speed / data.speed;
  };
  const set_loop = value => {
    loop = value;
    loop_button.setAttribute("aria-pressed", loop);
  };
  const toggle = () => {
    if (!animator.playing && !loop && time_now() >= data.duration) seek(0);
    set_playing(!animator.playing);
  };
  const seek_address = () => {
    const time = new URLSearchParams(location.hash.slice(1)).get("t");
    if (time !== null && Number.isFinite(Number(time))) seek(Number(time));
  };
  play_button.onclick = toggle;
  loop_button.onclick = () => set_loop(!loop);
  slider.oninput = () => seek(slider.valueAsNumber);
  speeds.onchange = () => set_speed(Number(speeds.value));
  window.onhashchange = seek_address;
  window.addEventListener("keydown", event => {
    const step = { ArrowLeft: -0.01, ArrowRight: 0.01 }[event.code];
    if (event.code === "Space") toggle();
    else if (step) seek(time_now() + step);
    else return;
    event.preventDefault();
    event.stopPropagation();
    document.activeElement.blur();
  }, true);

  // Views. Positions are in Meshcat's world, whose z points up; its cameras have y up.
  const to_camera = ([x, y, z]) => [x, z, -y];
  let view_name = "oblique";
  const show_view = name => {
    view_name = name;
    const { center, radius, direction, fov } = data.views[name];
    const half = Math.PI * fov / 360, aspect = viewer.dom_element.offsetWidth / viewer.dom_element.offsetHeight;
    const distance = radius / Math.sin(half) / Math.min(1, aspect);
    const { offsetWidth: width, offsetHeight: height } = viewer.dom_element;
    viewer.camera.setViewOffset(width, height, 0.22 * document.getElementById("replay-strip").offsetWidth, 0, width, height);
    const camera = viewer.camera, place = center.map((c, i) => c + distance * direction[i]);
    camera.fov = fov;
    camera.near = Math.max(0.01, distance - 3);
    camera.far = distance + 10;
    camera.position.set(...to_camera(place));
    viewer.set_camera_target(to_camera(center));
    viewer.set_dirty();
    for (const button of controls.querySelectorAll("[data-view]"))
      button.setAttribute("aria-pressed", button.dataset.view === name);
  };
  for (const button of controls.querySelectorAll("[data-view]")) button.onclick = () => show_view(button.dataset.view);
  window.addEventListener("resize", () => show_view(view_name));

  // Light or dark.
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const set_background = () => {
    const [top, bottom] = dark.matches ? [[0.13, 0.15, 0.18], [0.08, 0.09, 0.11]] : [[1, 1, 1], [0.9, 0.92, 0.95]];
    viewer.set_property(["Background", "<object>"], "top_color", top);
    viewer.set_property(["Background", "<object>"], "bottom_color", bottom);
    draw_strip();
  };
  dark.addEventListener("change", set_background);

  // The strip: angles against the reference, one row of color per muscle, and a line at the present time.
  const canvas = document.querySelector("#replay-strip canvas"), still = document.createElement("canvas");
  const left = 58, angles_bottom = 100, raster_top = 112;
  const place_of = (time, width) => left + (width - left - 4) * time / data.duration;
  const draw_strip = () => {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return;
    for (const each of [canvas, still]) [each.width, each.height] = [width * ratio, height * ratio];
    const pen = still.getContext("2d"), style = getComputedStyle(document.body);
    const text = getComputedStyle(document.getElementById("replay-strip")).color;
    pen.scale(ratio, ratio);
    pen.font = "10px system-ui, sans-serif";
    pen.fillStyle = text;
    const all = [...data.q.flat(), ...data.reference_q.flat()];
    const low = Math.min(...all), high = Math.max(...all, low + 1);
    const y_of = angle => angles_bottom - (angles_bottom - 14) * (angle - low) / (high - low);
    pen.fillText("joint angles (deg)", left, 9);
    for (const angle of [low, high]) pen.fillText(angle.toFixed(0).replace(/^-0$/, "0"), left - 26, y_of(angle) + 3);
    data.joints.forEach((joint, j) => {
      pen.strokeStyle = pen.fillStyle = data.joint_colors[j];
      for (const [rows, dash] of [[data.reference_q, [3, 3]], [data.q, []]]) {
        pen.beginPath();
        pen.setLineDash(dash);
        rows.forEach((row, i) => pen.lineTo(place_of(data.t[i], width), y_of(row[j])));
        pen.stroke();
      }
      pen.fillText(joint, left + 100 + 70 * j, 9);
    });
    pen.setLineDash([]);
    const rows = data.muscles.length, row_height = (height - raster_top) / rows;
    data.muscles.forEach((muscle, m) => {
      const top = raster_top + m * row_height;
      pen.fillStyle = text;
      if (row_height >= 9 || m % 2 === 0) pen.fillText(muscle.slice(0, 9), 0, top + 0.5 * row_height + 3);
      data.activation.forEach((row, i) => {
        const start = place_of(data.t[i], width);
        const end = i + 1 < data.t.length ? place_of(data.t[i + 1], width) : width - 4;
        pen.fillStyle = data.ramp[Math.round(row[m] * (data.ramp.length - 1))];
        pen.fillRect(start, top, end - start + 0.5, row_height - 0.5);
      });
    });
    draw_cursor();
  };
  const draw_cursor = () => {
    if (!still.width) return;
    const pen = canvas.getContext("2d"), ratio = window.devicePixelRatio || 1;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(still, 0, 0);
    pen.scale(ratio, ratio);
    pen.strokeStyle = getComputedStyle(document.getElementById("replay-strip")).color;
    const x = place_of(time_now(), canvas.clientWidth);
    pen.beginPath();
    pen.moveTo(x, 12);
    pen.lineTo(x, canvas.clientHeight);
    pen.stroke();
  };

  // Name and activation of the muscle at the pointer.
  const label = document.getElementById("replay-pointer"), ray = new MeshCat.THREE.Raycaster();
  const muscle_of = new Map();
  const activation_now = muscle => {
    const step = data.t.findLastIndex(t => t <= time_now() + 1e-6);
    return data.activation[Math.max(step, 0)][muscle];
  };
  const find_muscle = (x, y) => {
    const box = viewer.renderer.domElement.getBoundingClientRect();
    const at = { x: 2 * (x - box.left) / box.width - 1, y: 1 - 2 * (y - box.top) / box.height };
    ray.setFromCamera(at, viewer.camera);
    const [hit] = ray.intersectObjects([...muscle_of.keys()], false);
    return hit && muscle_of.get(hit.object);
  };
  viewer.dom_element.addEventListener("pointermove", event => {
    const muscle = find_muscle(event.clientX, event.clientY);
    label.style.display = muscle === undefined ? "none" : "block";
    if (muscle === undefined) return;
    label.textContent = data.muscles[muscle] + ": " + activation_now(muscle).toFixed(2);
    label.style.left = event.clientX + 14 + "px";
    label.style.top = event.clientY + 14 + "px";
  });

  // The mass of the load, above it.
  const load_label = document.getElementById("replay-load"), place = new MeshCat.THREE.Vector3();
  const show_load = () => {
    if (!data.load) return;
    const box = viewer.renderer.domElement.getBoundingClientRect();
    viewer.scene_tree.find(["drakearm", "arm", "load"]).object.getWorldPosition(place);
    place.y += 0.09;
    place.project(viewer.camera);
    load_label.textContent = data.load;
    load_label.style.display = "block";
    load_label.style.left = box.left + box.width * (place.x + 1) / 2 + "px";
    load_label.style.top = box.top + box.height * (1 - place.y) / 2 + "px";
  };

  const show_time = () => {
    if (animator.playing && !loop && time_now() >= data.duration - 1e-3) seek(data.duration);
    slider.value = time_now();
    clock.value = time_now().toFixed(2) + " s";
    draw_cursor();
    show_load();
    requestAnimationFrame(show_time);
  };
  commands.then(() => setTimeout(() => {
    data.muscles.forEach((name, m) => viewer.scene_tree.find(["drakearm", "muscles", name]).object.traverse(shape => {
      if (shape.isMesh) muscle_of.set(shape, m);
    }));
    set_speed(0.25);
    set_background();
    show_view("oblique");
    seek_address();
    show_time();
    document.body.dataset.replay = "ready"; // for tests
  }));
  window.addEventListener("resize", draw_strip);
}
