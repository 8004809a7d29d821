#include "der/app/interrupt.hpp"

#include <csignal>

namespace der::app {
namespace {

// A signal handler can reach nothing but a global of this type.
volatile std::sig_atomic_t received = 0;

void remember(int signal) { received = signal; }

void install(int signal, void (*handler)(int)) {
  struct sigaction action{};
  action.sa_handler = handler;
  // The second signal finds the default action. Without SA_RESTART a blocked write would fail.
  action.sa_flags = SA_RESTART | (handler == SIG_DFL ? 0 : static_cast<int>(SA_RESETHAND));
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  received = 0;
  install(SIGINT, remember);
  install(SIGTERM, remember);
}

InterruptGuard::~InterruptGuard() {
  install(SIGINT, SIG_DFL);
  install(SIGTERM, SIG_DFL);
}

int InterruptGuard::signal() { return received; }

}  // namespace der::app
