#include "output/run_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "der/output/io_error.hpp"

namespace der {
namespace {

namespace fs = std::filesystem;

/// False if another one holds it. True too where there are no locks.
bool lock(int descriptor) {
  return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

/// A lock on a file that its owner has removed since it was opened holds nobody off.
bool is_still_there(int descriptor, const fs::path& file) {
  struct stat opened{};
  struct stat named{};
  return ::fstat(descriptor, &opened) == 0 && ::stat(file.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace

fs::path RunLock::file_in(const fs::path& folder) { return folder / "results.lock"; }

RunLock::RunLock(const fs::path& folder) : file_(file_in(folder)) {
  while (true) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      throw IoError("cannot create '" + file_.string() +
                    "': " + std::generic_category().message(errno));
    }
    if (!lock(descriptor_)) {
      ::close(descriptor_);
      throw IoError("another run is writing its results to '" + folder.string() +
                    "'; wait for it or name another folder");
    }
    if (is_still_there(descriptor_, file_)) return;
    ::close(descriptor_);
  }
}

RunLock::~RunLock() {
  ::unlink(file_.c_str());
  // Said aloud: a child made by fork may still have the file open.
  ::flock(descriptor_, LOCK_UN);
  ::close(descriptor_);
}

bool RunLock::is_held(const fs::path& folder) {
  const int descriptor = ::open(file_in(folder).c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool held = !lock(descriptor);
  ::close(descriptor);
  return held;
}

}  // namespace der
