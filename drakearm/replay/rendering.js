// Renders the replay smoothly also where no graphics card helps: a CSS background, cheap materials, few draw calls, and
// antialiasing only while the arm stands still.
{
  const { THREE } = MeshCat;
  const background = document.createElement("style");
  background.textContent = `
    #meshcat-pane { background: linear-gradient(#fff, #e6ebf2); }
    @media (prefers-color-scheme: dark) { #meshcat-pane { background: linear-gradient(#21262e, #14171c); } }`;
  document.head.append(background);

  window.set_moving = moving => {}; // the controls say whether the arm moves

  // Without a graphics card, antialiasing takes half of the time.
  const has_graphics_card = () => {
    const gl = viewer.renderer.getContext(), names = gl.getExtension("WEBGL_debug_renderer_info");
    return !(names && /swiftshader|llvmpipe|software/i.test(gl.getParameter(names.UNMASKED_RENDERER_WEBGL)));
  };
  const set_up_without_graphics_card = () => {
    const old = viewer.renderer, canvas = document.createElement("canvas");
    viewer.renderer = new old.constructor({ canvas, alpha: true, antialias: false });
    viewer.renderer.toneMapping = old.toneMapping;
    old.domElement.replaceWith(canvas);
    old.dispose();
    old.forceContextLoss();
    // A still picture has twice as many pixels in each direction.
    window.set_moving = moving => {
      const ratio = (moving ? 1 : 2) * window.devicePixelRatio;
      if (viewer.renderer.getPixelRatio() === ratio) return;
      viewer.renderer.setPixelRatio(ratio);
      viewer.set_3d_pane_size();
    };
    viewer.set_3d_pane_size();
  };

  // Lights that are far away take less time than Meshcat's, which are near.
  const set_up_lights = () => {
    for (const near of ["PointLightNegativeX", "PointLightPositiveX"])
      viewer.set_property(["Lights", near], "visible", false);
    for (const [name, intensity, ...from] of [["Key", 3.2, -1.5, -1.5, 2], ["Rim", 2.2, 1.5, 1.5, 2]]) {
      const light = new THREE.DirectionalLight("white", intensity);
      light.position.set(...from);
      viewer.set_object(["Lights", name], light);
    }
  };

  const simple = material => {
    const { color, opacity, transparent, side, depthWrite, depthTest } = material;
    return new THREE.MeshLambertMaterial({ color, opacity, transparent, side, depthWrite, depthTest });
  };

  // All muscles as one mesh. The pieces that the animation moves and colors stay in the scene, but are not drawn: their
  // ends are the rings of this mesh.
  const SIDES = 8;
  const angles = Array.from({ length: SIDES }, (_, k) => 2 * Math.PI * k / SIDES).map(a => [Math.cos(a), Math.sin(a)]);

  const rings_of = pieces => {
    const rings = [];
    const add = (piece, z, radius) => {
      const at = new THREE.Vector3(0, 0, z).applyMatrix4(piece.matrixWorld);
      const width = radius * new THREE.Vector3().setFromMatrixColumn(piece.matrixWorld, 0).length();
      rings.push([...at.toArray(), width, ...piece.material.color.toArray()]);
    };
    for (const piece of pieces) add(piece, 0, piece.userData.radii[0]);
    add(pieces.at(-1), 1, pieces.at(-1).userData.radii[1]);
    return rings;
  };

  class Muscles {
    constructor(node) {
      this.muscles = node.children.map(muscle => {
        const nodes = [...muscle.children].sort((a, b) => Number(a.name) - Number(b.name));
        const pieces = nodes.map(piece => piece.getObjectByProperty("isMesh", true));
        for (const piece of pieces) {
          const at = piece.geometry.attributes.position, last = at.count - 1;
          piece.userData.radii = [Math.hypot(at.getX(0), at.getY(0)), Math.hypot(at.getX(last), at.getY(last))];
          piece.material.visible = false;
        }
        return pieces;
      });
      const rings = this.muscles.reduce((sum, pieces) => sum + pieces.length + 1, 0);
      const geometry = new THREE.BufferGeometry(), faces = [];
      for (const name of ["position", "normal", "color"])
        geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * SIDES * rings), 3));
      let start = 0;
      for (const pieces of this.muscles) {
        for (let ring = 0; ring < pieces.length; ring++, start += SIDES)
          for (let k = 0; k < SIDES; k++) {
            const [a, b] = [start + k, start + (k + 1) % SIDES];
            faces.push(a, b, b + SIDES, a, b + SIDES, a + SIDES);
          }
        start += SIDES;
      }
      geometry.setIndex(faces);
      this.mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ vertexColors: true }));
      this.mesh.frustumCulled = this.mesh.matrixWorldAutoUpdate = false; // its vertices are in the world
      this.mesh.name = "all muscles"; // for tests
      viewer.scene.add(this.mesh);
    }
    update() {
      const { position, normal, color } = this.mesh.geometry.attributes;
      const along = new THREE.Vector3(), first = new THREE.Vector3(), second = new THREE.Vector3();
      let n = 0;
      for (const pieces of this.muscles) {
        const rings = rings_of(pieces);
        first.set(0.31, 0.52, 0.79);
        rings.forEach((ring, k) => {
          const before = rings[Math.max(k - 1, 0)], after = rings[Math.min(k + 1, rings.length - 1)];
          along.set(after[0] - before[0], after[1] - before[1], after[2] - before[2]);
          const slope = (after[3] - before[3]) / Math.max(along.length(), 1e-9);
          along.normalize();
          first.addScaledVector(along, -first.dot(along)).normalize(); // turns as little as possible from ring to ring
          second.crossVectors(along, first);
          for (const [x, y] of angles) {
            const out = [0, 1, 2].map(i => x * first.getComponent(i) + y * second.getComponent(i));
            position.setXYZ(n, ring[0] + ring[3] * out[0], ring[1] + ring[3] * out[1], ring[2] + ring[3] * out[2]);
            normal.setXYZ(n, out[0] - slope * along.x, out[1] - slope * along.y, out[2] - slope * along.z);
            color.setXYZ(n, ring[4], ring[5], ring[6]);
            n++;
          }
        });
      }
      for (const attribute of [position, normal, color]) attribute.needsUpdate = true;
    }
  }

  // Nothing is rendered before all is loaded, which would take longer otherwise.
  const render = viewer.render;
  viewer.render = () => {};
  if (!has_graphics_card()) set_up_without_graphics_card();
  commands.then(() => setTimeout(() => {
    viewer.set_property(["Background", "<object>"], "use_ar_background", true); // transparent
    set_up_lights();
    const muscles = new Muscles(viewer.scene_tree.find(["drakearm", "muscles"]).object);
    viewer.scene.onBeforeRender = () => muscles.update();
    viewer.scene.traverse(shape => {
      if (shape.material?.isMeshPhongMaterial && shape.material.visible) shape.material = simple(shape.material);
    });
    viewer.render = render;
  }));
}
