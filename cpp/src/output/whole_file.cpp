#include "output/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <system_error>

#include "der/output/io_error.hpp"

namespace der {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void throw_system_error(const std::string& action, const fs::path& file, int number) {
  throw IoError("cannot " + action + " '" + file.string() +
                "': " + std::generic_category().message(number));
}

/// Zero, or the number of the error.
int write_all(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    done += static_cast<std::size_t>(written);
  }
  return 0;
}

}  // namespace

fs::path temporary_name(const fs::path& file) {
  fs::path temporary = file;
  temporary += ".tmp";
  return temporary;
}

void write_atomically(const fs::path& file, const std::string& text) {
  const fs::path temporary = temporary_name(file);
  remove_file(temporary);
  // O_EXCL: nothing that came there meanwhile is written through, a link least of all.
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) throw_system_error("write", file, errno);
  int failure = write_all(descriptor, text);
  if (::close(descriptor) != 0 && failure == 0) failure = errno;
  if (failure != 0) {
    ::unlink(temporary.c_str());
    throw_system_error("write", file, failure);
  }
  publish(temporary, file);
}

void publish(const fs::path& temporary, const fs::path& file) {
  std::error_code error;
  fs::rename(temporary, file, error);
  if (error) throw_system_error("write", file, error.value());
}

void remove_file(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw_system_error("remove", file, error.value());
}

}  // namespace der
