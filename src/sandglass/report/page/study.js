"use strict";
// Fills the page of a study from the JSON document in #data. Text from it enters the page as text only, never as HTML.
(() => {
  /** A link to a run's report; `href` is a relative path, percent-encoded. */
  const link = (text, href) => element("a", { textContent: text, href: `./${href}` });

  // ---- a numbered figure with its parts, the paper's statement and the verdict

  function addNumberedFigure(figure, parent) {
    const group = element("div", { className: "group", id: `group-${figure.id}` });
    parent.append(group);
    const draws = [addFigure(figure, group, page.title)];
    const parts = [...figure.panels, ...figure.insets];
    if (parts.length) {
      const row = element("div", { className: "grid" });
      group.append(row);
      draws.push(...parts.map((part) => addFigure(part, row, page.title, "h4")));
    }
    const said = figure.statement ? [element("p", {}, element("strong", { textContent: "The paper: " }), figure.statement)] : [];
    if (said.length || figure.checks.length) group.append(element("div", { className: "paper" }, ...said,
      element("ul", { className: "checks" }, ...figure.checks.map((check) => element("li", {},
        element("span", { className: `outcome ${check.outcome.replaceAll(" ", "-")}`, textContent: check.outcome }),
        ` ${check.claim}. ${check.finding}`)))));
    return () => draws.forEach((draw) => draw());
  }

  // ---- the plane of packing fraction and restitution

  function addPlane(parent) {
    const make = (tag, attributes = {}, ...children) => {
      const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
      for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
      node.append(...children);
      return node;
    };
    const holder = element("div", { className: "plane" }), key = element("div", { className: "key" });
    const width = 900, height = 420, left = 70, bottom = 54, top = 16, right = 24;
    const range = (values) => {
      const low = Math.min(...values), high = Math.max(...values), pad = (high - low) * 0.05 || 0.02;
      return [low - pad, high + pad];
    };
    const [x0, x1] = range(page.points.map((p) => p.packing_fraction)), [y0, y1] = range(page.points.map((p) => p.restitution));
    const xAt = (x) => left + ((x - x0) / (x1 - x0)) * (width - left - right);
    const yAt = (y) => height - bottom - ((y - y0) / (y1 - y0)) * (height - top - bottom);
    const ticks = (values) => [...new Set(values.map((v) => Number(v.toFixed(4))))].sort((a, b) => a - b);
    const spread = (marks, at, room) => marks.filter((() => { let last = -1e9; return (v) => Math.abs(at(v) - last) >= room && ((last = at(v)), true); })());

    const draw = (quantity) => {
      const values = page.points.map((p) => p.numbers[quantity.key]), known = values.filter((v) => isNumber(v) && (!quantity.log || v > 0));
      const low = Math.min(...known), high = Math.max(...known);
      const part = (v) => (high > low ? (quantity.log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low)) : 0.5);
      const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, role: "group", "aria-label": "State points in the plane of packing fraction and restitution" });
      svg.append(make("path", { class: "frame", d: `M${left} ${top}V${height - bottom}H${width - right}` }));
      for (const x of spread(ticks(page.points.map((p) => p.packing_fraction)), xAt, 38))
        svg.append(make("text", { x: xAt(x), y: height - bottom + 20, "text-anchor": "middle" }, shown(x)));
      for (const y of spread(ticks(page.points.map((p) => p.restitution)), yAt, 18))
        svg.append(make("text", { x: left - 10, y: yAt(y) + 5, "text-anchor": "end" }, shown(y)));
      svg.append(make("text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle" }, "packing fraction η"),
        make("text", { transform: `translate(18 ${(top + height - bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, "restitution ε"));
      const stacked = new Map();
      page.points.forEach((point, i) => {
        const place = `${point.packing_fraction} ${point.restitution}`, twins = stacked.get(place) ?? 0;
        stacked.set(place, twins + 1);
        const has = isNumber(values[i]) && (!quantity.log || values[i] > 0);
        const disk = make("circle", { cx: xAt(point.packing_fraction), cy: yAt(point.restitution) - 9 * twins, r: twins ? 4 : 7,
          class: has ? "" : "unknown", fill: has ? `rgb(${sequential(part(values[i]))})` : "none" },
          make("title", {}, `${point.name}: ${quantity.label} ${has ? shown(values[i]) : "not known"}; ${point.replicas.length} run${point.replicas.length > 1 ? "s" : ""}`));
        svg.append(make("a", { href: `./${point.replicas[0].href}`, "aria-label": `Report of ${point.name}` }, disk));
      });
      holder.replaceChildren(svg);
      key.textContent = known.length ? `${quantity.label}: from ${shown(low)} (dark) to ${shown(high)} (bright)${quantity.log ? ", logarithmic" : ""}; hollow: not known.` : `${quantity.label} is not known at any point.`;
    };
    parent.append(element("div", { className: "controls" },
      choice("Colour shows", page.quantities.map((q) => [q.label, `Colour shows ${q.label}`, q]), page.quantities[0], draw)), holder, key);
    draw(page.quantities[0]);
  }

  // ---- tables

  function addPoints(parent) {
    const names = ["State point", ...page.quantities.map((q) => q.label), "Runs"];
    const rows = page.points.map((point) => element("tr", {},
      element("th", { scope: "row", textContent: point.name }),
      ...page.quantities.map((q) => element("td", { textContent: point.texts[q.key] })),
      element("td", {}, ...point.replicas.flatMap((r, i) => [i ? ", " : "", link(`seed ${r.seed}${r.stationary ? "" : " (not stationary)"}`, r.href)]))));
    parent.append(element("table", { className: "data wide", "aria-label": "State points" },
      element("thead", {}, element("tr", {}, ...names.map((text) => element("th", { scope: "col", textContent: text })))),
      element("tbody", {}, ...rows)));
  }

  // ---- the page

  put("verdicts", element("table", { className: "data", "aria-label": "Verdicts" },
    element("tbody", {}, ...page.figures.map((figure) => element("tr", {},
      element("th", { scope: "row" }, element("a", { href: `#group-${figure.id}`, textContent: figure.title })),
      element("td", {}, element("span", { className: figure.verdict && `outcome ${figure.verdict.replaceAll(" ", "-")}`, textContent: figure.verdict })))))));
  addPlane(document.getElementById("plane"));
  addPoints(document.getElementById("points"));
  if (page.absent.length) put("absent", tableOf({ columns: ["Run", "Why"], rows: page.absent }, "Runs without data"));
  else put("absent", element("p", { textContent: "None: every run that was found or expected is in this report." }));

  const [overview, paper, beyond] = ["overview", "paper", "beyond"].map((id) => document.getElementById(id));
  const redraws = [...page.overview.map((figure) => addFigure(figure, overview, page.title)),
    ...page.figures.map((figure) => addNumberedFigure(figure, figure.statement ? paper : beyond))];
  const redraw = () => redraws.forEach((draw) => draw());
  redraw();
  redrawOnChange(redraw);
  document.documentElement.dataset.ready = "true";
})();
