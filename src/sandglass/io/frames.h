// Stored trajectories, ours or others', read frame by frame in bounded memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sandglass/core/frame.h"
#include "sandglass/core/state.h"

namespace sandglass {

/// One frame as a file has it, in its own units and order. Empty vectors: the file does not say.
struct RawFrame {
  double time = 0;
  bool has_time = false;
  std::int64_t step = -1;  ///< -1: unknown
  double box_length = 0;   ///< of the square box
  bool unwrapped = false;  ///< coordinates run on across the border
  std::vector<double> x, y, vx, vy;
  std::vector<std::int64_t> image_x, image_y;
  std::vector<std::int64_t> id;
  std::vector<std::string> kind;  ///< names of the species
  std::vector<double> radius, mass;
};

/// Reads the next frame into its argument; false at the end. Throws InputError at what cannot be used. What it
/// allocates is bounded by the size of the file.
using RawFrames = std::function<bool(RawFrame&)>;

/// What a reader is told where a file is silent.
struct FrameOptions {
  std::vector<double> radii;  ///< by species in alphabetical order, in the length unit of the file
  double timestep = 1;        ///< time between steps (or frames), for files without times
};

/// A trajectory in units of the program: lengths in R_s, masses in m_s, time as in the file.
///
/// Species: two (or one), told apart by radius, else by name or type with the radii of the options. Masses that are not
/// given are as the areas. Disks are ordered by id, else as in the first frame. Positions are unwrapped by the image
/// counts or coordinates of the file, else by taking every disk to where its nearest image is since the frame before;
/// that is right as long as no disk goes half a box between two frames, which `largest_step` lets the caller judge.
class FrameReader {
 public:
  /// Recognises the format by the content: HDF5 (H5MD), LAMMPS text dump, else extended XYZ.
  FrameReader(const std::filesystem::path& path, const FrameOptions& options);

  /// The next frame, unwrapped; false at the end. collisions_per_disk is 0 where they are not counted.
  bool next(Frame& frame);

  [[nodiscard]] const State& disks() const { return disks_; }  ///< box, mixture and species; positions of frame 0
  [[nodiscard]] bool has_velocities() const { return has_velocities_; }
  [[nodiscard]] bool counts_collisions() const { return counts_collisions_; }
  [[nodiscard]] double largest_step() const { return largest_step_; }  ///< in boxes, if unwrapped by nearest image
  /// In how many frames so far all disks were so slow that sums of their squares lose digits.
  [[nodiscard]] std::uint64_t slow_frames() const { return slow_frames_; }
  /// What was assumed, in sentences.
  [[nodiscard]] const std::vector<std::string>& decisions() const { return decisions_; }

 private:
  void identify(const RawFrame& first);
  void set_species(const RawFrame& first);
  void unwrap(const RawFrame& raw, std::vector<double> RawFrame::*coordinate,
              std::vector<std::int64_t> RawFrame::*image, std::vector<double>& target);
  [[noreturn]] void refuse(const std::string& why) const;

  std::filesystem::path path_;
  FrameOptions options_;
  RawFrames source_;
  RawFrame raw_;
  bool pending_ = false;  ///< raw_ holds a frame not yet handed out
  std::uint64_t frames_ = 0, slow_frames_ = 0;
  double fastest_ = 0;  ///< the largest component of a velocity so far
  State disks_;
  double length_unit_ = 1;
  bool has_velocities_ = false, counts_collisions_ = false;
  double largest_step_ = 0;
  std::vector<std::int64_t> ids_;    ///< of the disks, in our order
  std::vector<std::size_t> places_;  ///< in the file, by our order
  std::vector<double> last_x_, last_y_;
  std::vector<std::string> decisions_;
};

/// Reads a trajectory to its end and forgets it. Throws InputError.
void read_all_frames(const std::filesystem::path& path, const FrameOptions& options);

/// The same in a process of its own (io/apart.h): what passes here can be given to a FrameReader. Throws InputError.
void try_all_frames(const std::filesystem::path& path, const FrameOptions& options);

}  // namespace sandglass
