#include "sandglass/report/report.h"

#include <functional>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/report/run_page.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

/// Why `read` could not read; empty when it could.
std::string failure_of(const std::function<void()>& read) {
  try {
    read();
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

RunRecord record_of(const Summary& summary, const std::filesystem::path& folder) {
  RunRecord record;
  record.summary = summary;
  record.results_missing = failure_of([&] { record.results = read_results(folder / "observables.h5"); });
  return record;
}

}  // namespace

void write_report(const std::filesystem::path& run_folder) {
  constexpr std::size_t longest_config = 1 << 20;
  RunRecord run = record_of(read_summary(run_folder / "summary.json"), run_folder);
  failure_of([&] { run.config_toml = read_whole(run_folder / "config.toml", longest_config); });
  run.packing_missing =
      failure_of([&] { run.packing = packing_of(read_checkpoint(run_folder / "checkpoint.h5", {}).state); });
  write_whole(run_folder / "report.html", page_html(run_page(run)));
}

void write_analysis_report(const std::filesystem::path& folder, const Summary& summary, const State& last,
                           const std::string& command) {
  RunRecord analysis = record_of(summary, folder);
  analysis.packing = packing_of(last);
  analysis.command = command;
  write_whole(folder / "report.html", page_html(analysis_page(analysis)));
}

}  // namespace sandglass
