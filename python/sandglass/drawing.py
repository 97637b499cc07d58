"""Draws figures with matplotlib from the JSON files that `sandglass figures` writes.

    python3 drawing.py --format=svg,pdf,png fig05.json ...

puts fig05.svg, fig05.pdf and fig05.png beside fig05.json. One routine draws all figures: curves with error bars or
bands, panels side by side, insets, maps. Needs matplotlib alone. Exit code 3: there is no matplotlib.
"""
import sys

sys.path[:] = [folder for folder in sys.path if folder]  # not the working folder: its files are not part of this

import json
import math
import os
import re

try:
    import matplotlib
except ImportError:
    sys.exit(3)
matplotlib.use("Agg")
from matplotlib import colors, pyplot, ticker
from matplotlib.cm import ScalarMappable

COLUMN_WIDTH = 3.4  # inches, one column of a journal
HEIGHT = 2.6
STYLE = {
    "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "legend.fontsize": 6.5, "font.family": "sans-serif", "mathtext.fontset": "dejavusans",
    "axes.linewidth": 0.6, "lines.linewidth": 1.0, "lines.markersize": 2.6, "errorbar.capsize": 1.5,
    "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
    "legend.frameon": False, "legend.handlelength": 1.8, "legend.columnspacing": 1.2, "legend.borderaxespad": 0.2,
    "figure.dpi": 200, "savefig.dpi": 300, "svg.hashsalt": "sandglass", "pdf.fonttype": 42,
}
# The palette of Okabe and Ito; the same colours as on the HTML page.
ROLES = {"all": "#000000", "small": "#0072B2", "big": "#D55E00", "fit": "#009E73", "guide": "#7A838C"}
# A family of more curves than there are of these is coloured by viridis and gets a colour bar instead of a legend.
FEW = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#000000"]
LINES = {"solid": "-", "dashed": "--", "dotted": ":", "points": ""}


def text(label):
    """A label for matplotlib: T_s becomes T with a subscript, a dollar sign stays one."""
    label = label.replace("$", r"\$")
    label = re.sub(r"\b([A-Za-zΦχψτω])_([A-Za-z0-9]+)", r"$\\mathrm{\1_{\2}}$", label)
    return re.sub(r"10\^(-?\d+)", r"$10^{\1}$", label)


def axis_text(axis):
    return text(f"{axis['label']}  ({axis['unit']})" if axis["unit"] else axis["label"])


def levels_of(figure):
    return sorted({curve["level"] for curve in figure["curves"] if curve["role"] == "family"})


def colour_map(levels):
    """One colour for each level of a family: viridis without its palest end."""
    viridis = matplotlib.colormaps["viridis"]
    return colors.ListedColormap([viridis(0.93 * i / max(1, len(levels) - 1)) for i in range(len(levels))])


def colour_of(curve, levels):
    if curve["role"] != "family":
        return ROLES[curve["role"]]
    rank = levels.index(curve["level"])
    return FEW[rank] if len(levels) <= len(FEW) else colour_map(levels)(rank)


def numbers(values):
    return [float("nan") if value is None else value for value in values]


def draw_curves(axes, figure, levels, small=False):
    many = max((len(curve["x"]) for curve in figure["curves"] if curve["role"] != "guide"), default=0) > 45
    for curve in figure["curves"]:
        draw_curve(axes, curve, levels, many, small)
    values = [y for curve in figure["curves"] for y in curve["y"] if y is not None and y > 0]
    if figure["y"]["log"] and values:  # the axis ends with the values, not with the errors below them
        axes.set_ylim(min(values) / 1.6, max(values) * 1.6)
    if figure["y_range"] and not figure["y"]["log"]:
        axes.set_ylim(*figure["y_range"])


