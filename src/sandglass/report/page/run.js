"use strict";
// Fills the page from the JSON document in #data. Text from it enters the page as text only (textContent), never as HTML.
(() => {
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
      "aria-label": `The packing at the end of the run: ${count} disks, coloured by their size or by their bond order.` });
    const reading = element("span", { "aria-live": "polite" });
    const key = element("div", { className: "key" });
    const node = element("figure", { id: "figure-packing" }, canvas, key);

    // What the colour shows: the species, or |ψ₆| in ten steps.
    const order = packing.x.map((_, i) => Math.hypot(packing.psi[0][i], packing.psi[1][i])), steps = 10;
    let byOrder = false;
    const kinds = () => (byOrder ? Array.from({ length: steps }, (_, i) => `rgb(${sequential(i / (steps - 1))})`) : names);
    const kindOf = (i) => (byOrder ? Math.min(steps - 1, Math.floor(order[i] * steps)) : packing.species[i]);

    const paint = (target, pixels, colours) => {
      target.width = target.height = pixels;
      const pen = target.getContext("2d"), scale = pixels / side;
      pen.fillStyle = colours.ground;
      pen.fillRect(0, 0, pixels, pixels);
      let drawn = 0;
      kinds().forEach((name, kind) => {
        pen.fillStyle = colours[name] ?? name;
        pen.beginPath();
        for (let i = 0; i < count; i++) {
          if (kindOf(i) !== kind) continue;
          drawn++;
          const radius = packing.radius[packing.species[i]];
          // A disk across the border of the periodic box is seen on both sides.
          for (const dx of whole ? [-box, 0, box] : [0]) for (const dy of whole ? [-box, 0, box] : [0]) {
            const x = packing.x[i] + dx - left, y = packing.y[i] + dy - bottom;
            if (x < -radius || x > side + radius || y < -radius || y > side + radius) continue;
            pen.moveTo((x + radius) * scale, pixels - y * scale);
            pen.arc(x * scale, pixels - y * scale, radius * scale, 0, 2 * Math.PI);
          }
        }
        pen.fill();
      });
      pen.strokeStyle = colours.ink;
      pen.lineWidth = Math.max(1, pixels / 700);
      pen.strokeRect(0, 0, pixels, pixels);
      return drawn;
    };
    const draw = () => {
      const colours = palette();
      node.dataset.drawn = paint(canvas, Math.round(Math.min(760, canvas.clientWidth || 760) * Math.max(2, devicePixelRatio)), colours);
      const meaning = (kind) => (byOrder ? (kind === 0 ? "|ψ₆| = 0" : kind === steps - 1 ? "1" : "")
        : `${names[kind]} (radius ${shown(packing.radius[kind])} Rₛ)`);
      key.replaceChildren(...kinds().map((name, kind) => element("span", {},
        element("span", { className: "dot", style: `background:${colours[name] ?? name}` }), meaning(kind))), reading);
    };
    canvas.addEventListener("pointermove", (event) => {
      const x = left + (event.offsetX / canvas.clientWidth) * side, y = bottom + (1 - event.offsetY / canvas.clientHeight) * side;
      const near = (d) => (whole ? d - box * Math.round(d / box) : d);
      const at = packing.x.findIndex((px, i) => Math.hypot(near(px - x), near(packing.y[i] - y)) <= packing.radius[packing.species[i]]);
      reading.textContent = at < 0 ? "" : `disk ${packing.id[at]}, ${names[packing.species[at]]}, at (${shown(packing.x[at])}, ${shown(packing.y[at])}) Rₛ, |ψ₆| = ${shown(order[at], 3)}`;
    });
    const csv = () => csvBlob([["id", "species", "radius [R_s]", "x [R_s]", "y [R_s]", "Re psi_6", "Im psi_6"], ...packing.x.map((x, i) =>
      [packing.id[i], names[packing.species[i]], packing.radius[packing.species[i]], x, packing.y[i], packing.psi[0][i], packing.psi[1][i]])]);
    const png = () => {
      const copy = element("canvas");
      paint(copy, 2000, palettes.light);
      copy.toBlob((blob) => download("packing.png", blob));
    };
    node.prepend(element("div", { className: "controls" },
      choice("Colour shows", [["species", "Colour shows the species", false], ["bond order", "Colour shows the bond order |ψ₆|", true]],
             false, (value) => { byOrder = value; draw(); }),
      button("CSV", "Download positions and bond orders as CSV", () => download("packing.csv", csv())),
      button("PNG", "Download the picture as PNG", png)));
    node.append(element("figcaption", { textContent: whole
      ? `All ${count} disks at the end of the run in the periodic box of side ${shown(box, 5)} Rₛ.`
      : `The middle of the box at the end of the run: a square of side ${shown(side, 5)} Rₛ with ${count} disks. The whole box, of side ${shown(box, 5)} Rₛ, holds too many disks to be seen; all of them are in checkpoint.h5.` }));
    parent.append(node);
    node.dataset.points = count;
    return draw;
  }

  // ---- the page

  put("results", tableOf(page.results, "Results"));
  put("parameters", tableOf(page.parameters, "Parameters"));
  put("provenance", tableOf({ columns: ["", ""], rows: page.provenance }, "Provenance"));
  put("decisions", ...page.warnings.map((text) => element("p", { className: "warning", textContent: text })),
    element("ul", {}, ...page.decisions.map((text) => element("li", { textContent: text }))));
  put("commands", page.commands.join("\n"));
  put("config", page.config);
  if (!page.parameters.rows.length) {  // stored frames have none
    for (const id of ["parameters-section", "configuration", "cite"]) document.getElementById(id).remove();
    document.querySelector('nav a[href="#parameters-section"]').remove();
    document.getElementById("again").textContent = "Made from the stored frames by:";
  }

  const figures = document.getElementById("figures");
  const redraws = page.figures.map((figure) => addFigure(figure, figures, page.title));
  redraws.push(addPacking(page.packing, document.getElementById("packing")));
  const redraw = () => redraws.forEach((draw) => draw());
  redraw();  // only now: how wide a figure is depends on what stands beside it

  redrawOnChange(redraw);
  document.documentElement.dataset.ready = "true";
})();
