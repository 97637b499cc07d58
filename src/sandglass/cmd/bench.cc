// sandglass bench: how fast the engine is at one state point.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sandglass/cmd/commands.h"
#include "sandglass/cmd/progress_bar.h"
#include "sandglass/core/errors.h"
#include "sandglass/core/version.h"
#include "sandglass/prepare/insert.h"
#include "sandglass/study/benchmark.h"
#include "sandglass/study/summarise.h"

namespace sandglass {
namespace {

struct Arguments {
  std::uint64_t particles = 10000, threads = 1, seed = 1, repeats = 5;
  double packing_fraction = 0.7, restitution = 1, age = 100;
  double collisions = 0;  // 0: the program chooses
  std::string drive = "none";
  bool json = false;
};

Arguments parse(int argc, char** argv, int& exit_code) {
  Arguments a;
  CLI::App app{
      "Measures the speed of the engine at one state point: prepares and ages a start (a large one as\n"
      "tiles of about 10^4 disks, repeated), times several repeats, checks that what was computed are hard disks.",
      "sandglass bench"};
  app.add_option("--particles", a.particles, "number of disks")->capture_default_str();
  app.add_option("--packing-fraction", a.packing_fraction, "area fraction")->capture_default_str();
  app.add_option("--restitution", a.restitution, "normal restitution; below 1 (down to 0.5) only with --drive pair")
      ->capture_default_str();
  app.add_option("--drive", a.drive, "none, or pair: kicks at the collision rate, calibrated to T = 1")
      ->check(CLI::IsMember({"none", "pair"}))
      ->capture_default_str();
  app.add_option("--collisions", a.collisions,
                 "collisions per disk to measure, all repeats together (default: 2e7 collisions in all, at least 5 per "
                 "disk)")
      ->check(CLI::PositiveNumber);
  app.add_option("--age", a.age, "collisions per disk before measuring; 100 take a minute or two at 4e6 disks")
      ->capture_default_str();
  app.add_option("--repeats", a.repeats, "stretches that are timed")->capture_default_str();
  app.add_option("--seed", a.seed, "seed of every random number")->capture_default_str();
  app.add_option("--threads", a.threads, "threads that share the work; fewer than asked for where more would not pay")
      ->capture_default_str();
  app.add_flag("--json", a.json, "print one JSON object instead of text");
  exit_code = -1;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  return a;
}

BenchmarkPlan plan_of(const Arguments& a) {
  const auto method = a.packing_fraction <= insert_limit ? "insert" : "quench";
  BenchmarkPlan plan;
  plan.age = a.age;
  plan.repeats = a.repeats;
  plan.config = read_config({}, {fmt::format("system.particles={}", a.particles),
                                 fmt::format("system.packing_fraction={}", a.packing_fraction),
                                 fmt::format("collision.restitution={}", a.restitution),
                                 fmt::format("drive.kind={}", a.drive), fmt::format("prepare.method={}", method),
                                 fmt::format("run.seed={}", a.seed), fmt::format("run.threads={}", a.threads)});
  if (a.collisions > 0) plan.collisions = a.collisions;
  return plan;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

/// (largest - smallest) / median.
double spread(const std::vector<double>& rates) {
  const auto [least, most] = std::minmax_element(rates.begin(), rates.end());
  return (*most - *least) / median(rates);
}

/// Events, physical and not, per collision.
std::vector<std::pair<std::string, double>> events_per_collision(const Benchmark& b) {
  const auto collisions = static_cast<double>(b.events.collisions());
  const auto per = [&](std::uint64_t count) { return static_cast<double>(count) / collisions; };
  return {{"contacts_small_small", per(b.events.contacts[0])},
          {"contacts_small_big", per(b.events.contacts[1])},
          {"contacts_big_big", per(b.events.contacts[2])},
          {"kicks", per(b.events.kicks)},
          {"transits", per(b.events.transits)},
          {"list_rebuilds", per(b.bookkeeping.list_rebuilds)},
          {"predictions", per(b.bookkeeping.predictions)},
          {"orphans", per(b.bookkeeping.orphans)},
          {"frozen", per(b.bookkeeping.frozen)},
          {"left_over", per(b.bookkeeping.left_over)},
          {"windows", per(b.bookkeeping.windows)},
          {"windows_undone", per(b.bookkeeping.windows_undone)}};
}

void print_json(const Arguments& a, const Benchmark& b) {
  using Json = nlohmann::ordered_json;
  const double rate = median(b.rates);
  Json check{{"passed", true}, {"figures", Json::array()}};
  for (const CheckedFigure& figure : b.check) {
    if (!figure.passed()) check["passed"] = false;
    check["figures"].push_back({{"quantity", figure.quantity},
                                {"measured", figure.measured},
                                {"expected", figure.expected},
                                {"tolerance", figure.tolerance},
                                {"passed", figure.passed()}});
  }
  Json events;
  for (const auto& [name, count] : events_per_collision(b)) events[name] = count;
  const Json out{{"collisions_per_second", rate},
                 {"state_hash", b.state_hash},
                 {"rates", b.rates},
                 {"spread", spread(b.rates)},
                 {"ns_per_collision", 1e9 / rate},
                 {"wall_seconds", b.wall_seconds},
                 {"cpu_seconds", b.cpu_seconds},
                 {"events", events},
                 {"bytes_per_disk", b.bytes_per_disk},
                 {"peak_bytes_per_disk", b.peak_bytes_per_disk},
                 {"particles", a.particles},
                 {"packing_fraction", a.packing_fraction},
                 {"restitution", a.restitution},
                 {"drive", a.drive},
                 {"kick_frequency", b.kick_frequency},
                 {"kick_amplitude", b.kick_amplitude},
                 {"temperature", b.temperature},
                 {"tiles", b.tiles_per_side * b.tiles_per_side},
                 {"aged_collisions_per_disk", b.aged},
                 {"collisions_per_disk", b.measured},
                 {"repeats", a.repeats},
                 {"seed", a.seed},
                 {"threads", b.threads},
                 {"instruction_set", Simulation::instruction_set()},
                 {"version", version},
                 {"check", check}};
  fmt::print("{}\n", out.dump(2));
}

void print_text(const Arguments& a, const Benchmark& b) {
  const auto line = [](std::string_view what, const std::string& value) { fmt::print("  {:<28}{}\n", what, value); };
  const double rate = median(b.rates);
  const auto [least, most] = std::minmax_element(b.rates.begin(), b.rates.end());
  fmt::print("{} disks, packing fraction {:g}, restitution {:g}, drive {}, seed {}\n", a.particles, a.packing_fraction,
             a.restitution, a.drive, a.seed);
  line("prepared", b.tiles_per_side == 1 ? "as a whole"
                                         : fmt::format("as {0} x {0} tiles of {1} disks", b.tiles_per_side,
                                                       a.particles / (b.tiles_per_side * b.tiles_per_side)));
  line("aged, then measured", fmt::format("{:.4g}, then {:.4g} collisions per disk", b.aged, b.measured));
  line("speed", fmt::format("{:.3f} million collisions/s, median of {} ({:.3f} to {:.3f})", rate / 1e6, b.rates.size(),
                            *least / 1e6, *most / 1e6));
  line("per collision",
       fmt::format("{:.1f} ns; processor busy {:.0f} % of the time", 1e9 / rate, 100 * b.cpu_seconds / b.wall_seconds));
  for (const auto& [name, count] : events_per_collision(b)) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    if (count > 0) line("  " + words, fmt::format("{:.4g}", count));
  }
  line("memory",
       fmt::format("{:.0f} bytes per disk while running, {:.0f} at most", b.bytes_per_disk, b.peak_bytes_per_disk));
  line("temperature at the end", fmt::format("{:.4f}", b.temperature));
  line("engine", fmt::format("sandglass {}, {}, {} thread{}", version, Simulation::instruction_set(), b.threads,
                             b.threads == 1 ? "" : "s"));
  line("state", b.state_hash);
  for (const CheckedFigure& figure : b.check)
    fmt::print("  {} {}: {:.6g}, expected {:.6g} +- {:.2g}\n", figure.passed() ? "passed:" : "FAILED:", figure.quantity,
               figure.measured, figure.expected, figure.tolerance);
}

}  // namespace

int bench_command(int argc, char** argv) {
  int exit_code = 0;
  const Arguments arguments = parse(argc, argv, exit_code);
  if (exit_code >= 0) return exit_code;
  const BenchmarkPlan plan = plan_of(arguments);
  Benchmark benchmark;
  {
    ProgressBar bar;
    benchmark = run_benchmark(plan, [&](std::string_view stage, double fraction) { bar.show(stage, fraction); });
  }
  if (benchmark.threads < arguments.threads)
    fmt::print(stderr, "sandglass: {}\n", fewer_threads(plan.config, benchmark.threads));
  arguments.json ? print_json(arguments, benchmark) : print_text(arguments, benchmark);
  std::fflush(stdout);
  require_passed(benchmark.check);
  return static_cast<int>(ExitCode::done);
}

}  // namespace sandglass
