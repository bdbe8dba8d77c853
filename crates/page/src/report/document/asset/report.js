// The report: a chosen cell of the heat map shows its path beside the recorded ones; one time moves every chart.
"use strict";
(() => {
  const $ = id => document.getElementById(id);
  const makeClock = (end, times) => realgap.clock(end, { times, everywhere: false, playing: false });
  let clock = $("scene-data") ? realgap.replay(makeClock).clock : null;
  const over = [...document.querySelectorAll("[data-chart=time]")];
  const points = $("point-data") && JSON.parse($("point-data").textContent);
  if (!clock && over.length) {
    // The longest time that a chart shows.
    const end = points ? points.duration_s : Math.max(...over.map(svg => Number(svg.dataset.x.split(" ")[1])));
    clock = makeClock(end, Float64Array.from({ length: 241 }, (_, k) => end * k / 240));
  }
  const own = ["path", "along", "error"];
  if (clock) over.filter(svg => !own.includes(svg.id)).forEach(svg => realgap.live(clock, svg, []));
  if (clock && points && $("path")) chosenPoint();
  if (clock) clock.begin();
  realgap.ready = true;

  function chosenPoint() {
    const column = realgap.reader($("path-data").textContent);
    const read = duration => {
      const x = column(points.step), y = column(points.step), last = Math.max(x.length - 1, 1);
      return { x, y, t: x.map((_, k) => duration * k / last) };
    };
    const paths = points.rows.map(() => read(points.duration_s));
    const recorded = points.recorded.map(([, duration]) => read(duration));
    const best = points.best;
    const moving = { recorded: false, kind: "sim", t: [], x: [], y: [] };
    const tracks = [...recorded.map(path => ({ ...path, recorded: true })), moving];
    const live = own.map($).filter(Boolean).map(svg => realgap.live(clock, svg, svg.id === "path" ? tracks : []));
    // Distances at equal times since the start.
    const distances = (a, b) => a.t.map((t, k) => {
      const at = realgap.place(b.t, t);
      return t > b.t[b.t.length - 1] + 1e-9 ? NaN : Math.hypot(a.x[k] - realgap.mix(b.x, at), a.y[k] - realgap.mix(b.y, at));
    });
    const finite = (x, y) => { const keep = [...x.keys()].filter(k => Number.isFinite(y[k])); return { x: keep.map(k => x[k]), y: keep.map(k => y[k]) }; };
    // How far each recorded run is from the mean of the others.
    const bands = [];
    if (recorded.length > 1) {
      const t = recorded[0].t;
      const each = [...t].map(time => {
        const places = recorded.filter(path => time <= path.t[path.t.length - 1] + 1e-9)
          .map(path => { const at = realgap.place(path.t, time); return [realgap.mix(path.x, at), realgap.mix(path.y, at)]; });
        if (places.length < 2) return [NaN, NaN];
        const sum = places.reduce((s, p) => [s[0] + p[0], s[1] + p[1]], [0, 0]);
        const from = places.map(p => Math.hypot(...[0, 1].map(axis => p[axis] - (sum[axis] - p[axis]) / (places.length - 1))));
        return [Math.min(...from), Math.max(...from)];
      });
      const keep = [...t.keys()].filter(k => Number.isFinite(each[k][0]));
      bands.push({ x: keep.map(k => t[k]), low: keep.map(k => each[k][0]), high: keep.map(k => each[k][1]) });
    }
    const heat = $("heat");
    const cells = heat ? [...heat.querySelectorAll("[data-point]")] : [];
    // The cell of each point of the grid, by the point's row.
    const cellOf = new Map(cells.map(cell => [Number(cell.dataset.point), cell]));
    const marker = heat && realgap.svg("rect", { class: "frame chosen" }, heat);
    const words = k => points.names.map((name, axis) => name + " = " + Number(points.rows[k][0][axis].toPrecision(4))).join(", ");
    let chosen = best;
    const choose = k => {
      chosen = k;
      const path = paths[k], isBest = k === best;
      Object.assign(moving, path);
      const lines = f => [
        ...recorded.map(one => ({ ...f(one), kind: "real" })),
        ...(isBest ? [] : [{ ...f(paths[best]), kind: "faint" }]),
        { ...f(path), kind: "sim" },
      ];
      realgap.redraw($("path"), { map: true, lines: lines(one => ({ x: one.x, y: one.y })) });
      realgap.redraw($("along"), { lines: lines(one => ({ x: one.t, y: one.x })) });
      if ($("error")) realgap.redraw($("error"), {
        fromZero: true, bands,
        lines: path.t.length ? recorded.map(one => ({ ...finite(path.t, distances(path, one)), kind: "sim" })) : [],
      });
      // The best point may lie between the cells; then its star alone marks it.
      if (marker) for (const name of ["x", "y", "width", "height"]) marker.setAttribute(name, cellOf.has(k) ? cellOf.get(k).getAttribute(name) : 0);
      const score = points.rows[k][1];
      $("chosen").textContent = words(k) + ": " + (isBest ? "the best point" : score === null ? "diverged"
        : "score " + Number(score.toPrecision(3)) + (points.rows[k][2] ? ", in the confidence set" : ""))
        + (path.t.length ? "." : "; no path is stored.");
      $("legend-best").hidden = isBest;
      live.forEach(one => one.renew(realgap.state().time));
    };
    cells.forEach(cell => cell.addEventListener("click", () => choose(Number(cell.dataset.point))));
    const values = heat && [0, 1].map(axis => [...new Set([...cellOf.keys()].map(k => points.rows[k][0][axis]))].sort((a, b) => a - b));
    const nearest = (all, value) => all.reduce((best, v, k) => Math.abs(v - value) < Math.abs(all[best] - value) ? k : best, 0);
    if (heat) heat.addEventListener("keydown", event => {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!by) return;
      event.preventDefault();
      const wanted = [0, 1].map(axis => {
        const at = nearest(values[axis], points.rows[chosen][0][axis]) + by[axis];
        return values[axis][Math.min(Math.max(at, 0), values[axis].length - 1)];
      });
      const found = points.rows.findIndex(row => row[0][0] === wanted[0] && row[0][1] === wanted[1]);
      if (found >= 0) choose(found);
    });
    choose(best);
    realgap.chosen = () => chosen;
  }
})();