def draw_curve(axes, curve, levels, many, small):
    """A curve of few points with marks and error bars, one of many as a line with a band."""
    x, y, error = numbers(curve["x"]), numbers(curve["y"]), numbers(curve["error"])
    if not any(math.isfinite(e) for e in error):
        error = []
    colour = colour_of(curve, levels)
    style = {"color": colour, "linestyle": LINES[curve["line"]], "label": text(curve["name"])}
    if curve["role"] == "guide":
        style.update(linewidth=0.8, label="_" + curve["name"])  # needs no word in the legend
    if curve["role"] == "fit":
        style["linewidth"] = 2
    if curve["line"] == "points":
        style.update(marker="o", markersize=4.5, markerfacecolor="none", markeredgewidth=0.8)
    elif not many and curve["line"] == "solid" and curve["role"] not in ("guide", "fit"):
        style["marker"] = "o"
    if small:
        style.update(linewidth=0.8, markersize=1.6)
    if error and not many:
        if axes.get_yscale() == "log":  # an error as large as its value reaches the lower end of the axes
            error = [[min(e, 0.999 * v) for v, e in zip(y, error)], error]
        axes.errorbar(x, y, error, elinewidth=0.6, **style)
        return
    axes.plot(x, y, **style)
    if error and curve["line"] != "points":
        low, high = [v - e for v, e in zip(y, error)], [v + e for v, e in zip(y, error)]
        if axes.get_yscale() == "log":
            low = [max(l, v / 1e3) for l, v in zip(low, y)]
        axes.fill_between(x, low, high, color=colour, alpha=0.25, linewidth=0)


def set_scales(axes, figure):
    for name in ("x", "y"):
        if figure[name]["log"]:
            getattr(axes, f"set_{name}scale")("log", nonpositive="mask")


def set_ticks(axes, figure, small):
    """Few, readable ticks: powers of ten where there are some, else plain numbers."""
    axes.figure.canvas.draw()
    for name, axis in (("x", axes.xaxis), ("y", axes.yaxis)):
        low, high = sorted(getattr(axes, f"get_{name}lim")())
        if figure[name]["log"] and low > 0:
            if high / low > 100:
                axis.set_major_locator(ticker.LogLocator(numticks=4 if small else 7))
                axis.set_minor_formatter(ticker.NullFormatter())
                if high / low < 1e4 and 1e-2 < low and high < 2e4:
                    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
            else:
                axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5), numticks=8))
                axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:.4g}"))
                axis.set_minor_formatter(ticker.NullFormatter())
        elif not figure[name]["log"]:
            axis.set_major_locator(ticker.MaxNLocator(4 if small else 6, steps=(1, 2, 2.5, 5, 10)))
            if name == "y" and hasattr(axes, "top_of_data"):  # above there is room for an inset, not a scale
                axis.set_major_locator(ticker.FixedLocator([t for t in axis.get_majorticklocs() if t <= axes.top_of_data]))


def draw_map(axes, figure):
    grid = figure["map"]
    values = numbers(grid["values"])
    rows = [values[i * grid["columns"]:(i + 1) * grid["columns"]] for i in range(grid["rows"])]
    known = [v for v in values if v == v and (v > 0 or not grid["scale"]["log"])]
    norm = colors.LogNorm(min(known), max(known)) if grid["scale"]["log"] else colors.Normalize(min(known), max(known))
    edges = [(start - step / 2, start + (count - 0.5) * step)
             for start, step, count in ((grid["x0"], grid["dx"], grid["columns"]), (grid["y0"], grid["dy"], grid["rows"]))]
    image = axes.imshow(rows, origin="lower", extent=(*edges[0], *edges[1]), norm=norm, cmap="viridis",
                        interpolation="nearest")
    axes.figure.colorbar(image, ax=axes, label=axis_text(grid["scale"]), pad=0.02, aspect=30)


def legend_names(figure):
    """The names that a legend needs, with the curve that shows each. Of a family drawn twice ("η = 0.7" and, in another
    style, "η = 0.7, Gaussian") the second is explained once, by what its names add."""
    drawn = {curve["name"]: curve for curve in figure["curves"] if curve["role"] != "guide"}
    few = len(levels_of(figure)) <= len(FEW)
    names = {}
    for name, curve in drawn.items():
        base, _, added = name.partition(", ")
        if curve["role"] == "family" and added and base in drawn:
            names.setdefault(added, {**curve, "name": added, "role": "guide"})
        elif curve["role"] != "family" or few:
            names[name] = curve
    return names


