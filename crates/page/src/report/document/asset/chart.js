// Charts that follow the clock: a cursor over time, dots on a map. What moves lies above the chart, so that the chart is not painted again.
"use strict";
realgap.metres = m => m >= 1 ? m.toFixed(2) + " m" : m >= 0.01 ? (100 * m).toFixed(1) + " cm" : (1000 * m).toFixed(1) + " mm";
realgap.svg = (name, attributes, parent) => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return parent ? parent.appendChild(made) : made;
};
// What stored values are multiplied by in a chart: it may show millimetres of metres.
realgap.factors = svg => (svg.dataset.factor || "1 1").split(" ").map(Number);
// Tracks: { t, x, y, recorded, faint }, seconds and metres in the frame of the maps.
realgap.live = (clock, svg, tracks) => {
  const numbers = name => svg.dataset[name].split(" ").map(Number);
  const holder = document.createElement("div");
  holder.className = "live";
  svg.replaceWith(holder);
  holder.appendChild(svg);
  const [, , wide, high] = svg.getAttribute("viewBox").split(" ").map(Number);
  const [timesX, timesY] = realgap.factors(svg);
  // Places as shares of the chart, so that they hold at any size.
  const places = () => {
    const x = numbers("x"), y = numbers("y"), [left, top, right, bottom] = numbers("box");
    return {
      x: v => (left + (timesX * v - x[0]) / (x[1] - x[0]) * (right - left)) / wide,
      y: v => (bottom - (timesY * v - y[0]) / (y[1] - y[0]) * (bottom - top)) / high,
      time: share => x[0] + (share * wide - left) / (right - left) * (x[1] - x[0]),
      top: top / high, bottom: bottom / high,
    };
  };
  let place = places();
  const percent = v => (100 * v).toFixed(3) + "%";
  if (svg.dataset.chart === "time") {
    const cursor = holder.appendChild(document.createElement("i"));
    cursor.className = "cursor";
    svg.classList.add("live");
    const move = event => {
      const box = svg.getBoundingClientRect();
      clock.set(place.time((event.clientX - box.left) / box.width));
    };
    svg.addEventListener("pointerdown", event => { svg.setPointerCapture(event.pointerId); clock.pause(); move(event); });
    svg.addEventListener("pointermove", event => { if (event.buttons) move(event); });
    const show = t => {
      cursor.style.left = percent(place.x(t));
      cursor.style.top = percent(place.top);
      cursor.style.bottom = percent(1 - place.bottom);
    };
    clock.follow(show);
    return { renew: t => { place = places(); show(t); } };
  }
  const dots = tracks.map(track => {
    const dot = holder.appendChild(document.createElement("i"));
    dot.className = "dot " + (track.recorded ? "real" : track.kind || "sim");
    return dot;
  });
  const show = t => tracks.forEach((track, k) => {
    dots[k].hidden = !track.t.length;
    if (!track.t.length) return;
    const at = realgap.place(track.t, t);
    dots[k].style.left = percent(place.x(realgap.mix(track.x, at)));
    dots[k].style.top = percent(place.y(realgap.mix(track.y, at)));
  });
  clock.follow(show);
  return { renew: t => { place = places(); show(t); } };
};
// Draws a chart anew, in the manner of src/plot/render/inline/lines.rs.
realgap.redraw = (svg, { lines, bands = [], map = false, fromZero = false }) => {
  const [timesX, timesY] = realgap.factors(svg);
  const scaled = (values, factor) => Array.from(values, value => factor * value);
  lines = lines.map(line => ({ ...line, x: scaled(line.x, timesX), y: scaled(line.y, timesY) }));
  bands = bands.map(band => ({ x: scaled(band.x, timesX), low: scaled(band.low, timesY), high: scaled(band.high, timesY) }));
  const [, , wide, high] = svg.getAttribute("viewBox").split(" ").map(Number);
  const [, top, , bottom] = svg.dataset.box.split(" ").map(Number);
  let x = [Infinity, -Infinity], y = fromZero ? [0, 0] : [Infinity, -Infinity];
  const see = (a, b) => {
    if (Number.isFinite(a)) { x[0] = Math.min(x[0], a); x[1] = Math.max(x[1], a); }
    if (Number.isFinite(b)) { y[0] = Math.min(y[0], b); y[1] = Math.max(y[1], b); }
  };
  for (const line of lines) line.x.forEach((v, k) => see(v, line.y[k]));
  for (const band of bands) band.x.forEach((v, k) => { see(v, band.low[k]); see(v, band.high[k]); });
  for (const range of [x, y])
    if (!(range[1] - range[0] >= 1e-9)) { const middle = Number.isFinite(range[0]) ? range[0] : 0; range[0] = middle; range[1] = middle + 1e-3; }
  const ticks = ([a, b]) => {
    const rough = (b - a) / 5, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map(f => f * power).find(s => s >= rough * 0.999) || power;
    const places = Math.min(Math.max(-Math.floor(Math.log10(step)), 0), 9), all = [];
    for (let k = Math.ceil(a / step - 1e-9); k <= b / step + 1e-9 && all.length < 21; k++) all.push([k * step, (k * step).toFixed(places).replace(/^-0(\.0*)?$/, "0$1")]);
    return all;
  };
  if (!map) {
    const room = 0.06 * (y[1] - y[0]);
    y[1] += room;
    if (y[0] !== 0) y[0] -= room;
  }
  // Numbers decide how much room they need, and of a map the room which numbers there are.
  const widest = range => Math.max(0, ...ticks(range).map(([, text]) => [...text].reduce((sum, c) => sum + (".-".includes(c) ? 5.8 : 9.9), 0)));
  const [seenX, seenY] = [x, y];
  let left = 52, right = wide - 12;
  for (let round = 0; round < 3; round++) {
    if (map) {
      const scale = 1.08 * Math.max((seenX[1] - seenX[0]) / (right - left), (seenY[1] - seenY[0]) / (bottom - top));
      [x, y] = [[seenX, right - left], [seenY, bottom - top]].map(([[a, b], length]) => [(a + b - scale * length) / 2, (a + b + scale * length) / 2]);
    }
    left = Math.round(Math.max(left, 26 + widest(y)));
    right = Math.round(Math.min(right, wide - 1 - widest(x) / 2));
  }
  svg.dataset.box = [left, top, right, bottom].join(" ");
  svg.dataset.x = x.join(" ");
  svg.dataset.y = y.join(" ");
  const axes = [...svg.querySelectorAll(".axis")].map(text => text.cloneNode(true));
  svg.replaceChildren();
  const px = v => (left + (v - x[0]) / (x[1] - x[0]) * (right - left)).toFixed(1);
  const py = v => (bottom - (v - y[0]) / (y[1] - y[0]) * (bottom - top)).toFixed(1);
  const write = (attributes, text) => { realgap.svg("text", attributes, svg).textContent = text; };
  for (const [v, text] of ticks(x)) {
    realgap.svg("line", { class: "grid", x1: px(v), x2: px(v), y1: top, y2: bottom }, svg);
    write({ x: px(v), y: bottom + 22, "text-anchor": "middle" }, text);
  }
  for (const [v, text] of ticks(y)) {
    realgap.svg("line", { class: "grid", x1: left, x2: right, y1: py(v), y2: py(v) }, svg);
    write({ x: left - 6, y: Number(py(v)) + 4, "text-anchor": "end" }, text);
  }
  axes[0].setAttribute("x", (left + right) / 2);
  axes.forEach(text => svg.appendChild(text));
  const path = (xs, ys) => [...xs].map((v, k) => px(v) + " " + py(ys[k])).join("L");
  for (const band of bands)
    if (band.x.length) realgap.svg("path", { class: "band", d: "M" + path(band.x, band.high) + "L" + path([...band.x].reverse(), [...band.low].reverse()) + "Z" }, svg);
  for (const line of lines)
    if (line.x.length) realgap.svg("path", { class: "line " + line.kind, d: "M" + path(line.x, line.y) }, svg);
};
