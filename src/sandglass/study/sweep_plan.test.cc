#include "sandglass/study/sweep_plan.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rapidcheck.h>

#include <algorithm>
#include <set>

#include "sandglass/core/errors.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

SweepPlan plan_of(const std::string& text, const std::vector<std::string>& assignments = {}, double scale = 1) {
  return read_study_text(text, "study.toml", "/folder", assignments, scale);
}

std::vector<std::string> names_of(const std::string& text) { return point_names(plan_of(text)); }

bool refused(const std::string& text, const std::vector<std::string>& parts,
             const std::vector<std::string>& assignments = {}) {
  const std::string message = message_of<InputError>([&] { plan_of(text, assignments); });
  const bool good = !message.empty() && std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
    return message.find(part) != message.npos;
  });
  if (!good) MESSAGE("message was: " << message);
  return good;
}

std::set<std::string> physics_of(const SweepPlan& plan) {
  std::set<std::string> points;
  for (const Config& config : plan.points) points.insert(physics_text(config));
  return points;
}

/// Distinct numbers of hundredths in [10, 60], as TOML.
std::vector<std::string> hundredths() {
  const auto chosen = *rc::gen::nonEmpty(rc::gen::unique<std::vector<int>>(rc::gen::inRange(10, 60)));
  std::vector<std::string> texts;
  for (const int value : chosen) texts.push_back(fmt::format("0.{}", value));
  texts.resize(std::min<std::size_t>(texts.size(), 8));
  return texts;
}

std::string product(const std::vector<std::string>& densities, const std::vector<std::string>& restitutions) {
  return fmt::format("[[sweep.product]]\nsystem.packing_fraction = [{}]\ncollision.restitution = [{}]\n",
                     fmt::join(densities, ", "), fmt::join(restitutions, ", "));
}

}  // namespace

TEST_CASE("a product makes every combination, the last list running fastest, replicas by seed") {
  const SweepPlan plan = plan_of(R"(
    run.seed = 5
    [sweep]
    replicas = 2
    [[sweep.product]]
    system.packing_fraction = [0.7, 0.75]
    "collision.restitution" = [0.9, 0.7]
    run.collisions = 5000
  )");
  CHECK(plan.points.size() == 8);
  CHECK(plan.axes == std::vector<std::string>{"system.packing_fraction", "collision.restitution"});
  CHECK(point_names(plan) == std::vector<std::string>{"eta=0.70_eps=0.90_seed=5", "eta=0.70_eps=0.90_seed=6",
                                                      "eta=0.70_eps=0.70_seed=5", "eta=0.70_eps=0.70_seed=6",
                                                      "eta=0.75_eps=0.90_seed=5", "eta=0.75_eps=0.90_seed=6",
                                                      "eta=0.75_eps=0.70_seed=5", "eta=0.75_eps=0.70_seed=6"});
  for (const Config& config : plan.points) CHECK(config.run.collisions == 5000);
}

TEST_CASE("a zip walks its lists side by side; points stand alone; blocks come in the order of the file") {
  const SweepPlan plan = plan_of(R"(
    [[sweep.zip]]
    system.packing_fraction = [0.5, 0.6]
    system.particles = [1000, 40_000]
    [[sweep.point]]
    system.packing_fraction = 0.55
    collision.restitution = 0.8
    [[sweep.product]]
    replicas = 2
    system.packing_fraction = [0.3]
  )");
  CHECK(point_names(plan) ==
        std::vector<std::string>{"N=01000_eta=0.50_eps=0.90_seed=1", "N=40000_eta=0.60_eps=0.90_seed=1",
                                 "N=10000_eta=0.55_eps=0.80_seed=1", "N=10000_eta=0.30_eps=0.90_seed=1",
                                 "N=10000_eta=0.30_eps=0.90_seed=2"});
}

