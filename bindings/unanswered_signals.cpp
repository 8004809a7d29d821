#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <string_view>
#include <thread>

#include "bindings.hpp"

namespace der::python {
namespace {

/// Returns the next signal of a pipe that Python writes them to; 0 at its end.
int next_signal(int pipe) {
  unsigned char number = 0;
  while (true) {
    const ssize_t count = ::read(pipe, &number, 1);
    if (count == 1) return number;
    if (count == 0 || errno != EINTR) return 0;
  }
}

void end_process(int number) {
  using namespace std::string_view_literals;
  const auto text = number == SIGTERM ? "terminated\n"sv : "interrupted\n"sv;
  // It may be closed.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
  _exit(128 + number);
}

/// A thread of its own, without the lock of the interpreter, which a long computation may hold.
void watch(int pipe, double patience) {
  // Signals are to interrupt the main thread while it waits.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  std::thread([pipe, patience] {
    while (const int number = next_signal(pipe)) {
      if (number != SIGINT && number != SIGTERM) continue;
      std::this_thread::sleep_for(std::chrono::duration<double>(patience));
      end_process(number);
    }
  }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace

void bind_unanswered_signals(py::module_& module) {
  module.def("end_if_unanswered", &watch, py::arg("pipe"), py::arg("patience"),
             "End the process `patience` seconds after SIGINT or SIGTERM, if it is still there.\n"
             "\n"
             "The exit code is 130 or 143. `pipe` is the end to read of one whose other end\n"
             "`signal.set_wakeup_fd` has. It is for programs that take both as a wish to end.");
}

}  // namespace der::python
