// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace sandglass {

/// Makes `path` hold `contents`. Written to a temporary beside it (`path` + ".partial"), flushed to the disk, then
/// renamed: after a kill or a full disk the old file stands as it was. Throws InputError where the folder cannot be
/// written, RunError for a full or failing disk.
void write_whole(const std::filesystem::path& path, std::string_view contents);

/// The same for a file that `write` makes itself at the temporary path it is given. `before_rename` is called when the
/// new file is safe on the disk and before it takes its place.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write,
                  const std::function<void()>& before_rename = {});

/// What has been written to the file is on the disk, not only in memory. Throws RunError.
void sync_file(const std::filesystem::path& path);

/// Throws what `errno` = `code` means for a file that is to be written: InputError where the user can choose another
/// place, RunError for a full or failing disk.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, int code);

/// The whole text of a regular file of at most `limit` bytes. Throws InputError.
std::string read_whole(const std::filesystem::path& path, std::size_t limit);

}  // namespace sandglass
