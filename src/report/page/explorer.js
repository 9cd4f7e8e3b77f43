// Recordings one at a time: their signals, and the robot on its path at the time of the cursor.
"use strict";
for (const box of document.querySelectorAll(".explorer")) {
  const tracks = JSON.parse(box.querySelector("script").textContent);
  const [choice, errors, replay, map, play, scrub, now] = ["select", ".errors", ".replay", ".replay canvas",
    ".replay button", "input[type=range]", ".replay output"].map((part) => box.querySelector(part));
  let [t, x, y, heading] = tracks[0].path.map(column);
  let running = null;
  box.hidden = false;
  const state = live.build(box.querySelector("figure"), tracks[0].figure);

  // a cursor on the figure moves the robot; where it leaves, the robot stays
  state.follow = (time) => {
    if (time !== null && t.length) scrub.value = nearest(t, time);
    show();
  };

  function nearest(values, at) {
    const after = values.findIndex((v) => v >= at);
    if (after < 0) return values.length - 1;
    return after > 0 && at - values[after - 1] < values[after] - at ? after - 1 : after;
  }

  function choose(number) {
    stop();
    [t, x, y, heading] = tracks[number].path.map(column);
    live.load(state, tracks[number].figure);
    errors.textContent = tracks[number].note;
    replay.hidden = t.length < 2;
    scrub.max = t.length - 1;
    scrub.value = 0;
    move();
  }

  function move() {
    if (t.length) live.point(state, t[scrub.value]);
    show();
  }

  function stop() {
    cancelAnimationFrame(running);
    running = null;
    play.textContent = "Play";
  }

  // as fast as it was driven
  function start() {
    if (Number(scrub.value) >= t.length - 1) scrub.value = 0;
    const [from, began] = [t[scrub.value], performance.now()];
    play.textContent = "Pause";
    const step = (clock) => {
      scrub.value = nearest(t, from + (clock - began) / 1000);
      move();
      if (Number(scrub.value) < t.length - 1) running = requestAnimationFrame(step); else stop();
    };
    running = requestAnimationFrame(step);
  }

  function show() {
    if (t.length < 2 || !map.clientWidth) return;
    const k = Number(scrub.value);
    now.textContent = `${readOff(t[k], [t[0], t[t.length - 1]])} s`;
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [map.clientWidth, map.clientHeight];
    [map.width, map.height] = [width * ratio, height * ratio];
    const context = map.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const ends = (values) => [Math.min(...values), Math.max(...values)];
    const [[left, right], [low, high]] = [ends(x), ends(y)];
    const room = 24;
    const scale = Math.min((width - 2 * room) / (right - left || 1), (height - 2 * room) / (high - low || 1));
    const px = (v) => width / 2 + (v - (left + right) / 2) * scale;
    const py = (v) => height / 2 - (v - (low + high) / 2) * scale;
    const line = (until, name, thick) => {
      context.strokeStyle = color(name);
      context.lineWidth = thick;
      context.beginPath();
      for (let i = 0; i <= until; i++) context.lineTo(px(x[i]), py(y[i]));
      context.stroke();
    };
    line(t.length - 1, "--axis", 1);
    line(k, "--link", 2);
    context.save();
    context.translate(px(x[k]), py(y[k]));
    context.rotate(-heading[k]);
    context.fillStyle = color("--ink");
    context.beginPath();
    [[11, 0], [-7, 7], [-4, 0], [-7, -7]].forEach(([a, b]) => context.lineTo(a, b));
    context.fill();
    context.restore();
    ruler(context, scale, height, color);
  }

  // a round length to measure the path by
  function ruler(context, scale, height, color) {
    const rough = 90 / scale;
    const power = Math.pow(10, Math.floor(Math.log10(rough)));
    const length = [5, 2, 1].find((n) => n * power <= rough) * power;
    context.strokeStyle = context.fillStyle = color("--muted");
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(8, height - 8);
    context.lineTo(8 + length * scale, height - 8);
    context.stroke();
    context.font = "12px Inter, system-ui, sans-serif";
    context.fillText(`${format(length, 1)} m`, 8, height - 13);
  }

  choice.addEventListener("change", () => choose(choice.selectedIndex));
  scrub.addEventListener("input", () => { stop(); move(); });
  play.addEventListener("click", () => (running ? stop() : start()));
  new ResizeObserver(show).observe(map);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
  choose(0);
}
