"use strict";
// Draws one figure of the page's data with uPlot, on the screen or as a picture to keep.

// The palette of Okabe and Ito, told apart by readers of every colour vision; black turns light on dark ground.
const palettes = {
  light: { all: "#000000", small: "#0072B2", big: "#D55E00", fit: "#009E73", guide: "#7A838C",
           ink: "#1a1e23", grid: "#e4e8ec", ground: "#ffffff" },
  dark: { all: "#e6e9ec", small: "#56B4E9", big: "#E69F00", fit: "#009E73", guide: "#8b949d",
          ink: "#c9d0d6", grid: "#2c3237", ground: "#1b1f23" },
};
const dashes = { solid: [], dashed: [7, 5], dotted: [2, 4], points: [] };

// The curves of a family: distinct colours while they are few, else viridis from its dark end.
const few = { light: ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#000000"],
              dark: ["#56B4E9", "#E69F00", "#009E73", "#CC79A7", "#F0E442", "#e6e9ec"] };
const viridis = [[68, 1, 84], [71, 39, 117], [62, 73, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137],
                 [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37]];

function sequential(part) {
  const at = Math.min(1, Math.max(0, part)) * (viridis.length - 1), i = Math.min(viridis.length - 2, Math.floor(at));
  return viridis[i].map((low, channel) => Math.round(low + (at - i) * (viridis[i + 1][channel] - low)));
}

function colourOf(figure, curve, colours) {
  if (curve.role !== "family") return colours[curve.role];
  const levels = [...new Set(figure.curves.filter((c) => c.role === "family").map((c) => c.level))].sort((a, b) => a - b);
  const rank = levels.indexOf(curve.level), dark = colours === palettes.dark;
  if (levels.length <= few.light.length) return few[dark ? "dark" : "light"][rank];
  const part = rank / (levels.length - 1);
  return `rgb(${sequential(dark ? 0.25 + 0.75 * part : 0.88 * part)})`;
}
const font = (size) => `${size}px system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif`;

function element(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-")) node.setAttribute(name, value);
    else node[name] = value;
  }
  node.append(...children);
  return node;
}

// ---- numbers

const superscript = (n) => String(n).replace(/[-0-9]/g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]));
const isNumber = (value) => typeof value === "number" && isFinite(value);

