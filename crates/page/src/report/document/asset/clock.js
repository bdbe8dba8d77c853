// One time for everything that moves: play, pause, scrub, speed, loop, step, keys, the moment in the address.
"use strict";
realgap.clock = (end, { times, everywhere, playing: begins }) => {
  const $ = id => document.getElementById(id);
  const listeners = [], keys = {};
  let time = 0, playing = false, speed = 1, asked = false, last = 0, painted = [];
  realgap.frames = 0;
  const tell = () => {
    $("time").value = String(Math.round(1000 * time / end));
    $("time").setAttribute("aria-valuetext", time.toFixed(2) + " seconds");
    $("now").textContent = time.toFixed(2) + " s";
    for (const listener of listeners) listener(time);
    ask();
  };
  const ask = () => { if (!asked) { asked = true; requestAnimationFrame(frame); } };
  const frame = now => {
    asked = false;
    if (playing) {
      // A first frame may have begun before play was asked for.
      const took = Math.max((now - last) / 1000, 0);
      last = now;
      time += Math.min(took, 0.25) * speed;
      if (time >= end) {
        if ($("loop").checked) time %= end; else { time = end; pause(); }
      }
      tell();
    }
    for (const paint of painted) paint(playing);
    realgap.frames++;
    realgap.first = realgap.first || performance.now();
  };
  const set = t => { time = Math.min(Math.max(t, 0), end); tell(); };
  const still = () => { playing = false; $("play").textContent = "▶"; };
  const play = () => { playing = true; last = performance.now(); if (time >= end) time = 0; $("play").textContent = "❚❚"; ask(); };
  const pause = () => {
    still();
    // The address keeps the moment, so that it can be passed on.
    try { history.replaceState(null, "", "#t=" + time.toFixed(2)); } catch { /* a page from disk may not be allowed to */ }
  };
  const toggle = () => { if (playing) pause(); else play(); };
  const step = by => {
    pause();
    const [k, share] = realgap.place(times, time + 1e-7);
    const index = by > 0 ? k + 1 : share > 1e-3 ? k : k - 1;
    set(times[Math.min(Math.max(index, 0), times.length - 1)]);
  };
  const hash = () => {
    const found = /[#&]t=([0-9.]+)/.exec(location.hash);
    if (found && Number.isFinite(Number(found[1]))) { still(); set(Number(found[1])); return true; }
    return false;
  };
  const faster = by => {
    const box = $("speed");
    box.selectedIndex = Math.min(Math.max(box.selectedIndex + by, 0), box.options.length - 1);
    speed = Number(box.value);
  };
  const tick = id => { $(id).checked = !$(id).checked; $(id).dispatchEvent(new Event("change")); };
  $("bar").hidden = false;
  $("play").addEventListener("click", toggle);
  $("back").addEventListener("click", () => step(-1));
  $("on").addEventListener("click", () => step(1));
  $("time").addEventListener("input", () => { still(); set(Number($("time").value) / 1000 * end); });
  $("time").addEventListener("change", pause);
  $("speed").addEventListener("change", () => { speed = Number($("speed").value); });
  Object.assign(keys, {
    " ": toggle,
    ArrowLeft: shift => shift ? set(time - 1) : step(-1),
    ArrowRight: shift => shift ? set(time + 1) : step(1),
    Home: () => set(0), End: () => set(end),
    l: () => tick("loop"), "[": () => faster(-1), "]": () => faster(1),
  });
  addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const on = event.target;
    // Of a long page keys scroll, unless what moves has the focus.
    if (!everywhere && !on.closest(".bar, .view, [data-chart]")) return;
    if (on.tagName === "SELECT" || (on.tagName === "INPUT" && on.type === "range" && event.key !== " ")) return;
    if (on.tagName === "BUTTON" && (event.key === " " || event.key === "Enter")) return;
    if (on.tagName === "INPUT" && on.type === "checkbox" && event.key === " ") return;
    const key = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (key) { event.preventDefault(); key(event.shiftKey); }
  });
  addEventListener("hashchange", hash);
  realgap.state = () => ({ time, playing, end });
  return {
    set, pause, ask, keys, tick, end,
    /// Something that shows a moment.
    follow: listener => { listeners.push(listener); listener(time); },
    /// Something that is drawn once a frame.
    paint: painter => { painted.push(painter); ask(); },
    begin: () => {
      if (hash()) return;
      tell();
      if (begins && !matchMedia("(prefers-reduced-motion: reduce)").matches) play();
    },
  };
};
