#pragma once

#include <filesystem>

namespace der {

/// The right to write into the folder of a run, held by one program at a time: a lock of the
/// operating system on the file results.lock, which ends with the process however that ends. It is
/// apart from HDF5's own locks, which many clusters turn off. Where the file system knows no locks
/// it holds nobody off; a run then sees at its end that its file was replaced.
class RunLock {
 public:
  /// Throws IoError if another run holds the lock or the lock file cannot be made.
  explicit RunLock(const std::filesystem::path& folder);
  /// Removes the lock file.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  static std::filesystem::path file_in(const std::filesystem::path& folder);
  /// True while a run writes into the folder.
  static bool is_held(const std::filesystem::path& folder);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace der
