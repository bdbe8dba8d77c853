// The robot in space: data, canvas, what can be seen or left out.
"use strict";
realgap.replay = makeClock => {
  const $ = id => document.getElementById(id);
  const data = JSON.parse($("scene-data").textContent);
  const [timeStep, lengthStep, turnStep] = data.steps;
  const column = realgap.reader($("motion-data").textContent);
  const tracks = data.tracks.map(track => {
    const t = column(timeStep);
    const at = [0, 1, 2].map(() => column(lengthStep));
    const parts = track.parts.map(index => ({
      index,
      columns: [lengthStep, lengthStep, lengthStep, turnStep, turnStep, turnStep, turnStep].map(step => column(step)),
    }));
    return { ...track, t, at, parts, x: at[0], y: at[1] };
  });
  const end = Math.max(...tracks.map(track => track.t[track.t.length - 1]));
  const clock = makeClock(end, tracks[0].t);
  const say = $("say");
  say.textContent = "Drawn once it is in sight.";
  for (const id of ["toggles", "clock"]) $(id).hidden = false;
  $("ghosts-label").hidden = tracks.length < 2;

  const at = (track, t) => { const place = realgap.place(track.t, t); return track.at.map(c => realgap.mix(c, place)); };
  // A robot that is held in place differs from its recording by how its parts are turned.
  const isHeld = data.is_held || tracks.every(track => track.at.every(c => c.every(v => Math.abs(v - c[0]) < 1e-9)));
  const turned = (track, t) => Math.max(0, ...track.parts.map(part => {
    const own = tracks[0].parts.find(other => other.index === part.index);
    if (!own) return 0;
    const q = [[track, part], [tracks[0], own]].map(([of, one]) => {
      const place = realgap.place(of.t, t), v = one.columns.slice(3).map(c => realgap.mix(c, place));
      const size = Math.hypot(...v);
      return v.map(x => x / size);
    });
    // The difference keeps small angles, which the cosine loses.
    const off = sign => Math.hypot(...q[0].map((x, k) => x - sign * q[1][k]));
    return 4 * Math.asin(Math.min(1, Math.min(off(1), off(-1)) / 2));
  }));
  const said = off => isHeld ? radians(off) : realgap.metres(off);
  const radians = rad => rad < 0.1 ? (1000 * rad).toFixed(1) + " mrad" : rad.toFixed(3) + " rad";
  clock.follow(time => {
    const here = at(tracks[0], time);
    let text = time.toFixed(2) + " s of " + end.toFixed(2) + " s";
    const distances = tracks.slice(1).filter(track => time <= track.t[track.t.length - 1] + 1e-6)
      .map(track => { if (isHeld) return turned(track, time); const p = at(track, time); return Math.hypot(p[0] - here[0], p[1] - here[1], p[2] - here[2]); });
    if (distances.length) text += "\n" + (distances.length > 1
      ? said(Math.min(...distances)) + " to " + said(Math.max(...distances)) : said(distances[0])) + (isHeld ? " at most from recorded" : " from recorded");
    $("clock").textContent = text;
  });

  let scene = null, isSeen = true;
  const ask = () => clock.ask();
  const build = () => {
    try { scene = realgap.scene($("canvas"), data, tracks); }
    catch (error) {
      say.textContent = "This browser gives no WebGL (" + String(error && error.message || error).slice(0, 120) + "): charts and tables still move and hold the numbers.";
      return;
    }
    say.hidden = true;
    scene.controls.addEventListener("change", ask);
    new ResizeObserver(() => { scene.fit(); ask(); }).observe($("view"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { scene.paint(); ask(); });
    scene.fit();
    scene.show(0, true);
    scene.look("oblique", false);
    clock.follow(time => scene.show(time, $("follow").checked));
    clock.paint(playing => { if (isSeen) scene.draw(playing); });
    realgap.draw = () => scene.draw(false);
    realgap.quality = scene.quality;
  };
  // What is out of sight costs nothing.
  new IntersectionObserver(entries => {
    isSeen = entries.some(entry => entry.isIntersecting);
    if (isSeen && !scene) build();
    ask();
  }, { rootMargin: "200px" }).observe($("view"));

  const ghosts = () => scene.showGhosts($("ghosts").checked, $("traces").checked);
  const change = (id, act) => $(id).addEventListener("change", () => { if (scene) { act($(id).checked); ask(); } });
  change("follow", () => clock.set(realgap.state().time));
  change("traces", on => { scene.showTraces(on); ghosts(); });
  change("names", on => scene.showNames(on));
  change("ghosts", ghosts);
  for (const id of ["oblique", "top", "side"])
    $(id).addEventListener("click", () => { if (scene) { scene.look(id, !$("follow").checked); ask(); } });
  for (const [key, id] of [["f", "follow"], ["n", "names"], ["g", "ghosts"]]) clock.keys[key] = () => clock.tick(id);
  return { clock, tracks };
};
