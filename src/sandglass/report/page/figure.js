"use strict";
// What all pages share: tables, switches, downloads, figures. Text of the data enters a page as text only.

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

/** Adds a figure with its plot or map to `parent`; returns what draws it anew. */
function addFigure(figure, parent, pageTitle, level = "h3") {
  const heading = element(level, { id: `heading-${figure.id}`, textContent: figure.title });
  const node = element("figure", { id: `figure-${figure.id}`, "aria-labelledby": heading.id }, heading);
  parent.append(node);
  if (figure.missing) node.append(element("p", { className: "missing", textContent: figure.missing }));
  if (figure.map) return addMap(figure, node, pageTitle);
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
    button("PNG", "Download this figure as PNG", () => pngOf(figure, view, pageTitle, (blob) => download(`${figure.id}.png`, blob))));
  node.append(controls, holder, element("figcaption", { textContent: figure.caption }));
  return draw;
}

// ---- a map: colours on a grid

function addMap(figure, node, pageTitle) {
  const { x0, dx, y0, dy, columns, rows, values, scale } = figure.map;
  const known = values.filter((v) => isNumber(v) && (!scale.log || v > 0));
  const low = Math.min(...known), high = Math.max(...known);
  const part = (v) => (scale.log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low)) || 0;
  node.dataset.curves = 0;
  node.dataset.points = known.length;
  const picture = element("canvas", { width: columns, height: rows });
  const canvas = element("canvas", { className: "map", role: "img",
    "aria-label": `${figure.title}: ${scale.label} against ${figure.x.label} and ${figure.y.label}. ${figure.caption}` });
  const reading = element("span", { "aria-live": "polite" });
  const paint = (target, pixels, colours) => {
    const image = new ImageData(columns, rows);
    let drawn = 0;
    values.forEach((v, i) => {
      if (!isNumber(v) || (scale.log && v <= 0)) return;
      drawn++;
      const at = 4 * ((rows - 1 - Math.floor(i / columns)) * columns + (i % columns));
      image.data.set([...sequential(part(v)), 255], at);
    });
    picture.getContext("2d").putImageData(image, 0, 0);
    target.width = target.height = pixels;
    const pen = target.getContext("2d"), room = pixels * 0.11, side = pixels - 1.6 * room;
    pen.fillStyle = colours.ground;
    pen.fillRect(0, 0, pixels, pixels);
    pen.imageSmoothingEnabled = false;
    pen.drawImage(picture, room, 0.6 * room, side, side);
    pen.fillStyle = pen.strokeStyle = colours.ink;
    pen.font = font(pixels / 45);
    pen.strokeRect(room, 0.6 * room, side, side);
    pen.textAlign = "center";
    for (const [share, x, y] of [0, 0.5, 1].map((t) => [t, x0 + t * (columns - 1) * dx, y0 + t * (rows - 1) * dy])) {
      pen.fillText(shown(x, 3), room + share * side, 0.6 * room + side + pixels / 32);
      pen.save();
      pen.translate(room - pixels / 80, 0.6 * room + (1 - share) * side);
      pen.rotate(-Math.PI / 2);
      pen.fillText(shown(y, 3), 0, 0);
      pen.restore();
    }
    pen.fillText(axisTitle(figure.x), room + side / 2, 0.6 * room + side + pixels / 15);
    pen.save();
    pen.translate(room - pixels / 22, 0.6 * room + side / 2);
    pen.rotate(-Math.PI / 2);
    pen.fillText(axisTitle(figure.y), 0, 0);
    pen.restore();
    return drawn;
  };
  canvas.addEventListener("pointermove", (event) => {
    const share = (offset) => (offset / canvas.clientWidth - 0.11) / (1 - 1.6 * 0.11);
    const column = Math.floor(share(event.offsetX) * columns);
    const row = rows - 1 - Math.floor((share(event.offsetY + 0.044 * canvas.clientWidth)) * rows);
    const inside = column >= 0 && column < columns && row >= 0 && row < rows;
    reading.textContent = inside ? `${figure.x.label} = ${shown(x0 + column * dx)}, ${figure.y.label} = ${shown(y0 + row * dy)}: ${scale.label} = ${shown(values[row * columns + column])}` : "";
  });
  const csv = () => csvBlob([[figure.x.label, figure.y.label, scale.label],
    ...values.map((v, i) => [x0 + (i % columns) * dx, y0 + Math.floor(i / columns) * dy, v]).filter(([, , v]) => isNumber(v) && (!scale.log || v > 0))]);
  const png = () => {
    const copy = element("canvas");
    paint(copy, 1600, palettes.light);
    copy.toBlob((blob) => download(`${figure.id}.png`, blob));
  };
  node.append(element("div", { className: "controls" },
    button("CSV", "Download the data of this figure as CSV", () => download(`${figure.id}.csv`, csv())),
    button("PNG", "Download this figure as PNG", png)), canvas,
  element("div", { className: "key" }, element("span", { textContent: `${scale.label} from ${shown(low)} (dark) to ${shown(high)} (bright)${scale.log ? ", logarithmic" : ""}` }), reading),
  element("figcaption", { textContent: figure.caption }));
  return () => { node.dataset.drawn = paint(canvas, Math.round(Math.min(640, canvas.clientWidth || 640) * Math.max(2, devicePixelRatio)), palette()); };
}

/** Calls `redraw` when the width, the colour scheme or the medium changes. */
function redrawOnChange(redraw) {
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
}
