"use strict";
// The pointer over one chart reads all of them at the same time.
(() => {
  const run = JSON.parse(document.getElementById("run-data").textContent);
  const charts = run.charts.map((data) => {
    const figure = document.getElementById(data.id);
    return {
      data,
      svg: figure.querySelector("svg"),
      cursor: figure.querySelector(".cursor"),
      readout: figure.querySelector(".readout"),
    };
  });

  const nearest = (times, t) => {
    let low = 0;
    let high = times.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] < t) low = middle;
      else high = middle;
    }
    return t - times[low] < times[high] - t ? low : high;
  };

  const words = (data, i) => {
    const unit = data.unit ? ` ${data.unit}` : "";
    const values = data.series
      .filter((s) => s.values[i] !== null)
      .map((s) => `${s.name} ${s.values[i].toFixed(data.decimals).replace("-", "\u2212")}${unit}`);
    return [`${data.time[i].toFixed(1)} s`, ...values].join("  ·  ");
  };

  const show = (t) => {
    for (const { data, cursor, readout } of charts) {
      const i = nearest(data.time, t);
      const first = data.time[0];
      const last = data.time[data.time.length - 1];
      const x = run.plot.left + ((data.time[i] - first) / Math.max(last - first, 1e-6)) * (run.plot.right - run.plot.left);
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
      cursor.classList.add("shown");
      readout.textContent = words(data, i);
    }
  };

  const hide = () => {
    for (const { cursor, readout } of charts) {
      cursor.classList.remove("shown");
      readout.textContent = "";
    }
  };

  for (const { data, svg } of charts) {
    svg.addEventListener("pointermove", (event) => {
      const box = svg.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * run.plot.width;
      const part = (x - run.plot.left) / (run.plot.right - run.plot.left);
      const first = data.time[0];
      show(first + Math.min(Math.max(part, 0), 1) * (data.time[data.time.length - 1] - first));
    });
    svg.addEventListener("pointerleave", hide);
  }
})();