TEST_CASE("only keys that vary are in the names, and values of a block only where points need them") {
  CHECK(names_of("[sweep]\nreplicas = 11").front() == "seed=01");
  CHECK(names_of("[[sweep.product]]\ncollision.restitution = [0.5]\nsystem.packing_fraction = [0.7, 0.725]") ==
        std::vector<std::string>{"eta=0.700_seed=1", "eta=0.725_seed=1"});
  // The second block differs from the first by its number of disks and its length: the first of the two tells enough.
  CHECK(names_of("[[sweep.product]]\nsystem.packing_fraction = [0.7, 0.75]\n[[sweep.product]]\n"
                 "system.packing_fraction = [0.7, 0.75]\nrun.collisions = 1e5\nsystem.particles = 4000") ==
        std::vector<std::string>{"N=10000_eta=0.70_seed=1", "N=10000_eta=0.75_seed=1", "N=04000_eta=0.70_seed=1",
                                 "N=04000_eta=0.75_seed=1"});
  CHECK(names_of("[[sweep.product]]\ndrive.kind = [\"pair\", \"single\"]\nrun.equilibrate = [10, 1e3]\n"
                 "collision.collapse_time = [2e-6, 0]\nobserve.wavenumbers = [[0.5], [1, 2]]") ==
        std::vector<std::string>{"collapse_time=2e-06_kind=pair_equilibrate=0010_wavenumbers=0.5_seed=1",
                                 "collapse_time=2e-06_kind=pair_equilibrate=0010_wavenumbers=1-2_seed=1",
                                 "collapse_time=0_kind=pair_equilibrate=0010_wavenumbers=0.5_seed=1",
                                 "collapse_time=0_kind=pair_equilibrate=0010_wavenumbers=1-2_seed=1",
                                 "collapse_time=2e-06_kind=pair_equilibrate=1000_wavenumbers=0.5_seed=1",
                                 "collapse_time=2e-06_kind=pair_equilibrate=1000_wavenumbers=1-2_seed=1",
                                 "collapse_time=0_kind=pair_equilibrate=1000_wavenumbers=0.5_seed=1",
                                 "collapse_time=0_kind=pair_equilibrate=1000_wavenumbers=1-2_seed=1",
                                 "collapse_time=2e-06_kind=single_equilibrate=0010_wavenumbers=0.5_seed=1",
                                 "collapse_time=2e-06_kind=single_equilibrate=0010_wavenumbers=1-2_seed=1",
                                 "collapse_time=0_kind=single_equilibrate=0010_wavenumbers=0.5_seed=1",
                                 "collapse_time=0_kind=single_equilibrate=0010_wavenumbers=1-2_seed=1",
                                 "collapse_time=2e-06_kind=single_equilibrate=1000_wavenumbers=0.5_seed=1",
                                 "collapse_time=2e-06_kind=single_equilibrate=1000_wavenumbers=1-2_seed=1",
                                 "collapse_time=0_kind=single_equilibrate=1000_wavenumbers=0.5_seed=1",
                                 "collapse_time=0_kind=single_equilibrate=1000_wavenumbers=1-2_seed=1"});
}

TEST_CASE("assignments act on every point, the scale on the measured length, replicas come last") {
  const std::string study =
      "[sweep]\nreplicas = 3\n[[sweep.product]]\nsystem.packing_fraction = [0.5, 0.6]\n"
      "run.collisions = 2000";
  const SweepPlan plan = plan_of(study, {"run.seed=7", "run.collisions=300"}, 10);
  CHECK(plan.points.size() == 6);
  CHECK(plan.points.back().run.seed == 9);
  for (const Config& config : plan.points) CHECK(config.run.collisions == 3000);
  // An axis that is set has one value left.
  const SweepPlan collapsed = plan_of(study, {"system.packing_fraction=0.7"});
  CHECK(collapsed.points.size() == 3);
  CHECK(collapsed.repeated == 3);
}

TEST_CASE("a product of any lists has as many points as combinations, with different physics and names") {
  CHECK(rc::check("count and uniqueness", [] {
    const auto densities = hundredths(), restitutions = hundredths();
    const auto replicas = *rc::gen::inRange<std::size_t>(1, 4);
    const SweepPlan plan =
        plan_of(fmt::format("[sweep]\nreplicas = {}\n", replicas) + product(densities, restitutions));
    RC_ASSERT(plan.points.size() == densities.size() * restitutions.size() * replicas);
    RC_ASSERT(physics_of(plan).size() == plan.points.size());
    const auto names = point_names(plan);
    RC_ASSERT(std::set(names.begin(), names.end()).size() == names.size());
    for (const std::string& name : names)
      RC_ASSERT(name.find_first_not_of("abcdefghijklmnopqrstuvwxyzN0123456789._=-") == name.npos);
  }));
}

