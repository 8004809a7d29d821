"use strict";
// Draws the frames of a result with Plotly. The page holds centre lines, directors and quantities only;
// surfaces, spheres and supports are made here for the frame that is shown.

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const element = (id) => document.getElementById(id);
  const SIDES = 10; // of a tube
  const PLAIN = "#0072B2";
  const SPHERE = "#56B4E9";
  const SUPPORT = "#8c8c8c";
  const LOAD = "#D55E00";
  const ACTUATED = ["#CC79A7", "#E69F00", "#6F42F5", "#56B4E9"];
  const NEGATIVE = ["#704361", "#7f5700", "#3d2487", "#2f637f"]; // the same, dark
  const SLEEVE = 0.3; // how far a sleeve is from its rod and from the one within it, in symbols

  // Vectors.
  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const scale = (f, a) => [f * a[0], f * a[1], f * a[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
  ];
  const unit = (a, fallback) => {
    const length = Math.sqrt(dot(a, a));
    return length > 1e-12 ? scale(1 / length, a) : fallback;
  };
  // Any unit vector across `a`.
  const across = (a) => unit(cross(a, Math.abs(a[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]), [0, 1, 0]);

  const bytes = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const floats = (text) => new Float32Array(bytes(text).buffer);
  const rods = data.rods.map((rod) => ({
    ...rod,
    positions: floats(rod.positions),
    directors: floats(rod.directors),
    fields: Object.fromEntries(Object.entries(rod.fields).map(([k, v]) => [k, floats(v)])),
  }));

  const lineOf = (rod, frame) => {
    const line = [];
    for (let i = 0; i < rod.nodes; i++) {
      const at = 3 * (frame * rod.nodes + i);
      line.push([rod.positions[at], rod.positions[at + 1], rod.positions[at + 2]]);
    }
    return line;
  };
  // Director 1 at the nodes, along the width of the section; none where round ones lie in any way.
  const directorsOf = (rod, frame) => {
    const all = rod.directors;
    if (all.length === 0) return null;
    const start = (i) => (all.length === 3 ? 0 : 3 * (frame * rod.nodes + i));
    return Array.from({ length: rod.nodes }, (_, i) => Array.from(all.slice(start(i), start(i) + 3)));
  };
  const valueOf = (rod, frame, name, i) => rod.fields[name][frame * rod.nodes + i];

  // A mesh to fill: corners, triangles, and a value for each corner.
  const newMesh = () => ({ x: [], y: [], z: [], i: [], j: [], k: [], intensity: [] });
  const corner = (mesh, point, value) => {
    mesh.x.push(point[0]);
    mesh.y.push(point[1]);
    mesh.z.push(point[2]);
    mesh.intensity.push(value);
    return mesh.x.length - 1;
  };
  const triangle = (mesh, a, b, c) => {
    mesh.i.push(a);
    mesh.j.push(b);
    mesh.k.push(c);
  };

  const circle = (radius) =>
    Array.from({ length: SIDES }, (_, side) => {
      const angle = (2 * Math.PI * side) / SIDES;
      return [radius * Math.cos(angle), radius * Math.sin(angle)];
    });
  const addTube = (mesh, line, radius, values) => addSwept(mesh, line, circle(radius), null, values);

  // Adds the surface that an outline sweeps along a line, its corners being given along director 1
  // and across it; at a node the surfaces of two edges meet on the bisecting plane. Without
  // directors the outline is carried along.
  const addSwept = (mesh, line, outline, directors, values) => {
    const sides = outline.length;
    const edges = [];
    for (let i = 0; i + 1 < line.length; i++) {
      edges.push(unit(sub(line[i + 1], line[i]), edges[i - 1] || [1, 0, 0]));
    }
    let normal = directors ? directors[0] : across(edges[0]);
    let previous = -1;
    line.forEach((point, node) => {
      const before = edges[Math.max(node - 1, 0)];
      const after = edges[Math.min(node, edges.length - 1)];
      const tangent = unit(add(before, after), after);
      if (directors) normal = directors[node];
      normal = unit(sub(normal, scale(dot(normal, tangent), tangent)), across(tangent));
      const other = cross(tangent, normal);
      const bend = unit(sub(after, before), [0, 0, 0]);
      const stretch = 1 / Math.max(dot(tangent, after), 0.5) - 1;
      const first = mesh.x.length;
      for (const [u, v] of outline) {
        let offset = add(scale(u, normal), scale(v, other));
        offset = add(offset, scale(stretch * dot(offset, bend), bend));
        corner(mesh, add(point, offset), values[node]);
      }
      for (let side = 0; previous >= 0 && side < sides; side++) {
        const next = (side + 1) % sides;
        triangle(mesh, previous + side, previous + next, first + side);
        triangle(mesh, previous + next, first + next, first + side);
      }
      if (node === 0 || node === line.length - 1) {
        const middle = corner(mesh, point, values[node]);
        for (let side = 0; side < sides; side++) {
          triangle(mesh, first + side, first + ((side + 1) % sides), middle);
        }
      }
      previous = first;
    });
  };

  // The unit sphere as rings of longitude and latitude.
  const addSphere = (mesh, centre, radius, rings) => {
    const first = mesh.x.length;
    const around = 2 * rings;
    for (let ring = 0; ring <= rings; ring++) {
      const polar = (Math.PI * ring) / rings;
      for (let step = 0; step < around; step++) {
        const angle = (2 * Math.PI * step) / around;
        const direction = [
          Math.sin(polar) * Math.cos(angle),
          Math.sin(polar) * Math.sin(angle),
          Math.cos(polar),
        ];
        corner(mesh, add(centre, scale(radius, direction)), 0);
      }
    }
    for (let ring = 0; ring < rings; ring++) {
      for (let step = 0; step < around; step++) {
        const a = first + ring * around + step;
        const b = first + ring * around + ((step + 1) % around);
        triangle(mesh, a, b, a + around);
        triangle(mesh, b, b + around, a + around);
      }
    }
  };

  // A box around `centre` with half sides along three vectors.
  const addBox = (mesh, centre, u, v, w) => {
    const first = mesh.x.length;
    for (let n = 0; n < 8; n++) {
      const signs = [n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1];
      const offset = add(add(scale(signs[0], u), scale(signs[1], v)), scale(signs[2], w));
      corner(mesh, add(centre, offset), 0);
    }
    const faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    for (const [a, b, c, d] of faces) {
      triangle(mesh, first + a, first + b, first + c);
      triangle(mesh, first + a, first + c, first + d);
    }
  };

  // A pyramid whose tip is the node, on the ground, or on a gap where it can roll.
  const addPyramid = (mesh, tip, down, size, rolls) => {
    const u = scale(0.55 * size, across(down));
    const v = scale(0.55 * size, unit(cross(down, u), [0, 0, 1]));
    const base = add(tip, scale(size, down));
    const first = corner(mesh, tip, 0);
    for (const [a, b] of [[1, 1], [1, -1], [-1, -1], [-1, 1]]) {
      corner(mesh, add(base, add(scale(a, u), scale(b, v))), 0);
    }
    for (let side = 1; side <= 4; side++) triangle(mesh, first, first + side, first + (side % 4) + 1);
    triangle(mesh, first + 1, first + 2, first + 3);
    triangle(mesh, first + 1, first + 3, first + 4);
    const ground = add(base, scale(rolls ? 0.4 * size : 0.08 * size, down));
    addBox(mesh, ground, scale(1.6, u), scale(1.6, v), scale(0.08 * size, down));
  };

  const addSupport = (mesh, support, line, frame) => {
    const node = line[support.place];
    const size = data.symbol;
    if (support.kind !== "clamp") {
      addPyramid(mesh, node, support.down, size, support.kind === "roller");
      return;
    }
    const along = support.tangents[support.tangents.length > 1 ? frame : 0];
    const u = scale(size, across(along));
    const v = scale(size, unit(cross(along, u), [0, 0, 1]));
    const last = line.length - 1;
    if (!support.slides && (support.place === 0 || support.place === last)) {
      const thick = scale((support.place === 0 ? -0.12 : 0.12) * size, along);
      addBox(mesh, add(node, thick), u, v, thick); // a wall behind the end
    } else {
      addBox(mesh, node, scale(0.6, u), scale(0.6, v), scale(0.6 * size, along));
    }
  };

  // A cone whose tip is at `tip`, pointing along a unit vector.
  const addCone = (mesh, tip, along, length) => {
    const u = scale(0.36 * length, across(along));
    const v = cross(along, u);
    const base = sub(tip, scale(length, along));
    const first = corner(mesh, tip, 0);
    for (let side = 0; side < SIDES; side++) {
      const angle = (2 * Math.PI * side) / SIDES;
      const offset = add(scale(Math.cos(angle), u), scale(Math.sin(angle), v));
      corner(mesh, add(base, offset), 0);
    }
    const middle = corner(mesh, base, 0);
    for (let side = 0; side < SIDES; side++) {
      const [a, b] = [first + 1 + side, first + 1 + ((side + 1) % SIDES)];
      triangle(mesh, first, a, b);
      triangle(mesh, middle, a, b);
    }
  };

  const addArrow = (mesh, tail, tip, size) => {
    const along = unit(sub(tip, tail), [1, 0, 0]);
    addTube(mesh, [tail, sub(tip, scale(0.5 * size, along))], 0.07 * size, [0, 0]);
    addCone(mesh, tip, along, size);
  };

  // An arrow ends at its point, but one that pulls an end along the rod begins there. Returns where
  // its text stands, and in which direction from there.
  const addForce = (mesh, load, point, line, size) => {
    const last = line.length - 1;
    const atStart = load.place === 0 && load.share < 1e-6;
    const atEnd = load.place === last - 1 && load.share > 1 - 1e-6;
    let outwards = [0, 0, 0];
    if (atStart) outwards = unit(sub(line[0], line[1]), outwards);
    if (atEnd) outwards = unit(sub(line[last], line[last - 1]), outwards);
    const reach = scale((load.kind === "line" ? 2 : 4) * size, load.along);
    const pulls = dot(outwards, load.along) > 0.5;
    const [tail, tip] = pulls ? [point, add(point, reach)] : [sub(point, reach), point];
    addArrow(mesh, tail, tip, (load.kind === "line" ? 0.6 : 1) * size);
    return pulls ? [tip, load.along] : [tail, scale(-1, load.along)];
  };

  // Three quarters of a circle about the axis, with a head. Returns the same.
  const addMoment = (mesh, axis, point, size) => {
    const u = across(axis);
    const v = cross(axis, u);
    const arc = [];
    for (let n = 0; n <= 24; n++) {
      const angle = Math.PI * (-0.85 + (1.4 * n) / 24);
      const offset = add(scale(Math.cos(angle), u), scale(Math.sin(angle), v));
      arc.push(add(point, scale(1.6 * size, offset)));
    }
    addTube(mesh, arc, 0.07 * size, arc.map(() => 0));
    const along = unit(sub(arc[24], arc[23]), v);
    addCone(mesh, add(arc[24], scale(0.8 * size, along)), along, size);
    return [add(point, [0, 1.6 * size, 0]), [0, 1, 0]];
  };

  // The state of the view.
  const state = { frame: 0, chapter: 0, quantity: "", speed: 1, playing: false, fits: 0 };
  const range = () => data.fields[state.quantity];
  const title = (name, unit) => (unit ? `${name} [${unit}]` : name);
  const LIGHT = { ambient: 0.75, diffuse: 0.5, specular: 0.08, roughness: 0.8 };

  const colourOf = () =>
    range()
      ? { colorscale: "Viridis", cmin: range().low, cmax: range().high, showscale: false }
      : { color: PLAIN };

  // Without intensities a mesh has one colour; an empty list of them would make it black.
  const plain = ({ intensity, ...mesh }) => mesh;

  const centreLines = (frame) => {
    const trace = { type: "scatter3d", mode: "lines", hoverinfo: "text", x: [], y: [], z: [] };
    trace.text = [];
    const values = [];
    for (const rod of rods) {
      lineOf(rod, frame).forEach((point, i) => {
        trace.x.push(point[0]);
        trace.y.push(point[1]);
        trace.z.push(point[2]);
        values.push(range() ? valueOf(rod, frame, state.quantity, i) : 0);
        trace.text.push(tip(rod, frame, i));
      });
      for (const list of [trace.x, trace.y, trace.z]) list.push(null);
      values.push(range() ? range().low : 0);
      trace.text.push("");
    }
    trace.line = { width: 5, color: PLAIN };
    if (range()) {
      trace.line = {
        width: 5,
        color: values,
        colorscale: "Viridis",
        cmin: range().low,
        cmax: range().high,
        showscale: true,
        colorbar: {
          title: { text: title(state.quantity, range().unit), side: "right" },
          thickness: 14,
          len: 0.7,
          outlinewidth: 0,
        },
      };
    }
    return trace;
  };

  const tip = (rod, frame, i) => {
    const lines = [`${rod.name}, node ${i}`];
    for (const [name, field] of Object.entries(data.fields)) {
      lines.push(`${name} ${valueOf(rod, frame, name, i).toPrecision(4)} ${field.unit}`.trim());
    }
    return lines.join("<br>");
  };

  const tubes = (frame) => {
    const mesh = newMesh();
    for (const rod of rods.filter((one) => one.outline.length)) {
      const values = Array.from({ length: rod.nodes }, (_, i) =>
        range() ? valueOf(rod, frame, state.quantity, i) : 0,
      );
      addSwept(mesh, lineOf(rod, frame), rod.outline, directorsOf(rod, frame), values);
    }
    const filled = range() ? mesh : plain(mesh);
    return { type: "mesh3d", hoverinfo: "skip", lighting: LIGHT, ...filled, ...colourOf() };
  };

  const spheres = (frame) => {
    const mesh = newMesh();
    const count = rods.reduce((sum, rod) => sum + rod.spheres.length, 0);
    for (const rod of rods) {
      const line = lineOf(rod, frame);
      for (const [i, radius] of rod.spheres) addSphere(mesh, line[i], radius, count > 20 ? 8 : 20);
    }
    const look = { color: SPHERE, opacity: 0.35, lighting: LIGHT, hoverinfo: "skip" };
    return { type: "mesh3d", ...plain(mesh), ...look };
  };

  const springPlace = (spring, frame) => {
    const line = lineOf(rods[spring.rod], frame);
    return spring.nodes.reduce(
      (sum, node, k) => add(sum, scale(spring.weights[k], line[node])),
      [0, 0, 0],
    );
  };
  const loadsAt = (frame, isKind) => data.loads[data.load_set[frame]].filter(isKind);
  const isFoundation = (load) => load.kind === "foundation";
  const loadPlace = (load, line) => {
    const [from, to] = [line[load.place], line[load.place + 1]];
    return add(from, scale(load.share, sub(to, from)));
  };
  const SPRING = 3; // length of a spring, and where the spiral ends, in symbols
  const SPIRAL = 1.4;
  const FOUNDATION = 1; // length of the springs of a foundation, in symbols

  const supports = (frame) => {
    const mesh = newMesh();
    const size = data.symbol;
    for (const support of data.supports) {
      addSupport(mesh, support, lineOf(rods[support.rod], frame), frame);
    }
    const ground = (place, distance, along, width) => {
      const u = scale(width * size, across(along));
      const v = scale(width * size, unit(cross(along, u), [0, 0, 1]));
      const thick = scale(0.08 * size, along);
      addBox(mesh, add(add(place, scale(distance * size, along)), thick), u, v, thick);
    };
    for (const spring of data.springs) {
      const place = springPlace(spring, frame);
      for (const along of spring.along) ground(place, SPRING, along, 0.8);
      if (spring.turns) ground(place, SPIRAL, [1, 0, 0], 0.4);
    }
    for (const load of loadsAt(frame, isFoundation)) {
      ground(loadPlace(load, lineOf(rods[load.rod], frame)), FOUNDATION, load.along, 0.4);
    }
    const look = { color: SUPPORT, flatshading: true, lighting: LIGHT, hoverinfo: "skip" };
    return { type: "mesh3d", ...plain(mesh), ...look };
  };

  // Zigzag lines to the ground, and spirals of springs against turning.
  const springs = (frame) => {
    const path = { x: [], y: [], z: [] };
    const draw = (points) => {
      for (const point of points) {
        for (const [n, list] of [path.x, path.y, path.z].entries()) list.push(point[n]);
      }
      for (const list of [path.x, path.y, path.z]) list.push(null); // the pen is lifted
    };
    const size = data.symbol;
    const zigzag = (from, to, width) => {
      const vector = sub(to, from);
      const side = scale(width * size, across(unit(vector, [0, 0, 1])));
      const shares = [0, 0, 1, -1, 1, -1, 1, -1, 0, 0];
      const along = (k) => add(from, scale(k / (shares.length - 1), vector));
      draw(shares.map((share, k) => add(along(k), scale(share, side))));
    };
    const toGround = (place, along, length) =>
      zigzag(place, add(place, scale(length * size, along)), length / 6);
    for (const load of loadsAt(frame, isFoundation)) {
      toGround(loadPlace(load, lineOf(rods[load.rod], frame)), load.along, FOUNDATION);
    }
    for (const ends of data.axial_springs) {
      zigzag(...ends.map((end) => lineOf(rods[end.rod], frame)[end.place]), SPRING / 6);
    }
    for (const spring of data.springs) {
      const place = springPlace(spring, frame);
      for (const along of spring.along) toGround(place, along, SPRING);
      if (spring.turns) {
        const turns = Array.from({ length: 49 }, (_, k) => k / 48);
        draw(
          turns.map((t) =>
            add(place, scale(SPIRAL * size * t, [Math.cos(12.6 * t), Math.sin(12.6 * t), 0])),
          ),
        );
      }
    }
    const look = { line: { color: SUPPORT, width: 4 }, hoverinfo: "skip" };
    return { type: "scatter3d", mode: "lines", ...path, ...look };
  };

  // White circles: rods turn freely there.
  const hinges = (frame) => {
    if (data.hinges.length === 0) return [];
    const places = data.hinges.map((hinge) => lineOf(rods[hinge.rod], frame)[hinge.place]);
    const [x, y, z] = [0, 1, 2].map((n) => places.map((place) => place[n]));
    const marker = { size: 6, color: "white", line: { color: SUPPORT, width: 2 } };
    return [{ type: "scatter3d", mode: "markers", x, y, z, marker, hoverinfo: "skip" }];
  };

  // Arrows, and what stands beside them. Texts are annotations: Plotly shrinks those of a trace
  // when they change.
  const loads = (frame) => {
    const mesh = newMesh();
    const labels = [];
    for (const load of loadsAt(frame, (one) => !isFoundation(one))) {
      const line = lineOf(rods[load.rod], frame);
      const point = loadPlace(load, line);
      const [place, away] =
        load.kind === "moment"
          ? addMoment(mesh, load.along, point, data.symbol)
          : addForce(mesh, load, point, line, data.symbol);
      const gap = (Math.abs(away[0]) > Math.abs(away[1]) ? 1.6 : 0.6) * data.symbol;
      if (load.text) labels.push(note(load.text, add(place, scale(gap, away)), { color: LOAD, size: 13 }));
    }
    const look = { color: LOAD, lighting: LIGHT, hoverinfo: "skip" };
    return [{ type: "mesh3d", ...plain(mesh), ...look }, labels];
  };

  // Sleeves around the actuated stretches: pale where the value is small, dark where it is negative.
  const sleeves = (frame) =>
    data.actuation.map((band, number) => {
      const mesh = newMesh();
      const rod = rods[band.rod];
      const line = lineOf(rod, frame);
      const points = band.points.map(([place, share]) => loadPlace({ place, share }, line));
      const reach = Math.max(0, ...rod.outline.map(([u, v]) => Math.hypot(u, v)));
      const radius = reach + SLEEVE * (1 + band.level) * data.symbol;
      addTube(mesh, points, radius, band.points.map((point) => band.sizes[frame] * point[2]));
      const colours = [NEGATIVE, ACTUATED].map((list) => list[number % list.length]);
      return {
        type: "mesh3d",
        hoverinfo: "skip",
        lighting: LIGHT,
        opacity: 0.25,
        ...mesh,
        colorscale: [[0, colours[0]], [0.5, "#f7f7f7"], [1, colours[1]]],
        cmin: -1,
        cmax: 1,
        showscale: false,
      };
    });
  const showLegend = (frame) => {
    data.actuation.forEach((band, number) => {
      const entry = element("legend").children[number];
      const colours = band.sizes[frame] < 0 ? NEGATIVE : ACTUATED;
      entry.style.borderColor = colours[number % colours.length];
      entry.textContent = `${band.name}: ${band.texts[band.texts.length > 1 ? frame : 0]}`;
    });
  };

  // A text at a point, always upright and of the same size on the screen.
  const note = (text, [x, y, z], font, place) => ({ x, y, z, text, font, showarrow: false, ...place });

  // Seen from the front, Plotly's own titles of axes lie on their ticks: these stand at their ends.
  const axisTitles = () => {
    // Inside by a little: Plotly leaves out what rounding puts beyond the ends.
    const inside = (n, share) => data.low[n] + share * (data.high[n] - data.low[n]);
    const [low, high] = [0, 1].map((end) => [0, 1].map((n) => inside(n, 1e-6 + end * (1 - 2e-6))));
    const font = { color: colour("text"), size: 13 };
    return [
      note(data.axes[0], [high[0], low[1], 0], font, { xanchor: "left", xshift: 10 }),
      note(data.axes[1], [low[0], high[1], 0], font, { yanchor: "bottom", yshift: 10 }),
    ];
  };

  const axis = (n, share, shown) => ({
    title: { text: data.flat ? "" : data.axes[n] },
    range: [data.low[n], data.high[n]],
    visible: shown,
    ...(data.flat ? { tickangle: 0 } : {}),
    exponentformat: "none",
    showspikes: false,
    showbackground: false,
    gridcolor: colour("line"),
    zeroline: false,
    nticks: Math.min(7, 2 + Math.ceil(7 * share)), // short axes have room for few
  });

  const colour = (name) => getComputedStyle(document.body).getPropertyValue(`--${name}`);
  const NUMBERS = 90; // pixels beside the scene that its numbers take
  const layout = (labels) => {
    const size = data.high.map((value, n) => value - data.low[n]);
    const flat = data.flat;
    // At the distance of the camera about this much of height is seen, and of width by the window.
    const box = element("scene").getBoundingClientRect();
    const seen = flat ? 0.88 : 1.0;
    const wide = (seen * Math.max(box.width - NUMBERS, 1)) / Math.max(box.height, 1);
    const zoom = flat
      ? Math.min((0.87 * wide) / size[0], seen / size[1])
      : Math.min(seen, wide) / Math.max(...size);
    const [x, y, z] = size.map((value) => zoom * value);
    const share = (n) => size[n] / Math.max(...size);
    return {
      margin: { l: 0, r: 0, t: 0, b: 0 },
      showlegend: false,
      uirevision: `camera ${state.fits}`, // with another one Plotly forgets where it was
      paper_bgcolor: colour("page"),
      font: { color: colour("text") },
      scene: {
        aspectmode: "manual",
        aspectratio: { x, y, z },
        xaxis: axis(0, share(0), true),
        yaxis: axis(1, share(1), true),
        zaxis: axis(2, share(2), !flat),
        annotations: flat ? [...axisTitles(), ...labels] : labels,
        dragmode: "orbit",
        // From the left, where Plotly puts the ticks of y on the left, beside their title.
        camera: flat
          ? { eye: { x: -0.14, y: 0.2, z: 1.4 }, up: { x: 0, y: 1, z: 0 } }
          : { eye: { x: 1.0, y: -1.35, z: 0.7 }, up: { x: 0, y: 0, z: 1 } },
      },
    };
  };

  const config = {
    responsive: true,
    displaylogo: false,
    modeBarButtonsToRemove: ["tableRotation", "resetCameraLastSave3d"],
    toImageButtonOptions: { filename: "der", scale: 2 },
  };

  const draw = () => {
    const { frame } = state;
    element("slider").value = frame;
    element("caption").textContent = data.captions[frame];
    showLegend(frame);
    showProbes(frame);
    const [arrows, labels] = loads(frame);
    const own = [centreLines(frame), tubes(frame), spheres(frame), supports(frame)];
    return Plotly.react("scene", [...own, arrows, ...sleeves(frame), springs(frame), ...hinges(frame)], layout(labels), config);
  };

  // Probes over time, each with its value and a line at the frame that is shown.
  const WIDE = 100; // of a picture
  const HIGH = 40;
  const shareOf = (frame) => {
    const [first, last] = [data.times[0], data.times.at(-1)];
    return (data.times[frame] - first) / (last - first);
  };
  const digits = (value) => String(Number(value.toPrecision(4)));
  const makeProbes = () => {
    element("probes").hidden = data.probes.length === 0;
    for (const probe of data.probes) {
      const { low, high } = probe;
      const points = probe.values.map(
        (value, frame) => `${WIDE * shareOf(frame)} ${(HIGH * (high - value)) / (high - low)}`,
      );
      const figure = document.createElement("figure");
      figure.innerHTML =
        `<figcaption><span></span><output></output></figcaption><svg viewBox="0 -2 ${WIDE} ${HIGH + 4}"` +
        ` preserveAspectRatio="none"><path d="M${points.join("L")}"/><path class="cursor"/></svg>` +
        `<small><span>${digits(low)}</span><span>to ${digits(high)}</span></small>`;
      figure.querySelector("span").textContent = title(probe.name, probe.unit);
      const svg = figure.querySelector("svg");
      const seek = (event) => {
        const { left, width } = svg.getBoundingClientRect();
        const apart = data.times.map((_, frame) => Math.abs(left + width * shareOf(frame) - event.clientX));
        pause();
        show(apart.indexOf(Math.min(...apart)));
      };
      svg.addEventListener("pointerdown", (event) => {
        svg.setPointerCapture(event.pointerId);
        seek(event);
      });
      svg.addEventListener("pointermove", (event) => event.buttons && seek(event));
      element("probes").append(figure);
    }
  };
  const showProbes = (frame) => {
    data.probes.forEach((probe, number) => {
      const figure = element("probes").children[number];
      figure.querySelector("output").textContent = digits(probe.values[frame]);
      figure.querySelector(".cursor").setAttribute("d", `M${WIDE * shareOf(frame)} -2v${HIGH + 4}`);
    });
  };

  // Controls.
  const chapter = () => data.chapters[state.chapter];
  const show = (frame) => {
    state.frame = Math.min(Math.max(frame, chapter().first), chapter().last);
    return draw();
  };

  const play = () => {
    state.playing = true;
    element("play").textContent = "Pause";
    const { first, last, loops } = chapter();
    if (state.frame >= last) state.frame = first;
    const start = state.frame;
    let begun = null;
    // The time [s of the run] or number of a frame, and what passes of it in a second.
    const clockOf = (frame) => (data.times ? data.times[frame] : frame);
    const rate = data.times ? state.speed : loops ? 24 : Math.max((last - first) / 10, 4);
    const round = loops ? last - first + 1 : 0;
    const tick = async (now) => {
      if (!state.playing) return;
      begun ??= now;
      let clock = clockOf(start) + ((now - begun) / 1000) * rate;
      if (loops) clock = first + ((clock - first) % round);
      let frame = start;
      if (loops) frame = Math.min(Math.floor(clock), last);
      else {
        frame = state.frame;
        while (frame < last && clockOf(frame + 1) <= clock) frame += 1;
      }
      if (frame !== state.frame) await show(frame);
      if (!loops && state.frame >= last) pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  };
  const pause = () => {
    state.playing = false;
    element("play").textContent = "Play";
  };

  const options = (id, entries, chosen, onChange) => {
    const select = element(id);
    for (const [value, text] of entries) select.add(new Option(text, value));
    select.value = chosen;
    select.addEventListener("change", () => onChange(select.value));
    element(`${id}-label`).hidden = entries.length < 2;
  };
  const choose = (number) => {
    pause();
    state.chapter = number;
    const { first, last } = chapter();
    Object.assign(element("slider"), { min: first, max: last });
    state.frame = first;
  };

  const onKey = (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const move = (frame) => {
      pause();
      show(frame);
    };
    const acts = {
      " ": () => element("play").click(),
      ArrowLeft: () => move(state.frame - 1),
      ArrowRight: () => move(state.frame + 1),
      r: () => move(chapter().first),
      f: () => {
        state.fits += 1;
        draw();
      },
    };
    if (!(event.key in acts)) return;
    event.preventDefault(); // or a button or a list that has the focus would act, too
    acts[event.key]();
  };

  const setUp = () => {
    document.title = data.title;
    element("title").textContent = data.title;
    element("note").textContent = data.note;
    for (const _ of data.actuation) element("legend").append(document.createElement("span"));
    state.quantity = data.quantity;
    state.speed = data.speeds.length ? data.speeds[Math.floor(data.speeds.length / 2)][0] : 1;
    choose(0);
    state.frame = data.start;
    options("chapter", data.chapters.map((one, n) => [n, one.title]), 0, (n) => {
      choose(Number(n));
      draw();
    });
    options("speed", data.speeds, state.speed, (value) => {
      pause();
      state.speed = Number(value);
    });
    const names = Object.keys(data.fields).map((name) => [name, name]);
    options("quantity", [...names, ["", "none"]], state.quantity, (name) => {
      state.quantity = name;
      draw();
    });
    element("play").addEventListener("click", () => (state.playing ? pause() : play()));
    element("slider").addEventListener("input", (event) => {
      pause();
      show(Number(event.target.value));
    });
    makeProbes();
    document.addEventListener("keydown", onKey);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
    const single = data.captions.length < 2;
    for (const id of ["play", "slider"]) element(id).hidden = single;
    return draw();
  };

  // The page has Plotly packed, which makes the file 1 MB smaller.
  const loadPlotly = async () => {
    const unpacked = new Blob([bytes(element("plotly").textContent)])
      .stream()
      .pipeThrough(new DecompressionStream("gzip"));
    const script = document.createElement("script");
    script.textContent = await new Response(unpacked).text();
    document.head.append(script);
  };

  const canvas = document.createElement("canvas");
  const hasWebgl = canvas.getContext("webgl2") || canvas.getContext("webgl");
  if (!hasWebgl || !("DecompressionStream" in window)) {
    element("scene").className = "message";
    element("scene").textContent =
      "This view needs WebGL, and a browser of 2023 or later. Try another browser, or turn on " +
      "hardware acceleration; der plot and der animate do without.";
    document.querySelector("footer").hidden = true;
    element("title").textContent = data.title;
    return;
  }
  loadPlotly()
    .then(setUp)
    .then(() => document.body.classList.add("ready"));
})();
