"use strict";
// What every page begins with, from the JSON document in #data. Text from it enters the page as text only, never as HTML.
const page = JSON.parse(document.getElementById("data").textContent);
const put = (id, ...nodes) => document.getElementById(id).append(...nodes);

document.title = `${page.title} – sandglass`;
put("title", page.title);
put("subtitle", page.subtitle);
put("summary", ...page.summary.map((text) => element("p", { textContent: text })));
put("highlights", ...page.highlights.map(([name, value]) =>
  element("div", {}, element("dt", { textContent: name }), element("dd", { textContent: value }))));
