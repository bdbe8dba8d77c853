// What is seen in space: shapes, floor, paths, recorded runs as translucent robots or as points with a line to the run.
"use strict";
realgap.scene = (canvas, data, tracks) => {
  const T = THREE;
  // Without a graphics card smooth edges cost more than they show.
  const software = (() => {
    const probe = document.createElement("canvas").getContext("webgl2");
    if (!probe) throw new Error("no WebGL 2");
    const info = probe.getExtension("WEBGL_debug_renderer_info");
    const name = String(probe.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : probe.RENDERER));
    const lose = probe.getExtension("WEBGL_lose_context");
    if (lose) lose.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  })();
  const renderer = new T.WebGLRenderer({ canvas, antialias: !software });
  // Shadows and pixels for each unit of the page, from the finest on; frames that come too slowly lead down.
  const fine = Math.min(devicePixelRatio || 1, 2);
  const levels = [[true, fine], [false, fine], [false, Math.min(fine, 1)], [false, 0.75 * Math.min(fine, 1)], [false, 0.5 * Math.min(fine, 1)]];
  let level = software ? 2 : 0, since = 0, slow = [];
  const settle = () => {
    const [shadows, ratio] = levels[level];
    sun.castShadow = shadows;
    renderer.shadowMap.enabled = shadows;
    renderer.setPixelRatio(ratio);
    scene.traverse(o => { if (o.material) o.material.needsUpdate = true; });
  };
  const scene = new T.Scene();
  const camera = new T.PerspectiveCamera(35, 1.6, 0.005, 500);
  camera.up.set(0, 0, 1);
  const controls = new T.OrbitControls(camera, canvas);
  controls.maxPolarAngle = 0.49 * Math.PI;
  controls.enableDamping = false;

  // How large things are: the robot, and how far it goes.
  let reach = 0.02;
  for (const box of data.boxes) {
    if (box.kind === "scene") continue;
    const p = box.pose, h = box.half;
    reach = Math.max(reach, Math.hypot(...h) + Math.hypot(p[0], p[1], p[2]));
  }
  // Where the middle of a robot is, from the poses of its parts.
  const own = track => track.parts.filter(part => !(part.index >= data.parts));
  const middleOf = (track, place) => own(track).length
    ? [0, 1, 2].map(axis => own(track).reduce((sum, part) => sum + realgap.mix(part.columns[axis], place), 0) / own(track).length)
    : track.at.map(column => realgap.mix(column, place));
  const start = middleOf(tracks[0], [0, 0]);
  for (const part of own(tracks[0]))
    reach = Math.max(reach, Math.hypot(part.columns[0][0] - start[0], part.columns[1][0] - start[1]) + 0.03);
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const track of tracks)
    track.at.forEach((column, axis) => column.forEach(v => {
      low[axis] = Math.min(low[axis], v); high[axis] = Math.max(high[axis], v);
    }));
  const span = Math.hypot(high[0] - low[0], high[1] - low[1]);
  if (!data.boxes.length) reach = Math.max(0.02, 0.02 * span);
  const size = Math.max(reach * 3, 0.15);

  const world = new T.Group();
  scene.add(world);
  const sky = new T.HemisphereLight(0xffffff, 0x998877, 1.6);
  sky.position.set(0, 0, 1);
  const sun = new T.DirectionalLight(0xffffff, 1.9);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  Object.assign(sun.shadow.camera, { left: -2 * size, right: 2 * size, top: 2 * size, bottom: -2 * size, near: 0.1 * size, far: 12 * size });
  sun.shadow.bias = -0.0008;
  scene.add(sky, sun, sun.target);

  // Floor: a plane and lines, each cell a round number of metres.
  const cell = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10].find(c => c >= 0.6 * reach) || 10;
  const half = Math.ceil((0.75 * span + 8 * size) / cell) * cell;
  const floorLines = [];
  const middle = [Math.round((low[0] + high[0]) / 2 / cell) * cell, Math.round((low[1] + high[1]) / 2 / cell) * cell];
  const lines = Math.min(Math.round(half / cell), 400);
  for (let k = -lines; k <= lines; k++) {
    // In pieces: software renderers drop lines that reach behind the viewer.
    const a = k * cell, pieces = 16, piece = 2 * lines * cell / pieces;
    for (let n = 0; n < pieces; n++) {
      const from = n * piece - lines * cell;
      floorLines.push(a, from, 0, a, from + piece, 0, from, a, 0, from + piece, a, 0);
    }
  }
  const line = (numbers, colour, opacity, segments) => {
    const geometry = new T.BufferGeometry();
    geometry.setAttribute("position", new T.BufferAttribute(new Float32Array(numbers), 3));
    const material = new T.LineBasicMaterial({ transparent: opacity < 1, opacity });
    material.userData.colour = colour;
    return segments ? new T.LineSegments(geometry, material) : new T.Line(geometry, material);
  };
  const ground = new T.Group();
  const plane = new T.Mesh(new T.PlaneGeometry(2 * half + 40 * size, 2 * half + 40 * size), new T.MeshLambertMaterial());
  plane.material.userData.colour = "--floor";
  plane.receiveShadow = true;
  plane.position.z = -0.0004 * size;
  const grid = line(floorLines, "--grid", 1, true);
  grid.position.z = 0.0008 * size;
  ground.add(plane, grid);
  ground.position.set(middle[0], middle[1], data.floor.height_m - Math.tan(data.floor.slope_rad) * middle[0]);
  ground.rotation.y = data.floor.slope_rad;
  world.add(ground);

  // What is no box: triangles; faces that are not sharply turned from each other look like one rounded surface.
  const geometryOf = box => {
    if (!box.corners) return new T.BoxGeometry(...box.half.map(h => 2 * h));
    const corner = k => new T.Vector3(...box.corners.slice(3 * k, 3 * k + 3)).multiplyScalar(1e-5);
    const faces = [], at = new Map();
    for (let k = 0; k < box.triangles.length; k += 3) {
      const [a, b, c] = box.triangles.slice(k, k + 3).map(corner);
      const area = b.clone().sub(a).cross(c.clone().sub(a));
      const face = { corners: [a, b, c], area, normal: area.clone().normalize() };
      faces.push(face);
      for (const n of box.triangles.slice(k, k + 3)) at.set(n, [...(at.get(n) || []), face]);
    }
    const places = [], normals = [];
    faces.forEach((face, k) => face.corners.forEach((place, n) => {
      const normal = new T.Vector3();
      for (const other of at.get(box.triangles[3 * k + n])) if (other.normal.dot(face.normal) >= 0.82) normal.add(other.area);
      places.push(...place.toArray());
      normals.push(...normal.normalize().toArray());
    }));
    const geometry = new T.BufferGeometry();
    geometry.setAttribute("position", new T.BufferAttribute(new Float32Array(places), 3));
    geometry.setAttribute("normal", new T.BufferAttribute(new Float32Array(normals), 3));
    return geometry;
  };
  const BASE = { passive: 0xd9d3c5, active: 0x78b2d8, plate: 0xd55e00, scene: 0xa9a39a };
  const boxMesh = (box, material) => {
    const mesh = new T.Mesh(geometryOf(box), material);
    const p = box.pose;
    mesh.position.set(p[0], p[1], p[2]);
    if (p.length > 3) mesh.quaternion.set(p[4], p[5], p[6], p[3]);
    return mesh;
  };
  const edges = (mesh, colour, opacity) => {
    const all = new T.LineSegments(new T.EdgesGeometry(mesh.geometry, 35), new T.LineBasicMaterial({ transparent: true, opacity }));
    all.material.userData.colour = colour;
    mesh.add(all);
  };
  // The driven face of an active module: a thin slab, orange where it spins, yellow where it bends.
  const drivenFace = (box, mesh) => {
    const axis = box.normal.findIndex(v => Math.abs(v) > 0.5);
    const thin = 0.12 * box.half[axis];
    const half = box.half.map((h, k) => (k === axis ? thin : 1.003 * h));
    const at = [0, 0, 0];
    at[axis] = box.normal[axis] * (box.half[axis] - 0.97 * thin);
    const slab = boxMesh({ half, pose: at }, new T.MeshLambertMaterial({ color: box.spins ? 0xd55e00 : 0xf0e442 }));
    slab.castShadow = true;
    mesh.add(slab);
  };
  const sprites = [];
  const nameOf = (box, mesh) => {
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d");
    const font = "500 44px system-ui, sans-serif";
    pen.font = font;
    canvas.width = Math.ceil(pen.measureText(box.name).width) + 32;
    canvas.height = 64;
    const draw = () => {
      const style = getComputedStyle(document.documentElement);
      pen.clearRect(0, 0, canvas.width, 64);
      pen.globalAlpha = 0.85;
      pen.fillStyle = style.getPropertyValue("--card");
      pen.fillRect(0, 0, canvas.width, 64);
      pen.globalAlpha = 1;
      pen.font = font;
      pen.fillStyle = style.getPropertyValue("--ink");
      pen.fillText(box.name, 16, 47);
    };
    draw();
    const texture = new T.CanvasTexture(canvas);
    const sprite = new T.Sprite(new T.SpriteMaterial({ map: texture, depthTest: false }));
    const tall = 0.045 * size;
    sprite.scale.set(tall * canvas.width / 64, tall, 1);
    sprite.visible = false;
    sprite.renderOrder = 5;
    sprite.userData.redraw = () => { draw(); texture.needsUpdate = true; };
    mesh.add(sprite);
    sprites.push(sprite);
  };

  const ghosts = [], traces = [];
  for (const track of tracks) {
    const group = new T.Group();
    track.groups = track.parts.map(part => {
      const body = new T.Group();
      for (const box of data.boxes) {
        if (box.part !== part.index) continue;
        const material = new T.MeshLambertMaterial(track.recorded
          ? { transparent: true, opacity: 0.3, depthWrite: false } : { color: BASE[box.kind] });
        if (track.recorded) material.userData.colour = "--real";
        const mesh = boxMesh(box, material);
        edges(mesh, track.recorded ? "--real" : "--ink", track.recorded ? 0.9 : 0.55);
        if (!track.recorded) {
          mesh.castShadow = mesh.receiveShadow = true;
          if (box.normal) drivenFace(box, mesh);
          if (box.name) nameOf(box, mesh);
        }
        body.add(mesh);
      }
      group.add(body);
      return body;
    });
    const colour = track.recorded ? "--real" : "--sim";
    const dot = new T.Mesh(new T.SphereGeometry((track.parts.length ? 0.06 : 0.14) * reach, 20, 14), new T.MeshBasicMaterial());
    dot.material.userData.colour = colour;
    if (!track.recorded && track.parts.length) { dot.material.depthTest = false; dot.renderOrder = 3; }
    track.dot = dot;
    group.add(dot);
    // The path, on the floor below the tracked point: bright as far as it has come.
    const count = track.t.length, numbers = new Float32Array(3 * count);
    for (let k = 0; k < count; k++) {
      const x = track.at[0][k], y = track.at[1][k];
      numbers.set([x, y, data.floor.height_m - Math.tan(data.floor.slope_rad) * x + 0.003 * size], 3 * k);
    }
    const whole = line(numbers, colour, 0.25), gone = line(numbers, colour, 1);
    track.gone = gone;
    traces.push(whole, gone);
    world.add(whole, gone);
    if (track.recorded) {
      track.error = line([0, 0, 0, 0, 0, 0], "--real", 0.8, true);
      track.error.frustumCulled = false;
      group.add(track.error);
      ghosts.push(group, whole, gone);
    }
    world.add(group);
  }
  for (const body of data.scene) {
    const mesh = boxMesh(body, new T.MeshLambertMaterial({ color: 0xa9a39a }));
    mesh.castShadow = mesh.receiveShadow = true;
    edges(mesh, "--ink", 0.4);
    world.add(mesh);
  }

  const paint = () => {
    const style = getComputedStyle(document.documentElement);
    const colour = name => new T.Color(style.getPropertyValue(name).trim());
    scene.background = colour("--sky");
    scene.traverse(o => { if (o.material && o.material.userData.colour) o.material.color.copy(colour(o.material.userData.colour)); });
    sprites.forEach(s => s.userData.redraw());
  };
  paint();

  const q1 = new T.Quaternion(), q2 = new T.Quaternion();
  const at = new T.Vector3(), before = new T.Vector3();
  const show = (t, follow) => {
    let first = null;
    for (const track of tracks) {
      const place = realgap.place(track.t, t);
      const p = track.at.map(column => realgap.mix(column, place));
      track.dot.position.set(...p);
      track.now = p;
      track.over = t > track.t[track.t.length - 1] + 1e-6;
      track.gone.geometry.setDrawRange(0, place[0] + 1 + (place[1] >= 1 ? 1 : 0));
      track.parts.forEach((part, k) => {
        const body = track.groups[k], c = part.columns, i = place[0], j = i + 1;
        body.position.set(realgap.mix(c[0], place), realgap.mix(c[1], place), realgap.mix(c[2], place));
        q1.set(c[4][i], c[5][i], c[6][i], c[3][i]).normalize();
        q2.set(c[4][j], c[5][j], c[6][j], c[3][j]).normalize();
        body.quaternion.copy(q1.slerp(q2, place[1]));
      });
      if (!first) {
        first = p;
        const [x, y] = middleOf(track, place);
        at.set(x, y, data.floor.height_m - Math.tan(data.floor.slope_rad) * x + 0.35 * Math.min(reach, 0.3));
      }
      if (track.error) {
        const numbers = track.error.geometry.attributes.position;
        numbers.setXYZ(0, ...first); numbers.setXYZ(1, ...p);
        numbers.needsUpdate = true;
        track.error.visible = !track.over;
      }
    }
    if (follow) {
      before.copy(controls.target);
      controls.target.lerp(at, 1);
      camera.position.add(controls.target).sub(before);
    }
    sun.target.position.copy(at);
    sun.position.set(at.x + 1.6 * size, at.y - 2.2 * size, at.z + 4.5 * size);
  };
  const look = (how, everything) => {
    const ways = { oblique: [0.55, -1.15, 0.75], top: [0, -0.001, 1], side: [0, -1, 0.12] };
    const way = new T.Vector3(...ways[how]).normalize();
    let far = 2.7 * size;
    if (everything) {
      controls.target.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, data.floor.height_m);
      far = Math.max(far, 2.0 * span + 2 * size);
    }
    if (camera.aspect < 1.2) far *= 1.2 / camera.aspect;
    camera.position.copy(controls.target).addScaledVector(way, far);
    controls.update();
  };
  const fit = () => {
    const w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w || !h) return;
    renderer.setSize(w, h, false);
    camera.aspect = w / h;
    camera.updateProjectionMatrix();
  };
  const draw = playing => {
    const now = performance.now();
    if (playing && since) slow.push(now - since);
    since = playing ? now : 0;
    if (slow.length >= 8) {
      slow.sort((a, b) => a - b);
      if (slow[4] > 45 && level + 1 < levels.length) { level++; settle(); fit(); }
      slow = [];
    }
    controls.update();
    renderer.render(scene, camera);
  };
  settle();
  return {
    show, look, fit, draw, paint, controls, quality: () => ({ level, software }),
    showNames: on => sprites.forEach(s => { s.visible = on; }),
    showTraces: on => traces.forEach(t => { t.visible = on; }),
    showGhosts: (on, tracesOn) => ghosts.forEach(g => { g.visible = g.type === "Line" ? on && tracesOn : on; }),
  };
};
