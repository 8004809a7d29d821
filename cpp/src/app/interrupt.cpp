#include "der/app/interrupt.hpp"

#include <unistd.h>

#include <csignal>

namespace der::app {
namespace {

// A signal handler can reach nothing but a global of this type.
volatile std::sig_atomic_t received = 0;

void remember(int signal) { received = signal; }

void remember_for_a_second(int signal) {
  received = signal;
  alarm(1);
}

// Only what a signal handler may call: no destructor runs, as if the process were killed.
void give_up(int /*alarm*/) { _exit(128 + received); }

void install(int signal, void (*handler)(int)) {
  struct sigaction action{};
  action.sa_handler = handler;
  // The second signal finds the default action. Without SA_RESTART a blocked write would fail.
  action.sa_flags = SA_RESTART | (handler == SIG_DFL ? 0 : static_cast<int>(SA_RESETHAND));
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard(Patience patience) {
  received = 0;
  const auto handler = patience == Patience::OneSecond ? remember_for_a_second : remember;
  install(SIGALRM, give_up);
  install(SIGINT, handler);
  install(SIGTERM, handler);
}

InterruptGuard::~InterruptGuard() {
  alarm(0);
  install(SIGALRM, SIG_DFL);
  install(SIGINT, SIG_DFL);
  install(SIGTERM, SIG_DFL);
}

int InterruptGuard::signal() { return received; }

}  // namespace der::app
