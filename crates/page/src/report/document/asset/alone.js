// A replay that is a page of its own.
"use strict";
(() => {
  const { clock, tracks } = realgap.replay((end, times) => realgap.clock(end, { times, everywhere: true, playing: true }));
  document.getElementById("hint").hidden = false;
  for (const svg of document.querySelectorAll("[data-chart]")) realgap.live(clock, svg, tracks);
  clock.begin();
  realgap.ready = true;
})();
