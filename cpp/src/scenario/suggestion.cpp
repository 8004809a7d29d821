#include "scenario/suggestion.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <utility>

namespace der::scenario {
namespace {

/// Lower case, with one separator: a slip in these costs nothing.
std::string normalised(std::string_view word) {
  std::string result(word);
  for (char& c : result) {
    c = c == '-' || c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return result;
}

/// Damerau-Levenshtein distance in its optimal-string-alignment form: the least number of
/// insertions, deletions, substitutions and swaps of neighbours, no substring edited twice.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, substituted});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
  }
  return row[b.size()];
}

std::size_t allowed_distance(std::size_t length) {
  if (length <= 2) return 0;
  if (length <= 5) return 1;
  return length <= 8 ? 2 : 3;
}

/// `inner` for `inner_radius`, or `node_count` for `node`.
bool one_starts_the_other(std::string_view a, std::string_view b) {
  const std::size_t shared = std::min(a.size(), b.size());
  return shared >= 3 && a.substr(0, shared) == b.substr(0, shared);
}

/// Whether two names have a part in common, as `bending_moment` and `moment_1` have.
bool share_a_part(std::string_view a, std::string_view b) {
  constexpr std::size_t shortest = 4;
  const auto each_part = [](std::string_view name, auto&& is_it) {
    while (!name.empty()) {
      const std::size_t end = std::min(name.find('_'), name.size());
      if (end >= shortest && is_it(name.substr(0, end))) return true;
      name.remove_prefix(std::min(end + 1, name.size()));
    }
    return false;
  };
  return each_part(a, [&](std::string_view part) {
    return each_part(b, [&](std::string_view other) { return other == part; });
  });
}

/// What users call a quantity, and its names here.
struct Synonyms {
  std::string_view word;
  std::array<std::string_view, 4> names;
};
constexpr std::array<Synonyms, 40> kSynonyms{{
    {"velocity", {"speed", "vx", "vy", "vz"}},
    {"vel", {"speed", "vx", "vy", "vz"}},
    {"vel_x", {"vx"}},
    {"vel_y", {"vy"}},
    {"vel_z", {"vz"}},
    {"velocity_x", {"vx"}},
    {"velocity_y", {"vy"}},
    {"velocity_z", {"vz"}},
    {"x_velocity", {"vx"}},
    {"y_velocity", {"vy"}},
    {"z_velocity", {"vz"}},
    {"position", {"x", "y", "z"}},
    {"coordinate", {"x", "y", "z"}},
    {"displacement", {"x", "y", "z"}},
    {"u", {"x", "y", "z"}},
    {"deflection", {"y", "z"}},
    {"height", {"y", "z"}},
    {"sag", {"y", "z"}},
    {"position_x", {"x"}},
    {"position_y", {"y"}},
    {"position_z", {"z"}},
    {"x_position", {"x"}},
    {"y_position", {"y"}},
    {"z_position", {"z"}},
    {"tangent", {"tx", "ty", "tz", "slope"}},
    {"angle", {"slope", "turning_angle"}},
    {"theta", {"slope", "turning_angle"}},
    {"direction", {"slope", "tx", "ty", "tz"}},
    {"kappa", {"curvature"}},
    {"bending", {"curvature", "moment"}},
    {"torsion", {"twist", "torque"}},
    {"twisting_moment", {"torque"}},
    {"axial_force", {"tension"}},
    {"normal_force", {"tension"}},
    {"stress", {"tension", "moment"}},
    {"stretch", {"strain"}},
    {"elongation", {"strain"}},
    {"strain_energy", {"elastic_energy", "stretch_energy", "bend_energy"}},
    {"potential_energy", {"elastic_energy", "gravity_energy", "total_energy"}},
    {"energy", {"total_energy", "kinetic_energy", "elastic_energy"}},
}};

/// The names of what `given` is called elsewhere, as far as they are known here.
std::vector<std::string> named_elsewhere(std::string_view given,
                                         const std::vector<std::string>& known) {
  std::vector<std::string> found;
  for (const Synonyms& synonyms : kSynonyms) {
    if (synonyms.word != given) continue;
    for (const std::string_view name : synonyms.names) {
      if (std::find(known.begin(), known.end(), name) != known.end()) found.emplace_back(name);
    }
  }
  return found;
}

/// The known words with the fewest edits from `given`, if these are few.
std::vector<std::string> nearest(std::string_view given, const std::vector<std::string>& known) {
  std::vector<std::string> best;
  std::size_t best_distance = allowed_distance(given.size());
  for (const std::string& candidate : known) {
    if (given.size() > candidate.size() + best_distance) continue;  // as many insertions, or more
    const std::size_t distance = edit_distance(given, normalised(candidate));
    if (distance > best_distance) continue;
    if (distance < best_distance) best.clear();
    best.push_back(candidate);
    best_distance = distance;
  }
  return best;
}

template <class Is>
std::vector<std::string> those(const std::vector<std::string>& known, Is&& is_it) {
  std::vector<std::string> found;
  std::copy_if(known.begin(), known.end(), std::back_inserter(found), is_it);
  return found;
}

/// "; did you mean 'nodes'?" for the first few words; empty for none.
std::string question(std::vector<std::string> words) {
  constexpr std::size_t few = 4;
  if (words.empty()) return {};
  words.resize(std::min(words.size(), few));
  return "; did you mean " + listed(words, " or ") + "?";
}

}  // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  const std::string given = normalised(word);
  std::vector<std::string> words = named_elsewhere(given, known);
  if (words.empty()) words = nearest(given, known);
  if (words.empty()) {
    words = those(known, [&](const std::string& other) {
      return one_starts_the_other(given, normalised(other));
    });
  }
  return question(std::move(words));
}

std::string did_you_mean_part_of(std::string_view word, const std::vector<std::string>& known) {
  const std::string given = normalised(word);
  return question(those(
      known, [&](const std::string& other) { return share_a_part(given, normalised(other)); }));
}

std::string with_article(std::string_view noun) {
  const bool vowel = std::string_view("aeiou").find(noun.front()) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(noun);
}

std::string listed(const std::vector<std::string>& words, std::string_view last_vertex) {
  constexpr std::size_t shown = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(shown, words.size()); ++i) {
    if (i > 0) text += i + 1 == words.size() ? std::string(last_vertex) : std::string(", ");
    text += "'" + words[i] + "'";
  }
  return words.size() <= shown ? text : text + fmt::format(", ... ({} in all)", words.size());
}

}  // namespace der::scenario