def legend_columns(names):
    return max(1, min(len(names), 4, 56 // (max(map(len, names)) + 7)))


def add_key(axes, figure, levels):
    """A legend above the axes; a colour bar for a family of many curves, and a legend for the other curves. Returns the
    number of lines of the legend."""
    if len(levels) > len(FEW):
        norm = colors.BoundaryNorm([i - 0.5 for i in range(len(levels) + 1)], len(levels))
        bar = axes.figure.colorbar(ScalarMappable(norm, colour_map(levels)), ax=axes, pad=0.02, aspect=30)
        bar.set_ticks(range(len(levels)), labels=[f"{level:g}" for level in levels], fontsize=5.5)
        bar.ax.tick_params(length=0)
        bar.minorticks_off()
        bar.set_label(axis_text(figure["family"]), fontsize=7)
    names = legend_names(figure)
    if not names or (len(names) == 1 and len(figure["curves"]) == 1):
        return 0
    drawn = dict(zip(*reversed(axes.get_legend_handles_labels())))
    handles = [drawn[text(name)] if text(name) in drawn else
               axes.plot([], [], color=ROLES["guide"], linestyle=LINES[curve["line"]],
                         marker="o" if curve["line"] == "points" else "", markerfacecolor="none")[0]
               for name, curve in names.items()]
    columns = legend_columns(names)
    axes.legend(handles, [text(name) for name in names], loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncol=columns)
    return -(-len(names) // columns)


def legend_lines(figure):
    names = legend_names(figure)
    return -(-len(names) // legend_columns(names)) if names else 0


def crowding(axes, corner, size):
    """How much of curves and bands lies under an inset at that corner (axes fractions), sampled along their lines."""
    count = 0
    outlines = [line.get_xydata() for line in axes.get_lines()]
    outlines += [path.vertices for band in axes.collections for path in band.get_paths()]
    for outline in outlines:
        points = axes.transAxes.inverted().transform(axes.transData.transform(outline))
        for (x0, y0), (x1, y1) in zip(points, points[1:]):
            for t in (0, 0.25, 0.5, 0.75):
                x, y = x0 + t * (x1 - x0), y0 + t * (y1 - y0)
                count += corner[0] < x < corner[0] + size[0] and corner[1] < y < corner[1] + size[1]
    return count


def make_room(axes, share):
    """Moves the upper end of the y axis so that the highest `share` of the axes is free."""
    low, high = axes.get_ylim()
    axes.top_of_data = high
    if axes.get_yscale() == "log":
        axes.set_ylim(low, low * (high / low) ** (1 / (1 - share)))
    else:
        axes.set_ylim(low, low + (high - low) / (1 - share))


def draw_inset(axes, inset, family_of):
    named = [curve for curve in inset["curves"] if curve["role"] == "family"]
    if len(named) > 3 or family_of and {curve["level"] for curve in named} <= set(family_of):
        named = []  # the colour bar of the main figure explains them
    legend = 0.06 if named else 0
    size, room = (0.33, 0.28), (0.47, 0.43 + legend)  # of the inset, and with its labels
    places = {(1 - room[0], 1 - room[1]): "upper right", (0, 1 - room[1]): "upper left", (1 - room[0], 0): "lower right",
              (0, 0): "lower left"}
    axes.figure.canvas.draw()
    crowded = {corner: crowding(axes, corner, room) for corner in places}
    corner = min(crowded, key=crowded.get)
    if crowded[corner] > 0:
        make_room(axes, 0.42 + legend)
        corner = (1 - room[0], 1 - room[1])
    right = corner[0] + room[0] - (0.035 if corner[0] > 0 else 0.015)  # clear of the ticks, or of the curves
    left = right - size[0]
    place = [left, corner[1] + room[1] - size[1] - 0.03 - legend, *size]
    levels = levels_of(inset)
    if family_of and set(levels) <= set(family_of):
        levels = family_of  # the colours of the main figure
    small = draw_inset_at(axes, inset, levels, place, named)
    outer = small.get_tightbbox(axes.figure.canvas.get_renderer()).transformed(axes.transAxes.inverted())
    overlap = 0.035 - outer.x0  # with the ticks of the main axes on the left
    if overlap > 0:  # wide tick labels: a narrower inset, for to the right of it there are curves
        small.remove()
        draw_inset_at(axes, inset, levels, [left + overlap, place[1], size[0] - overlap, size[1]], named)


def draw_inset_at(axes, inset, levels, place, named):
    """The inset in `place` (left, bottom, width, height in fractions of the axes), with a legend for the curves `named`."""
    small = axes.inset_axes(place)
    small.tick_params(labelsize=5.5, pad=1.5, length=2, which="major")
    small.tick_params(length=1, which="minor")
    set_scales(small, inset)
    draw_curves(small, inset, levels, small=True)
    set_ticks(small, inset, True)
    small.set_xlabel(axis_text(inset["x"]), fontsize=6, labelpad=1)
    small.set_ylabel(axis_text(inset["y"]), fontsize=6, labelpad=1)
    if named:
        small.legend(fontsize=5, loc="lower center", bbox_to_anchor=(0.5, 0.98), ncol=len(named), handlelength=1,
                     borderaxespad=0.1, columnspacing=0.8, handletextpad=0.4)
    axes.figure.canvas.draw()
    return small


def shared_levels(figure, panel):
    """The levels that give the curves of a panel their colours: those of the whole figure, where a legend names them."""
    main, own = levels_of(figure), levels_of(panel)
    shared = len(main) <= len(FEW) and set(own) <= set(main) and figure["family"] == panel["family"]
    return main if shared else own


def draw_panel(axes, figure, levels, heading):
    set_scales(axes, figure)
    if figure["map"]:
        draw_map(axes, figure)
    draw_curves(axes, figure, levels)
    axes.set_xlabel(axis_text(figure["x"]))
    axes.set_ylabel(axis_text(figure["y"]))
    lines = add_key(axes, figure, levels)
    if heading:
        axes.set_title(text(heading), loc="left", pad=3 + 10.5 * lines)
    for inset in figure["insets"]:
        if inset["curves"] and not figure["map"]:
            draw_inset(axes, inset, levels)
    set_ticks(axes, figure, False)


def drawable(figure):
    return bool(figure["curves"] or figure["map"])


def draw(figure):
    """The matplotlib figure of one figure's data: the main panel, then its further panels, side by side."""
    with matplotlib.rc_context(STYLE):
        panels = [panel for panel in (figure, *figure["panels"]) if drawable(panel)]
        if figure["map"]:  # a map leaves no room for an inset: it becomes a panel
            panels += [inset for inset in figure["insets"] if drawable(inset)]
        height = HEIGHT + 0.15 * max(map(legend_lines, panels)) + (0.2 if len(panels) > 1 else 0)
        picture, row = pyplot.subplots(1, len(panels), squeeze=False, figsize=(COLUMN_WIDTH * len(panels), height),
                                       constrained_layout={"w_pad": 0.08})
        for axes, panel, letter in zip(row[0], panels, "abcdef"):
            title = panel["title"].split(". ", 1)[-1]  # without the number of the figure
            draw_panel(axes, panel, shared_levels(figure, panel), f"({letter}) {title}" if len(panels) > 1 else "")
        return picture


def save(path, formats):
    """Draws the figure of a JSON file and puts the pictures beside it."""
    with open(path, encoding="utf-8") as file:
        picture = draw(json.load(file))
    with matplotlib.rc_context(STYLE):
        for form in formats:
            name = os.path.splitext(path)[0] + "." + form
            metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}[form]
            picture.savefig(name + ".partial", format=form, metadata=metadata)
            os.replace(name + ".partial", name)
    pyplot.close(picture)


def main(arguments):
    formats, paths = ["png"], []
    for word in arguments:
        if word.startswith("--format="):
            formats = word.split("=", 1)[1].split(",")
        else:
            paths.append(word)
    for path in paths:
        save(path, formats)


if __name__ == "__main__":
    main(sys.argv[1:])
