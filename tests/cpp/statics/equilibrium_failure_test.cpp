// The table of failures: docs/statics.md lists these names.
#include "der/statics/equilibrium_failure.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

using namespace der;

TEST_CASE("each cause of a failed search has a name of the six, a message and advice") {
  const std::set<std::string> expected{"not_converged", "not_held", "unbounded",
                                       "collapsed",     "folded",   "too_fine"};
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(EquilibriumFailure::LostInRoundoff); ++i) {
    CAPTURE(i);
    const auto cause = static_cast<EquilibriumFailure>(i);
    names.insert(status_of(cause));
    const std::string message = message_of({cause, "the detail"});
    const std::string advice = advice_for(cause);
    CHECK_FALSE(message.empty());
    CHECK(message.back() != '.');
    REQUIRE_FALSE(advice.empty());
    CHECK((advice.back() == '.' || advice.back() == '?'));
  }
  CHECK(names == expected);
}

TEST_CASE("Newton's own message and the part that is not held are the message of their failure") {
  CHECK(message_of({EquilibriumFailure::NewtonFailed, "no descent"}) == "no descent");
  CHECK(message_of({EquilibriumFailure::NotHeld, "rod 'a'"}) == "rod 'a'");
}
