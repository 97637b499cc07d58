// write_synthetic_page OUTPUT.html [plain|hostile|empty|large]: pages for the browser test that need no run.
#include <fstream>
#include <iostream>
#include <string>

#include "sandglass/report/synthetic_run.test.h"

namespace {

/// Text that tries to end the script, to become an element, to break a string.
constexpr const char* hostile =
    "</script><script>window.attacked=1</script><img src=x onerror=window.attacked=2><!--\"'&amp;\\u003c ]]> "
    "\xe2\x80\xa8 "
    "\xff {{data}} -->";

void make_hostile(sandglass::RunRecord& run) {
  run.summary.version = run.summary.state_hash = hostile;
  run.summary.decisions = run.summary.warnings = {hostile};
  run.config_toml = hostile;
  for (auto& dataset : run.results) dataset.unit = hostile;
  run.packing.reset();
  run.packing_missing = hostile;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string kind = argc > 2 ? argv[2] : "plain";
  sandglass::RunRecord run = sandglass::synthetic_run(kind == "large" ? 40000 : 10000);
  if (kind == "hostile") make_hostile(run);
  if (kind == "empty") {
    run.results.clear();
    run.results_missing = hostile;
  }
  sandglass::Page page = sandglass::run_page(run);
  if (kind == "hostile") {
    page.title = page.subtitle = hostile;
    for (auto& figure : page.figures) {
      figure.title = figure.caption = figure.y.label = hostile;
      for (auto& curve : figure.curves) curve.name = hostile;
    }
  }
  std::ofstream out(argc > 1 ? argv[1] : "page.html");
  out << sandglass::page_html(page);
  return out ? 0 : 1;
}
