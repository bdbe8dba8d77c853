// The replay: data, clock, controls, charts that follow.
"use strict";
(() => {
  const $ = id => document.getElementById(id);
  const data = JSON.parse($("scene").textContent);
  const [timeStep, lengthStep, turnStep] = data.steps;
  const column = realgap.reader($("motion").textContent);
  const tracks = data.tracks.map(track => {
    const t = column(timeStep);
    const at = [0, 1, 2].map(() => column(lengthStep));
    const parts = track.parts.map(index => ({
      index,
      columns: [lengthStep, lengthStep, lengthStep, turnStep, turnStep, turnStep, turnStep].map(step => column(step)),
    }));
    return { ...track, t, at, parts };
  });
  const end = Math.max(...tracks.map(track => track.t[track.t.length - 1]));
  const run = tracks[0];

  let scene = null, trouble = "";
  try { scene = realgap.scene($("canvas"), data, tracks); }
  catch (error) { trouble = String(error && error.message || error); }
  const say = $("say");
  if (scene) say.hidden = true;
  else say.textContent = "This browser gives no WebGL (" + trouble.slice(0, 120) + "): the charts and the table below still move and hold the numbers.";
  for (const id of ["bar", "toggles", "hint", "clock"]) $(id).hidden = false;
  $("ghosts-label").hidden = tracks.length < 2;

  // Charts.
  const SVG = $("view").ownerDocument.querySelector("svg").namespaceURI;
  const element = (name, attributes, parent) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return parent.appendChild(made);
  };
  const charts = [...document.querySelectorAll("[data-chart]")].map(svg => {
    const numbers = name => svg.dataset[name].split(" ").map(Number);
    const x = numbers("x"), y = numbers("y"), [left, top, right, bottom] = numbers("box");
    const placeX = v => left + (v - x[0]) / (x[1] - x[0]) * (right - left);
    const placeY = v => bottom - (v - y[0]) / (y[1] - y[0]) * (bottom - top);
    const chart = { svg, placeX, placeY };
    if (svg.dataset.chart === "time") {
      chart.cursor = element("line", { class: "cursor", y1: top, y2: bottom }, svg);
      svg.classList.add("live");
      const move = event => {
        const box = svg.getBoundingClientRect();
        const at = (event.clientX - box.left) / box.width * 440;
        set(x[0] + (at - left) / (right - left) * (x[1] - x[0]));
      };
      svg.addEventListener("pointerdown", event => { svg.setPointerCapture(event.pointerId); pause(); move(event); });
      svg.addEventListener("pointermove", event => { if (event.buttons) move(event); });
    } else {
      chart.dots = tracks.map(track => element("circle", { class: "dot " + (track.recorded ? "real" : "sim"), r: track.recorded ? 3.5 : 4.5 }, svg));
    }
    return chart;
  });

  let time = 0, playing = false, speed = 1, asked = false;
  const at = (track, t) => { const place = realgap.place(track.t, t); return track.at.map(c => realgap.mix(c, place)); };
  const metres = m => m >= 1 ? m.toFixed(2) + " m" : m >= 0.01 ? (100 * m).toFixed(1) + " cm" : (1000 * m).toFixed(1) + " mm";
  const show = () => {
    $("time").value = String(Math.round(1000 * time / end));
    $("time").setAttribute("aria-valuetext", time.toFixed(2) + " seconds");
    const here = at(run, time);
    let text = time.toFixed(2) + " s of " + end.toFixed(2) + " s";
    const apart = tracks.slice(1).filter(track => time <= track.t[track.t.length - 1] + 1e-6)
      .map(track => { const p = at(track, time); return Math.hypot(p[0] - here[0], p[1] - here[1], p[2] - here[2]); });
    if (apart.length) text += "\n" + (apart.length > 1
      ? metres(Math.min(...apart)) + " to " + metres(Math.max(...apart)) : metres(apart[0])) + " from recorded";
    $("clock").textContent = text;
    for (const chart of charts) {
      if (chart.cursor) {
        const x = chart.placeX(time);
        chart.cursor.setAttribute("x1", x);
        chart.cursor.setAttribute("x2", x);
      } else {
        tracks.forEach((track, k) => {
          const p = at(track, time);
          chart.dots[k].setAttribute("cx", chart.placeX(p[0]));
          chart.dots[k].setAttribute("cy", chart.placeY(p[1]));
        });
      }
    }
    if (scene) scene.show(time, $("follow").checked);
    ask();
  };
  const ask = () => { if (!asked) { asked = true; requestAnimationFrame(frame); } };
  let last = 0;
  const frame = now => {
    asked = false;
    if (playing) {
      // A first frame may have begun before play was asked for.
      const step = Math.min(Math.max((now - last) / 1000, 0), 0.1) * speed;
      last = now;
      time += step;
      if (time >= end) {
        if ($("loop").checked) time %= end; else { time = end; pause(); }
      }
      show();
    }
    if (scene) scene.draw();
    realgap.frames = (realgap.frames || 0) + 1;
  };
  const set = t => { time = Math.min(Math.max(t, 0), end); show(); };
  const play = () => { playing = true; last = performance.now(); if (time >= end) time = 0; $("play").textContent = "❚❚"; ask(); };
  const pause = () => {
    playing = false; $("play").textContent = "▶";
    // The address keeps the moment, so that it can be passed on.
    try { history.replaceState(null, "", "#t=" + time.toFixed(2)); } catch { /* a page from disk may not be allowed to */ }
  };
  const toggle = () => { if (playing) pause(); else play(); };
  const step = by => {
    pause();
    const [k, share] = realgap.place(run.t, time + 1e-7);
    const index = by > 0 ? k + 1 : share > 1e-3 ? k : k - 1;
    set(run.t[Math.min(Math.max(index, 0), run.t.length - 1)]);
  };
  const hash = () => {
    const found = /[#&]t=([0-9.]+)/.exec(location.hash);
    if (found && Number.isFinite(Number(found[1]))) { playing = false; $("play").textContent = "▶"; set(Number(found[1])); return true; }
    return false;
  };

  $("play").addEventListener("click", toggle);
  $("back").addEventListener("click", () => step(-1));
  $("on").addEventListener("click", () => step(1));
  $("time").addEventListener("input", () => { playing = false; $("play").textContent = "▶"; set(Number($("time").value) / 1000 * end); });
  $("time").addEventListener("change", pause);
  $("speed").addEventListener("change", () => { speed = Number($("speed").value); });
  const ghosts = () => scene && scene.showGhosts($("ghosts").checked, $("traces").checked);
  $("follow").addEventListener("change", show);
  $("traces").addEventListener("change", () => { if (scene) { scene.showTraces($("traces").checked); ghosts(); ask(); } });
  $("names").addEventListener("change", () => { if (scene) { scene.showNames($("names").checked); ask(); } });
  $("ghosts").addEventListener("change", () => { ghosts(); ask(); });
  for (const id of ["oblique", "top", "side"])
    $(id).addEventListener("click", () => { if (scene) { scene.look(id, !$("follow").checked); ask(); } });
  const tick = id => { $(id).checked = !$(id).checked; $(id).dispatchEvent(new Event("change")); };
  addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const on = event.target;
    if (on.tagName === "SELECT" || (on.tagName === "INPUT" && on.type === "range" && event.key !== " ")) return;
    if (on.tagName === "BUTTON" && (event.key === " " || event.key === "Enter")) return;
    if (on.tagName === "INPUT" && on.type === "checkbox" && event.key === " ") return;
    const keys = {
      " ": toggle,
      ArrowLeft: () => event.shiftKey ? set(time - 1) : step(-1),
      ArrowRight: () => event.shiftKey ? set(time + 1) : step(1),
      Home: () => set(0), End: () => set(end),
      f: () => tick("follow"), l: () => tick("loop"), n: () => tick("names"), g: () => tick("ghosts"),
      "[": () => faster(-1), "]": () => faster(1),
    };
    const key = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (key) { event.preventDefault(); key(); }
  });
  const faster = by => {
    const box = $("speed");
    box.selectedIndex = Math.min(Math.max(box.selectedIndex + by, 0), box.options.length - 1);
    speed = Number(box.value);
  };
  addEventListener("hashchange", hash);
  if (scene) {
    scene.controls.addEventListener("change", ask);
    new ResizeObserver(() => { scene.fit(); ask(); }).observe($("view"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { scene.paint(); ask(); });
    scene.fit();
    scene.show(0, true);
    scene.look("oblique", false);
  }
  if (!hash()) {
    show();
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play();
  }
  realgap.ready = true;
  realgap.state = () => ({ time, playing, end });
})();
