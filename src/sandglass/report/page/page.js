"use strict";
// Fills the page from the JSON document in #data. Text from it enters the page as text only (textContent), never as HTML.
(() => {
  const page = JSON.parse(document.getElementById("data").textContent);

  const dark = matchMedia("screen and (prefers-color-scheme: dark)");
  let printing = false;
  const palette = () => palettes[dark.matches && !printing ? "dark" : "light"];
  const paperWidth = 660;  // CSS pixels: fits A4 and Letter

  // ---- building blocks

  function tableOf({ columns, rows }, caption) {
    const head = element("tr", {}, ...columns.map((text) => element("th", { scope: "col", textContent: text })));
    const body = rows.map((row) => element("tr", {}, ...row.map((text, i) =>
      element(i ? "td" : "th", i ? { textContent: text } : { scope: "row", textContent: text }))));
    return element("table", { className: "data", "aria-label": caption },
      element("thead", {}, head), element("tbody", {}, ...body));
  }

  /** Buttons of which one is pressed. choices: [label, spoken label, value]. */
  function choice(label, choices, current, choose) {
    const group = element("span", { className: "choice", role: "group", "aria-label": label });
    for (const [text, spoken, value] of choices) {
      const button = element("button", { type: "button", textContent: text, title: spoken, "aria-pressed": String(value === current) });
      button.addEventListener("click", () => {
        for (const other of group.children) other.setAttribute("aria-pressed", String(other === button));
        choose(value);
      });
      group.append(button);
    }
    return group;
  }

  function button(text, spoken, action) {
    const node = element("button", { type: "button", textContent: text, title: spoken });
    node.addEventListener("click", action);
    return node;
  }

  function download(name, blob) {
    const url = URL.createObjectURL(blob);
    element("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  }

  const csvCell = (value) => {
    const text = value === null || value === undefined ? "" : String(value);
    return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  const csvBlob = (rows) => new Blob([rows.map((row) => row.map(csvCell).join(",") + "\n").join("")], { type: "text/csv" });

  function csvOf(figure) {
    const name = ({ label, unit }) => (unit ? `${label} [${unit}]` : label);
    const second = figure.alternative_x.label;
    const rows = [["curve", name(figure.x), ...(second ? [name(figure.alternative_x)] : []), name(figure.y), "standard error"]];
    for (const curve of figure.curves)
      curve.x.forEach((x, i) => rows.push([curve.name, x, ...(second ? [curve.alternative_x[i]] : []), curve.y[i], curve.error[i]]));
    return csvBlob(rows);
  }

  // ---- one figure: heading, switches, plot, caption

  function addFigure(figure, parent) {
    const heading = element("h3", { id: `heading-${figure.id}`, textContent: figure.title });
    const node = element("figure", { id: `figure-${figure.id}`, "aria-labelledby": heading.id }, heading);
    parent.append(node);
    if (figure.missing) node.append(element("p", { className: "missing", textContent: figure.missing }));
    const points = figure.curves.reduce((sum, curve) => sum + curve.y.length, 0);
    node.dataset.curves = figure.curves.length;
    node.dataset.points = points;
    if (!points) {
      if (!figure.missing) node.append(element("p", { className: "missing", textContent: "There are no data for this figure." }));
      return () => {};
    }
    const view = { alternative: false, xLog: figure.x.log, yLog: figure.y.log, hidden: new Set() };
    const holder = element("div", { className: "plot", role: "img",
      "aria-label": `${figure.title}: ${figure.y.label} against ${figure.x.label}; curves: ${figure.curves.map((c) => c.name).join("; ")}. ${figure.caption}` });
    let plot = null;
    const draw = () => {
      if (plot) plot.destroy();  // first, or it would hold its old width open
      const width = printing ? paperWidth : Math.max(240, holder.clientWidth);
      plot = makePlot(figure, view, { width, height: Math.round(Math.min(520, Math.max(280, width * 0.62))) },
        palette(), holder);
      node.dataset.drawn = plot.data.slice(1).reduce((sum, ys) => sum + ys.filter(isNumber).length, 0);
      node.dataset.view = `${view.alternative ? "alternative" : "first"} x, ${view.xLog ? "log" : "linear"} x, ${view.yLog ? "log" : "linear"} y`;
      for (const name of holder.querySelectorAll(".u-series th")) {
        name.tabIndex = 0;
        name.addEventListener("keydown", (event) => event.key === "Enter" && name.click());
      }
    };
    const set = (key) => (value) => { view[key] = value; draw(); };
    const scale = [["log", "logarithmic", true], ["linear", "linear", false]];
    const controls = element("div", { className: "controls" });
    if (figure.alternative_x.label && figure.curves.every((curve) => curve.alternative_x.length === curve.x.length)) {
      const tail = (label) => label.match(/\b[a-z]\b/)?.[0] ?? label;
      controls.append(choice("Horizontal axis shows", [[tail(figure.x.label), figure.x.label, false],
        [tail(figure.alternative_x.label), figure.alternative_x.label, true]], false, set("alternative")));
    }
    controls.append(choice("Horizontal axis", scale.map(([text, spoken, value]) => [`x ${text}`, `${spoken} horizontal axis`, value]), view.xLog, set("xLog")));
    if (figure.y.log) controls.append(choice("Vertical axis", scale.map(([text, spoken, value]) => [`y ${text}`, `${spoken} vertical axis`, value]), view.yLog, set("yLog")));
    controls.append(
      button("CSV", "Download the data of this figure as CSV", () => download(`${figure.id}.csv`, csvOf(figure))),
      button("PNG", "Download this figure as PNG", () => pngOf(figure, view, page.title, (blob) => download(`${figure.id}.png`, blob))));
    node.append(controls, holder, element("figcaption", { textContent: figure.caption }));
    return draw;
  }

  // ---- the packing

  function addPacking(packing, parent) {
    if (!packing) {
      parent.append(element("p", { className: "missing", textContent: page.packing_missing }));
      return () => {};
    }
    const { box_length: box, left, bottom, side } = packing;
    const whole = side >= box, count = packing.x.length;
    const names = ["small", "big"];
    const canvas = element("canvas", { role: "img",
      "aria-label": `The packing at the end of the run: ${count} disks, small ones and big ones in different colours.` });
    const reading = element("span", { "aria-live": "polite" });
    const key = element("div", { className: "key" });
    const node = element("figure", { id: "figure-packing" }, canvas, key);

    const paint = (target, pixels, colours) => {
      target.width = target.height = pixels;
      const pen = target.getContext("2d"), scale = pixels / side;
      pen.fillStyle = colours.ground;
      pen.fillRect(0, 0, pixels, pixels);
      let drawn = 0;
      for (const species of [0, 1]) {
        const radius = packing.radius[species];
        pen.fillStyle = colours[names[species]];
        pen.beginPath();
        for (let i = 0; i < count; i++) {
          if (packing.species[i] !== species) continue;
          drawn++;
          // A disk across the border of the periodic box is seen on both sides.
          for (const dx of whole ? [-box, 0, box] : [0]) for (const dy of whole ? [-box, 0, box] : [0]) {
            const x = packing.x[i] + dx - left, y = packing.y[i] + dy - bottom;
            if (x < -radius || x > side + radius || y < -radius || y > side + radius) continue;
            pen.moveTo((x + radius) * scale, pixels - y * scale);
            pen.arc(x * scale, pixels - y * scale, radius * scale, 0, 2 * Math.PI);
          }
        }
        pen.fill();
      }
      pen.strokeStyle = colours.ink;
      pen.lineWidth = Math.max(1, pixels / 700);
      pen.strokeRect(0, 0, pixels, pixels);
      return drawn;
    };
    const draw = () => {
      const colours = palette();
      node.dataset.drawn = paint(canvas, Math.round(Math.min(760, canvas.clientWidth || 760) * Math.max(2, devicePixelRatio)), colours);
      key.replaceChildren(...names.map((name, species) => element("span", {},
        element("span", { className: "dot", style: `background:${colours[name]}` }),
        `${name} (radius ${shown(packing.radius[species])} Rₛ)`)), reading);
    };
    canvas.addEventListener("pointermove", (event) => {
      const x = left + (event.offsetX / canvas.clientWidth) * side, y = bottom + (1 - event.offsetY / canvas.clientHeight) * side;
      const near = (d) => (whole ? d - box * Math.round(d / box) : d);
      const at = packing.x.findIndex((px, i) => Math.hypot(near(px - x), near(packing.y[i] - y)) <= packing.radius[packing.species[i]]);
      reading.textContent = at < 0 ? "" : `disk ${packing.id[at]}, ${names[packing.species[at]]}, at (${shown(packing.x[at])}, ${shown(packing.y[at])}) Rₛ`;
    });
    const csv = () => csvBlob([["id", "species", "radius [R_s]", "x [R_s]", "y [R_s]"], ...packing.x.map((x, i) =>
      [packing.id[i], names[packing.species[i]], packing.radius[packing.species[i]], x, packing.y[i]])]);
    const png = () => {
      const copy = element("canvas");
      paint(copy, 2000, palettes.light);
      copy.toBlob((blob) => download("packing.png", blob));
    };
    node.prepend(element("div", { className: "controls" },
      button("CSV", "Download the positions as CSV", () => download("packing.csv", csv())),
      button("PNG", "Download the picture as PNG", png)));
    node.append(element("figcaption", { textContent: whole
      ? `All ${count} disks at the end of the run in the periodic box of side ${shown(box, 5)} Rₛ.`
      : `The middle of the box at the end of the run: a square of side ${shown(side, 5)} Rₛ with ${count} disks. The whole box, of side ${shown(box, 5)} Rₛ, holds too many disks to be seen; all of them are in checkpoint.h5.` }));
    parent.append(node);
    node.dataset.points = count;
    return draw;
  }

  // ---- the page

  const put = (id, ...nodes) => document.getElementById(id).append(...nodes);
  document.title = `${page.title} – sandglass`;
  put("title", page.title);
  put("subtitle", page.subtitle);
  put("summary", ...page.summary.map((text) => element("p", { textContent: text })));
  put("highlights", ...page.highlights.map(([name, value]) =>
    element("div", {}, element("dt", { textContent: name }), element("dd", { textContent: value }))));
  put("results", tableOf(page.results, "Results"));
  put("parameters", tableOf(page.parameters, "Parameters"));
  put("provenance", tableOf({ columns: ["", ""], rows: page.provenance }, "Provenance"));
  put("decisions", ...page.warnings.map((text) => element("p", { className: "warning", textContent: text })),
    element("ul", {}, ...page.decisions.map((text) => element("li", { textContent: text }))));
  put("commands", page.commands.join("\n"));
  put("config", page.config);

  const figures = document.getElementById("figures");
  const redraws = page.figures.map((figure) => addFigure(figure, figures));
  redraws.push(addPacking(page.packing, document.getElementById("packing")));
  const redraw = () => redraws.forEach((draw) => draw());
  redraw();  // only now: how wide a figure is depends on what stands beside it

  let width = innerWidth, pending = 0;
  addEventListener("resize", () => {
    if (innerWidth === width) return;  // a phone's bars come and go with scrolling
    width = innerWidth;
    clearTimeout(pending);
    pending = setTimeout(redraw, 150);
  });
  dark.addEventListener("change", redraw);
  addEventListener("beforeprint", () => { printing = true; redraw(); });
  addEventListener("afterprint", () => { printing = false; redraw(); });
  document.documentElement.dataset.ready = "true";
})();
