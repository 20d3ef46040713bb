// One scene of a replay: its views, the strip of angles and activations, and names at the pointer.
{
  window.fetch = unordered_fetch;
  const data = JSON.parse(document.getElementById("replay-data").textContent);
  const animator = viewer.animator;

  // Time, in s of the movement. The animation was recorded at data.speed of real time.
  let now = 0;
  const show = time => {
    now = Math.min(time, data.duration);
    animator.seek(now / data.speed);
    animator.display_progress(now / data.speed);
    draw_cursor();
  };

  // Views. Positions are in Meshcat's world, whose z points up; its cameras have y up.
  const to_camera = ([x, y, z]) => [x, z, -y];
  let view_name = "oblique";
  // The size of what the caption and the strip leave free, and how far its middle is from that of the page.
  const free_place = (width, height) => {
    const strip = document.getElementById("replay-strip");
    if (!document.body.classList.contains("beside"))
      return { free_width: width, free_height: height, across: 0.22 * strip.offsetWidth, down: 0 };
    const top = document.getElementById("replay-caption").getBoundingClientRect().bottom;
    const narrow = strip.offsetLeft > 0.25 * width; // the strip is on the right, not below
    const [right, bottom] = narrow ? [strip.offsetLeft, height] : [width, strip.offsetTop];
    return { free_width: right, free_height: bottom - top, across: 0.5 * (width - right), down: 0.5 * (height - top - bottom) };
  };
  const show_view = name => {
    view_name = name;
    const { center, radius, direction, fov } = data.views[name];
    const half = Math.PI * fov / 360, { offsetWidth: width, offsetHeight: height } = viewer.dom_element;
    const { free_width, free_height, across, down } = free_place(width, height);
    const distance = radius / Math.sin(half) / Math.min(1, free_height / height, free_width / height);
    viewer.camera.setViewOffset(width, height, across, down, width, height);
    const camera = viewer.camera, place = center.map((c, i) => c + distance * direction[i]);
    camera.fov = fov;
    camera.near = Math.max(0.01, distance - 3);
    camera.far = distance + 10;
    camera.position.set(...to_camera(place));
    viewer.set_camera_target(to_camera(center));
    viewer.set_dirty();
  };
  window.addEventListener("resize", () => show_view(view_name));

  // Light or dark: the pen of the strip has the color of the text.
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  dark.addEventListener("change", () => draw_strip());

  // The strip: angles against the reference, one row of color per muscle, and a line at the present time.
  const canvas = document.querySelector("#replay-strip canvas"), still = document.createElement("canvas");
  const left = 58;
  const place_of = (time, width) => left + (width - left - 4) * time / data.span;
  const draw_strip = () => {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return;
    for (const each of [canvas, still]) [each.width, each.height] = [width * ratio, height * ratio];
    const pen = still.getContext("2d"), angles_bottom = Math.min(100, 0.4 * height), raster_top = angles_bottom + 12;
    const text = getComputedStyle(document.getElementById("replay-strip")).color;
    pen.scale(ratio, ratio);
    pen.font = "10px system-ui, sans-serif";
    pen.fillStyle = text;
    const [low, high] = data.angles;
    const y_of = angle => angles_bottom - (angles_bottom - 14) * (angle - low) / (high - low);
    const title = width < 280 ? "deg" : "joint angles (deg)";
    pen.fillText(title, left, 9);
    let name_place = left + pen.measureText(title).width + 14;
    for (const angle of [low, high]) pen.fillText(angle.toFixed(0).replace(/^-0$/, "0"), left - 26, y_of(angle) + 3);
    data.joints.forEach((joint, j) => {
      pen.strokeStyle = pen.fillStyle = data.joint_colors[j];
      for (const [rows, dash] of [[data.reference_q, [3, 3]], [data.q, []]]) {
        pen.beginPath();
        pen.setLineDash(dash);
        rows.forEach((row, i) => pen.lineTo(place_of(data.t[i], width), y_of(row[j])));
        pen.stroke();
      }
      pen.fillText(joint, name_place, 9);
      name_place += pen.measureText(joint).width + 14;
    });
    pen.setLineDash([]);
    const rows = data.muscles.length, row_height = (height - raster_top) / rows;
    data.muscles.forEach((muscle, m) => {
      const top = raster_top + m * row_height;
      pen.fillStyle = text;
      if (row_height >= 9 || m % 2 === 0) pen.fillText(muscle.slice(0, 9), 0, top + 0.5 * row_height + 3);
      data.activation.forEach((row, i) => {
        const start = place_of(data.t[i], width);
        const end = place_of(data.t[Math.min(i + 1, data.t.length - 1)], width);
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
    const x = place_of(now, canvas.clientWidth);
    pen.beginPath();
    pen.moveTo(x, 12);
    pen.lineTo(x, canvas.clientHeight);
    pen.stroke();
  };

  // Name and activation of the muscle at the pointer.
  const label = document.getElementById("replay-pointer"), ray = new MeshCat.THREE.Raycaster();
  const muscle_of = new Map();
  const activation_now = muscle => {
    const step = data.t.findLastIndex(t => t <= now + 1e-6);
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

  const follow = () => {
    show_load();
    requestAnimationFrame(follow);
  };
  window.addEventListener("resize", draw_strip);
  window.replay_scene = commands.then(() => new Promise(done => setTimeout(() => {
    data.muscles.forEach((name, m) => viewer.scene_tree.find(["drakearm", "muscles", name]).object.traverse(shape => {
      if (shape.isMesh) muscle_of.set(shape, m);
    }));
    animator.pause(); // the clock of the controls moves it
    draw_strip();
    follow();
    done({ show, show_view, set_moving });
  })));
}
