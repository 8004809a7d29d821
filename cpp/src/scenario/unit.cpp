#include "scenario/unit.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "der/core/constants.hpp"

namespace der::scenario {
namespace {

struct Symbol {
  std::string_view name;
  Unit unit;
  bool takes_prefix = true;
};

const std::array<Symbol, 12>& symbols() {
  // m, kg, s, rad; digits of the decimal point
  static const std::array<Symbol, 12> all{{
      {"m", {{1, 0, 0, 0}}},
      {"g", {{0, 1, 0, 0}, -3}},
      {"s", {{0, 0, 1, 0}}},
      {"rad", {{0, 0, 0, 1}}},
      {"N", {{1, 1, -2, 0}}},
      {"Pa", {{-1, 1, -2, 0}}},
      {"Hz", {{0, 0, -1, 0}}},
      {"min", {{0, 0, 1, 0}, 0, 60.0}, false},
      {"h", {{0, 0, 1, 0}, 0, 3600.0}, false},
      {"deg", {{0, 0, 0, 1}, 0, kPi, 180.0}, false},
      {"°", {{0, 0, 0, 1}, 0, kPi, 180.0}, false},
      {"turn", {{0, 0, 0, 1}, 0, 2.0 * kPi}, false},
  }};
  return all;
}

struct Prefix {
  std::string_view name;
  int decimals;
};
constexpr std::array<Prefix, 10> kPrefixes{{{"n", -9},
                                            {"u", -6},
                                            {"\u00b5", -6},
                                            {"\u03bc", -6},
                                            {"m", -3},
                                            {"c", -2},
                                            {"d", -1},
                                            {"k", 3},
                                            {"M", 6},
                                            {"G", 9}}};

bool starts_with(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

/// The unit of a name such as `mm`, `kPa` or `deg`; nothing if it is none.
std::optional<Unit> unit_of_name(std::string_view name) {
  for (const Symbol& symbol : symbols()) {
    if (symbol.name == name) return symbol.unit;
  }
  for (const Symbol& symbol : symbols()) {
    if (!symbol.takes_prefix || name.size() <= symbol.name.size()) continue;
    const std::string_view prefix = name.substr(0, name.size() - symbol.name.size());
    if (name.substr(prefix.size()) != symbol.name) continue;
    const auto* known = std::find_if(kPrefixes.begin(), kPrefixes.end(),
                                     [&](const Prefix& each) { return each.name == prefix; });
    if (known == kPrefixes.end()) continue;
    Unit unit = symbol.unit;
    unit.decimals += known->decimals;
    return unit;
  }
  return std::nullopt;
}

void multiply(Unit& product, const Unit& factor, int power) {
  for (std::size_t i = 0; i < product.powers.size(); ++i) {
    product.powers[i] += power * factor.powers[i];
  }
  product.decimals += power * factor.decimals;
  for (int i = 0; i < std::abs(power); ++i) {
    product.numerator *= power > 0 ? factor.numerator : factor.denominator;
    product.denominator *= power > 0 ? factor.denominator : factor.numerator;
  }
}

/// Reads a text from its start to its end.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : rest_(text) {}

  std::optional<Unit> read() {
    Unit unit;
    bool divided = false;
    // `1/s` and `/s`: nothing stands before the quotient.
    if (starts_with(rest_, "1/")) rest_.remove_prefix(1);
    if (!starts_with(rest_, "/") && !read_factor(unit, 1)) return std::nullopt;
    while (!rest_.empty()) {
      if (skip("/")) {
        divided = true;
        if (!read_factor(unit, -1)) return std::nullopt;
      } else if (divided || !(joined_ || skip_product()) || !read_factor(unit, 1)) {
        return std::nullopt;
      }
    }
    return unit;
  }

 private:
  bool skip(std::string_view sign) {
    if (!starts_with(rest_, sign)) return false;
    rest_.remove_prefix(sign.size());
    return true;
  }

  bool skip_product() { return skip(" ") || skip("*") || skip("\u00b7") || skip("\u22c5"); }

  /// A name and its power.
  bool read_factor(Unit& product, int sign) {
    std::size_t end = 0;
    while (end < rest_.size() && is_name_byte(end)) ++end;
    // `Nm^2` is a newton times a square metre, and needs no blank.
    const std::size_t newton = rest_.substr(0, end).find('N');
    joined_ = newton + 1 < end && newton != std::string_view::npos;
    if (joined_) end = newton + 1;
    const std::optional<Unit> unit = unit_of_name(rest_.substr(0, end));
    if (!unit) return false;
    rest_.remove_prefix(end);
    const std::optional<int> power = read_power();
    if (power) multiply(product, *unit, sign * *power);
    return power.has_value();
  }

  /// A byte of a name: a letter, or a part of one beyond ASCII that is no sign.
  [[nodiscard]] bool is_name_byte(std::size_t at) const {
    const char c = rest_[at];
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) return true;
    const std::string_view here = rest_.substr(at);
    return static_cast<unsigned char>(c) >= 0x80 && !starts_with(here, "\u00b2") &&
           !starts_with(here, "\u00b3") && !starts_with(here, "\u00b7") &&
           !starts_with(here, "\u22c5");
  }

  /// The power behind a name, 1 if there is none; nothing if it is not readable.
  std::optional<int> read_power() {
    if (skip("\u00b2")) return 2;
    if (skip("\u00b3")) return 3;
    const bool raised = skip("^");
    const int sign = raised && skip("-") ? -1 : 1;
    if (rest_.empty() || rest_.front() < '1' || rest_.front() > '9') {
      if (raised) return std::nullopt;
      return 1;
    }
    const int power = rest_.front() - '0';
    rest_.remove_prefix(1);
    return sign * power;
  }

  std::string_view rest_;
  bool joined_ = false;  // a factor follows the last one without a sign between them
};

}  // namespace

std::optional<Unit> read_unit(std::string_view text) { return UnitReader(text).read(); }

}  // namespace der::scenario