function shown(value, digits = 4) {
  if (!isNumber(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) {
    const [mantissa, exponent] = value.toExponential(digits - 2).split("e");
    return `${mantissa.replace("-", "−")}·10${superscript(Number(exponent))}`;
  }
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

function tickLabel(value) {
  const exponent = Math.round(Math.log10(value));
  if (value >= 0.01 && value <= 1000) return String(Number(value.toPrecision(3)));
  return value === Number(`1e${exponent}`) ? `10${superscript(exponent)}` : shown(value, 2);
}

// ---- one plot

/** Ticks of a log axis: 1 ... 9 times each power of ten. */
function logTicks(min, max) {
  const ticks = [];
  for (let e = Math.floor(Math.log10(min)); e <= Math.ceil(Math.log10(max)); e++)
    for (let m = 1; m < 10; m++) {
      const tick = Number(`${m}e${e}`);
      if (tick >= min * 0.999999 && tick <= max * 1.000001) ticks.push(tick);
    }
  return ticks;
}

const leadingDigit = (tick) => Number(tick.toExponential(0)[0]);

/** Which ticks get a label (the others are null): all powers of ten that have room, more when there are few decades. */
function labelled(ticks, decadesWithRoom) {
  const powers = ticks.filter((t) => leadingDigit(t) === 1);
  const step = Math.max(1, Math.ceil(powers.length / decadesWithRoom));
  const digits = powers.length <= 1 ? [1, 2, 3, 5, 7] : powers.length <= 2 ? [1, 2, 5] : [1];
  return ticks.map((t) => {
    if (!digits.includes(leadingDigit(t))) return null;
    return leadingDigit(t) > 1 || Math.round(Math.log10(t)) % step === 0 ? t : null;
  });
}

function padded(min, max, log) {
  if (min === null || max === null) return log ? [0.1, 10] : [0, 1];
  if (log) return min === max ? [min / 2, max * 2] : [min / 1.25, max * 1.25];
  const pad = (max - min || Math.abs(max) || 1) * 0.06;
  return [min - pad, max + pad];
}

const axisTitle = ({ label, unit }) => (unit ? `${label}  (${unit})` : label);

/** The points of each curve that can be drawn with the chosen axes, as columns on one common x. */
function columns(figure, view) {
  const pick = (curve, values) => {
    const xs = view.alternative ? curve.alternative_x : curve.x;
    const keep = xs.map((x, i) => i).filter((i) => isNumber(xs[i]) && isNumber(curve.y[i])
      && (!view.xLog || xs[i] > 0) && (!view.yLog || curve.y[i] > 0));
    return [keep.map((i) => xs[i]), keep.map((i) => (isNumber(values[i]) ? values[i] : undefined))];
  };
  return {
    values: uPlot.join(figure.curves.map((curve) => pick(curve, curve.y))),
    errors: uPlot.join(figure.curves.map((curve) => pick(curve, curve.error))),
  };
}

function drawErrorBars(plot, series, errors, colours) {
  if (series === 0 || !plot.series[series].show) return;
  const { ctx } = plot, cap = 2.5 * uPlot.pxRatio;
  ctx.save();
  ctx.beginPath();
  ctx.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
  ctx.clip();
  ctx.beginPath();
  ctx.strokeStyle = colours;
  ctx.lineWidth = uPlot.pxRatio;
  plot.data[series].forEach((value, i) => {
    const error = errors[series][i];
    if (!isNumber(value) || !isNumber(error) || error <= 0) return;
    const x = plot.valToPos(plot.data[0][i], "x", true);
    const top = plot.valToPos(value + error, "y", true);
    const low = value - error;
    const bottom = plot.scales.y.distr === 3 && low <= 0 ? plot.bbox.top + plot.bbox.height : plot.valToPos(low, "y", true);
    ctx.moveTo(x, top);
    ctx.lineTo(x, bottom);
    ctx.moveTo(x - cap, top);
    ctx.lineTo(x + cap, top);
    ctx.moveTo(x - cap, bottom);
    ctx.lineTo(x + cap, bottom);
  });
  ctx.stroke();
  ctx.restore();
}

function makePlot(figure, view, size, colours, holder) {
  const { values, errors } = columns(figure, view);
  const xAxis = view.alternative ? figure.alternative_x : figure.x;
  const common = { stroke: colours.ink, font: font(13), labelFont: font(14), labelSize: 24,
                   grid: { stroke: colours.grid, width: 1 }, ticks: { stroke: colours.grid, width: 1, size: 5 } };
  const logAxis = (room) => ({
    splits: (plot, axis, min, max) => logTicks(min, max),
    filter: (plot, ticks) => labelled(ticks, room),
    values: (plot, ticks) => ticks.map((t) => (t === null ? "" : tickLabel(t))),
    grid: { ...common.grid, filter: (plot, ticks) => ticks.map((t) => (leadingDigit(t) === 1 ? t : null)) },
  });
  const linearAxis = { values: (plot, ticks) => ticks.map((t) => shown(t)) };
  const options = {
    width: size.width, height: size.height, padding: [10, 14, 0, 0],
    scales: {
      x: { time: false, distr: view.xLog ? 3 : 1, log: 10,
           range: (plot, min, max) => (min === null ? padded(min, max, view.xLog) : min === max ? padded(min, max, view.xLog) : [min, max]) },
      y: { distr: view.yLog ? 3 : 1, log: 10,
           range: (plot, min, max) => (figure.y_range && !view.yLog ? figure.y_range : padded(min, max, view.yLog)) },
    },
    axes: [
      { ...common, label: axisTitle(xAxis), size: 34, ...(view.xLog ? logAxis(Math.max(2, size.width / 55)) : linearAxis) },
      { ...common, label: axisTitle(figure.y), size: 66, ...(view.yLog ? logAxis(Math.max(2, size.height / 30)) : linearAxis) },
    ],
    cursor: { points: { size: 7 }, drag: { x: true, y: false } },
    legend: { markers: { width: 3, dash: (plot, i) => ({ solid: "solid", dashed: "dashed", dotted: "dotted", points: "dotted" })[figure.curves[i - 1].line] } },
    series: [
      { label: xAxis.label, value: (plot, x) => (isNumber(x) ? shown(x) : "") },
      ...figure.curves.map((curve, i) => ({
        label: curve.name, stroke: colourOf(figure, curve, colours), dash: dashes[curve.line],
        width: curve.role === "fit" ? 4 : 1.75, show: !view.hidden.has(i), spanGaps: true,
        ...(curve.line === "points" ? { paths: () => null } : {}),
        points: { show: curve.line === "points" || (curve.line === "solid" && curve.role !== "fit" && curve.x.length <= 150),
                  size: curve.line === "points" ? 8 : 4.5, fill: curve.line === "points" ? "transparent" : colourOf(figure, curve, colours) },
        value: (plot, y, series, at) => {
          if (at === null) return "";
          const error = errors[series][at];
          return isNumber(y) ? shown(y) + (isNumber(error) ? ` ± ${shown(error, 2)}` : "") : "–";
        },
      })),
    ],
    hooks: {
      drawSeries: [(plot, series) => drawErrorBars(plot, series, errors, series ? colourOf(figure, figure.curves[series - 1], colours) : "")],
      setSeries: [(plot, series, change) => {
        if (series === null || change.show === undefined) return;
        if (change.show) view.hidden.delete(series - 1);
        else view.hidden.add(series - 1);
      }],
    },
  };
  return new uPlot(options, values, holder);
}

/** The plot as a picture to keep: dark on white whatever the screen, with title and legend. */
function pngOf(figure, view, pageTitle, save) {
  const size = { width: 900, height: 560 }, ratio = uPlot.pxRatio, colours = palettes.light;
  const holder = element("div", { style: "position:absolute;left:-9999px;width:900px" });
  document.body.append(holder);
  const plot = makePlot(figure, view, size, colours, holder);
  requestAnimationFrame(() => {  // uPlot draws in a microtask of its own
    const curves = figure.curves.filter((curve, i) => !view.hidden.has(i));
    const lines = Math.ceil(curves.length / 3), head = 44, foot = 26 * lines + 14;
    const canvas = element("canvas", { width: size.width * ratio, height: (size.height + head + foot) * ratio });
    const pen = canvas.getContext("2d");
    pen.fillStyle = colours.ground;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(plot.ctx.canvas, 0, head * ratio);
    pen.scale(ratio, ratio);
    pen.fillStyle = colours.ink;
    pen.font = `600 ${font(17)}`;
    pen.fillText(`${figure.title} – ${pageTitle}`, 20, 29, size.width - 40);
    pen.font = font(13);
    curves.forEach((curve, i) => {
      const x = 70 + (i % 3) * 275, y = head + size.height + 20 + Math.floor(i / 3) * 26;
      pen.strokeStyle = colourOf(figure, curve, colours);
      pen.lineWidth = curve.role === "fit" ? 4 : 2;
      pen.setLineDash(dashes[curve.line]);
      pen.beginPath();
      pen.moveTo(x, y - 4);
      pen.lineTo(x + 32, y - 4);
      pen.stroke();
      pen.fillText(curve.name, x + 40, y, 225);
    });
    plot.destroy();
    holder.remove();
    canvas.toBlob((blob) => save(blob));
  });
}
