// The report: a chosen cell of the heat map shows its path over that of the best point.
"use strict";
(() => {
  const $ = id => document.getElementById(id);
  const data = JSON.parse($("points").textContent);
  const heat = $("heat"), svg = $("path");
  if (!heat || !svg || !data.has_paths) return;
  const column = realgap.reader($("paths").textContent);
  const paths = data.rows.map(() => [column(data.step), column(data.step)]);
  const score = k => (data.rows[k][1] === null ? Infinity : data.rows[k][1]);
  let best = 0;
  data.rows.forEach((row, k) => { if (score(k) < score(best)) best = k; });
  // One scale for all points, so that paths can be compared.
  const low = [0, 0], high = [0, 0];
  for (const path of paths) path.forEach((c, axis) => c.forEach(v => {
    low[axis] = Math.min(low[axis], v); high[axis] = Math.max(high[axis], v);
  }));
  const scale = Math.min(320 / Math.max(high[0] - low[0], 1e-6), 290 / Math.max(high[1] - low[1], 1e-6));
  const middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
  const element = (name, attributes, text) => {
    const made = document.createElementNS(svg.namespaceURI, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text) made.textContent = text;
    return svg.appendChild(made);
  };
  const line = (path, kind) => {
    const points = [...path[0]].map((x, k) => (180 + (x - middle[0]) * scale).toFixed(1) + "," + (160 - (path[1][k] - middle[1]) * scale).toFixed(1));
    if (points.length) element("path", { class: "line " + kind, d: "M" + points.join("L") });
  };
  const round = [1, 2, 5].flatMap(f => [-3, -2, -1, 0, 1].map(p => f * 10 ** p)).sort((a, b) => a - b);
  const bar = round.filter(m => m * scale < 110).pop() || 0.001;
  const cells = [...heat.querySelectorAll("[data-point]")];
  const marker = heat.appendChild(document.createElementNS(svg.namespaceURI, "rect"));
  marker.setAttribute("class", "frame chosen");
  let chosen = best;
  const choose = k => {
    chosen = k;
    svg.replaceChildren();
    line(paths[best], "sim faint");
    if (k !== best) line(paths[k], "real");
    element("line", { class: "scale", x1: 14, x2: 14 + bar * scale, y1: 328, y2: 328 });
    element("text", { x: 14, y: 320 }, bar >= 1 ? bar + " m" : 100 * bar + " cm");
    for (const name of ["x", "y", "width", "height"]) marker.setAttribute(name, cells[k].getAttribute(name));
    $("chosen").textContent = cells[k].querySelector("title").textContent
      + (paths[k][0].length ? "" : ": no path is stored") + (k === best ? ". This is the best point." : ". Blue: the best point's path.")
      + " Paths are as prepared for comparison: from the origin, net displacement to the right.";
  };
  cells.forEach((cell, k) => cell.addEventListener("click", () => choose(Number(cell.dataset.point))));
  heat.addEventListener("keydown", event => {
    const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!by) return;
    event.preventDefault();
    const all = axis => [...new Set(data.rows.map(row => row[0][axis]))].sort((a, b) => a - b);
    const wanted = [0, 1].map(axis => {
      const values = all(axis);
      const at = values.indexOf(data.rows[chosen][0][axis]) + by[axis];
      return values[Math.min(Math.max(at, 0), values.length - 1)];
    });
    const found = data.rows.findIndex(row => row[0][0] === wanted[0] && row[0][1] === wanted[1]);
    if (found >= 0) choose(found);
  });
  choose(best);
  realgap.ready = true;
  realgap.chosen = () => chosen;
})();