TEST_CASE("names sort as their numbers do") {
  CHECK(rc::check("order", [] {
    const auto densities = hundredths();
    const SweepPlan plan = plan_of(product(densities, {"0.5"}));
    auto names = point_names(plan);
    std::vector<double> values;
    for (const Config& config : plan.points) values.push_back(config.system.packing_fraction);
    std::sort(names.begin(), names.end());
    std::sort(values.begin(), values.end());
    for (std::size_t i = 0; i < names.size(); ++i)
      RC_ASSERT(names.size() == 1 || names[i] == fmt::format("eta={:.2f}_seed=1", values[i]));
  }));
}

TEST_CASE("the points do not depend on the order of values, keys and blocks, nor on overlaps") {
  CHECK(rc::check("order independence", [] {
    auto densities = hundredths(), restitutions = hundredths();
    const std::string first = product(densities, restitutions), second = product(restitutions, densities);
    const SweepPlan plan = plan_of(first + second);
    RC_ASSERT(plan.points.size() + plan.repeated == 2 * densities.size() * restitutions.size());
    std::reverse(densities.begin(), densities.end());
    RC_ASSERT(physics_of(plan_of(second + product(densities, restitutions))) == physics_of(plan));
  }));
}

TEST_CASE("every mistake is named with its place") {
  CHECK(refused("[run]\nseed = 1", {"study.toml", "no [sweep]"}));
  CHECK(refused("[sweep]\nreplica = 2", {"study.toml:2:1", "no key replica"}));
  CHECK(refused("[sweep]\nreplicas = 0", {"study.toml:2:12", "[1, 10000]"}));
  CHECK(refused("[sweep]\nreplicas = 1.5", {"whole number"}));
  CHECK(refused("sweep = 3", {"must be a table"}));
  CHECK(refused("[sweep.product]\nrun.seed = [1]", {"study.toml:1:", "[[sweep.product]]"}));
  CHECK(refused("[[sweep.product]]\nsystem.packing_fracton = [0.5]",
                {"study.toml:2:", "did you mean system.packing_fraction"}));
  CHECK(refused("[[sweep.product]]\npacking_fraction = [0.5]",
                {"study.toml:2:", "did you mean system.packing_fraction"}));
  CHECK(refused("[[sweep.product]]\nsystem.packing_fraction = []", {"study.toml:2:", "no value"}));
  CHECK(refused("[[sweep.product]]\nsystem.packing_fraction = [0.5, 0.95]", {"study.toml:2:33", "out of range"}));
  CHECK(refused("[[sweep.product]]\nsystem.packing_fraction = [0.5]\n\"system.packing_fraction\" = 0.6",
                {"given twice"}));
  CHECK(
      refused("[[sweep.zip]]\nrun.seed = [1, 2]\nsystem.packing_fraction = [0.5]", {"study.toml:3:", "2 values", "1"}));
  CHECK(refused("[[sweep.point]]\nsystem.packing_fraction = [0.5]", {"study.toml:2:", "must be a number"}));
  CHECK(refused("[prepare]\nmethod = \"insert\"\n[[sweep.product]]\nsystem.packing_fraction = [0.3, 0.5]",
                {"study.toml:3:", "system.packing_fraction = 0.5", "insert"}));
  CHECK(refused("[run]\nseed = 9223372036854775807\n[sweep]\nreplicas = 2", {"run.seed", "no room"}));
  CHECK(refused("[sweep]", {"run.sed", "did you mean run.seed"}, {"run.sed=1"}));
  CHECK(message_of<InputError>([] { plan_of("[sweep]", {}, 0); }).find("--scale") != std::string::npos);
  std::string many = "[[sweep.product]]\n";
  for (const char* key : {"run.seed", "system.packing_fraction"}) {
    many += fmt::format("{} = [", key);
    for (int i = 0; i < 400; ++i) many += "0.5,";
    many += "]\n";
  }
  CHECK(refused(many, {"160000 points"}));
}

TEST_CASE("a study of the wrong kind is never worse than refused") {
  CHECK(rc::check("arbitrary text", [](const std::string& text) {
    for (const std::string& study :
         {text, "[sweep]\n" + text, "[[sweep.product]]\n" + text, "[[sweep.zip]]\nrun.seed = " + text})
      try {
        plan_of(study);
      } catch (const InputError&) {
      }
  }));
}
