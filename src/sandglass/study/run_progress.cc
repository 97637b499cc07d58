#include "sandglass/study/run_progress.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"

namespace sandglass {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string this_host() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

ProgressFile::ProgressFile(std::filesystem::path folder, const Config& config, double interval)
    : file_(progress_file(folder)),
      equilibrate_(config.run.equilibrate),
      collisions_(config.run.collisions),
      interval_(interval) {
  if (const auto before = read_progress(folder)) progress_.fraction = before->fraction;  // of the run that goes on
  progress_.host = this_host();
}

void ProgressFile::show(std::string_view stage, double fraction) {
  const auto bracket = stage.find(" (");
  const std::string name(stage.substr(0, bracket));
  const auto now = Clock::now();
  const bool new_stage = name != progress_.stage;
  if (new_stage) {
    progress_.stage = name;
    first_fraction_ = fraction;
    stage_began_ = now;
  }
  progress_.remark.clear();
  if (bracket != stage.npos) progress_.remark = stage.substr(bracket + 2, stage.size() - bracket - 3);
  double done = 0;  // in collisions per disk
  if (name == "equilibrating") done = fraction * equilibrate_;
  if (name == "measuring") done = equilibrate_ + fraction * collisions_;
  progress_.fraction = std::clamp(done / (equilibrate_ + collisions_), 0.0, 1.0);
  progress_.seconds_left.reset();
  const double elapsed = std::chrono::duration<double>(now - stage_began_).count();
  const double stage_length = name == "equilibrating" ? equilibrate_ : name == "measuring" ? collisions_ : 0;
  const double per_second = (fraction - first_fraction_) * stage_length / elapsed;
  if (elapsed > 1 && per_second > 0) progress_.seconds_left = (equilibrate_ + collisions_ - done) / per_second;
  if (!new_stage && std::chrono::duration<double>(now - last_written_).count() < interval_) return;
  last_written_ = now;
  write();
}

void ProgressFile::stopped() {
  progress_.seconds_left.reset();
  write();
}

void ProgressFile::failed(const std::string& message) {
  progress_.stage = "failed";
  progress_.remark = message;
  stopped();
}

void ProgressFile::finished() {
  std::error_code error;
  std::filesystem::remove(file_, error);
}

void ProgressFile::write() const {
  Json json{{"stage", progress_.stage},
            {"remark", progress_.remark},
            {"fraction", progress_.fraction},
            {"seconds_left", nullptr},
            {"host", progress_.host}};
  if (progress_.seconds_left) json["seconds_left"] = *progress_.seconds_left;
  const std::filesystem::path temporary = file_.string() + ".partial";
  std::error_code error;
  std::filesystem::remove(temporary, error);  // a pipe in its place would keep us waiting
  std::ofstream out(temporary, std::ios::binary);
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  out.close();
  if (out)
    std::filesystem::rename(temporary, file_, error);
  else
    std::filesystem::remove(temporary, error);
}

std::filesystem::path progress_file(const std::filesystem::path& folder) { return folder / "progress.json"; }

std::optional<RunProgress> read_progress(const std::filesystem::path& folder) {
  constexpr std::size_t longest = 1 << 16;
  try {
    const Json json = Json::parse(read_whole(progress_file(folder), longest));
    RunProgress progress{.stage = json.at("stage"),
                         .remark = json.at("remark"),
                         .fraction = std::clamp(json.at("fraction").get<double>(), 0.0, 1.0),
                         .seconds_left = {},
                         .host = json.at("host")};
    if (json.at("seconds_left").is_number()) progress.seconds_left = json.at("seconds_left").get<double>();
    return progress;
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace sandglass
