#include "sandglass/dynamics/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/engine.h"
#include "sandglass/dynamics/epoch.h"
#include "sandglass/dynamics/spatial_order.h"
#include "sandglass/dynamics/start_check.h"

namespace sandglass {
namespace {

struct InstructionSet {
  const char* name;
  Engine* (*make_engine)(State&, const Tuning&);
};

// The widest that this machine has, unless SANDGLASS_ISA asks for a narrower one (for tests).
InstructionSet choose_instruction_set() {
#ifdef SANDGLASS_X86_64
  const char* wish = std::getenv("SANDGLASS_ISA");
  const std::string_view widest = wish ? wish : "avx512";
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && widest != "baseline";
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && widest != "avx2";
  if (avx512) return {"avx512", make_engine_avx512};
  if (avx2) return {"avx2", make_engine_avx2};
#endif
  return {"baseline", make_engine_baseline};
}

}  // namespace

void append_event(std::vector<Event>& log, const Event& event) { log.push_back(event); }

DiskName nth_by_id(DiskName* first, DiskName* last, std::size_t n) {
  std::nth_element(first, first + n, last, [](const DiskName& a, const DiskName& b) { return a.id < b.id; });
  return first[n];
}

Engine::~Engine() = default;

std::vector<Event>* Engine::strip_log(std::size_t strip) {
  if (!log) return nullptr;
  if (strip_logs_.size() <= strip) strip_logs_.resize(strip + 1);
  return &strip_logs_[strip];
}

void Engine::gather_strip_logs() {
  if (!log) return;
  std::vector<Event> events;
  for (const auto& strip : strip_logs_) events.insert(events.end(), strip.begin(), strip.end());
  std::sort(events.begin(), events.end());
  log->insert(log->end(), events.begin(), events.end());
  drop_strip_logs();
}

void Engine::drop_strip_logs() {
  for (auto& strip : strip_logs_) strip.clear();
}

void report_collapse(const State& state, double t) {
  const double time = static_cast<double>(state.epoch) * state.epoch_length + t;
  throw RunError("inelastic collapse at time " + std::to_string(time) +
                 ": a few disks collide infinitely often in a finite time, as dissipative hard disks may. Set "
                 "collision.collapse_policy = \"tc\" (or a longer collision.collapse_time)");
}

struct Simulation::Run {
  State state;  // its disks are with the engine, except for a moment at epochs
  std::unique_ptr<Crew> crew;
  std::unique_ptr<Engine> engine;
  std::size_t size = 0;

  /// Gives the disks to the engine. Returns what is wrong with them, if two of them overlap.
  std::string load() {
    size = state.size();
    const OverlappingPair overlap = engine->load(spatial_order(state).data());
    if (overlap.first == no_disk) return {};
    return "disks " + std::to_string(overlap.first) + " and " + std::to_string(overlap.second) + " overlap by " +
           std::to_string(overlap.depth) + " R_s";
  }

  void store(State& target) const {
    target.disks.resize(size);
    engine->store(target.disks.data());
  }
};

Simulation::Simulation(State state, const Tuning& tuning) : run_(std::make_unique<Run>()) {
  check_start(state);
  run_->state = std::move(state);
  run_->engine.reset(choose_instruction_set().make_engine(run_->state, tuning));
  if (tuning.threads > 1) {
    run_->crew = std::make_unique<Crew>(tuning.threads);
    run_->engine->crew = run_->crew.get();
  }
  if (const std::string overlap = run_->load(); !overlap.empty())
    throw InputError(overlap + " (hard disks may not overlap): prepare the start at a lower packing fraction, or let " +
                     "the program prepare it");
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

void Simulation::run_until(double end) {
  State& state = run_->state;
  for (;;) {
    const double local = end - static_cast<double>(state.epoch) * state.epoch_length;
    if (local < state.epoch_length) {
      if (local > state.now) run_->engine->run(local);
      return;
    }
    run_->engine->run(state.epoch_length);
    run_->engine->forget_what_comes();
    run_->store(state);
    pass_epoch(state);
    if (const std::string overlap = run_->load(); !overlap.empty())
      throw RunError("at time " + std::to_string(state.time()) + " " + overlap +
                     ": the run has gone wrong and cannot go on. Resume from the last checkpoint, and please report "
                     "this with config.toml");
  }
}

double Simulation::time() const { return run_->state.time(); }
const Tally& Simulation::tally() const { return run_->state.tally; }
std::size_t Simulation::size() const { return run_->size; }
bool Simulation::conserves_momentum() const { return run_->state.drive.kind != DriveKind::single; }
unsigned Simulation::threads() const { return run_->engine->threads(); }

State Simulation::state() const& {
  State copy = run_->state;
  run_->store(copy);
  return copy;
}

State Simulation::state() && {
  run_->engine->forget_what_comes();
  return static_cast<const Simulation&>(*this).state();
}

void Simulation::make_frame(Frame& frame) const {
  frame.resize(size());
  frame.time = time();
  frame.collisions_per_disk = 2.0 * static_cast<double>(tally().collisions()) / static_cast<double>(size());
  run_->engine->make_frame(frame.x.data(), frame.y.data(), frame.vx.data(), frame.vy.data());
}

Inspection Simulation::inspect() const { return run_->engine->inspect(); }

const char* Simulation::instruction_set() { return choose_instruction_set().name; }

void Simulation::set_event_log(std::vector<Event>* log) { run_->engine->log = log; }
Simulation::Bookkeeping Simulation::bookkeeping() const { return run_->engine->bookkeeping; }

}  // namespace sandglass
