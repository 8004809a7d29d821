#include "scenario/table.hpp"

#include <algorithm>

#include "der/core/printable.hpp"
#include "scenario/number.hpp"
#include "scenario/suggestion.hpp"

namespace der::scenario {
namespace {

/// Reads the entries of one mapping and remembers which keys were there.
class KeyReader {
 public:
  KeyReader(const TableInfo& table, const Place& place, Diagnostics& diagnostics)
      : table_(table), place_(place), diagnostics_(diagnostics), seen_(table.fields.size()) {}

  void read_entries(const std::function<bool(int, const Place&)>& read) {
    const Mapping& entries = *place_.value->mapping();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const Entry& entry = entries[i];
      const int field = table_.find(entry.key);
      if (field < 0) {
        report(entry, unknown_key(entry.key));
        continue;
      }
      const Entry*& first = seen_[static_cast<std::size_t>(field)];
      if (first) {
        report(entry,
               fmt::format("duplicate key '{}'{}", shortened(entry.key), line_of_first(*first)));
        continue;
      }
      first = &entry;
      if (entry.value.is_null()) {
        report(entry, fmt::format("'{}' has no value: give it one, or remove the key", entry.key));
        continue;
      }
      if (const std::size_t parts = parts_of_number(entries, i); parts > 1) {
        i += parts - 1;
        continue;
      }
      read(field, place_.at(entry));
    }
  }

  void check_required() {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (table_.fields[i].required && !seen_[i]) report_missing(table_.fields[i].key, {});
    }
  }

  void check_alternatives() {
    for (const Alternatives& alternatives : table_.alternatives) check(alternatives);
  }

  void check_one_key() {
    if (!table_.one_key) return;
    std::vector<std::string> given;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (table_.fields[i].is_kind && seen_[i]) given.push_back(table_.fields[i].key);
    }
    if (given.size() == 1) return;
    if (given.empty()) {
      diagnostics_.add(place_, fmt::format("{} needs one of the keys {}", noun(),
                                           listed(table_.kinds(), " or ")));
      return;
    }
    diagnostics_.add(place_,
                     fmt::format("{} has one key, which says what it is, but here are {}: {} (is "
                                 "a list dash '- ' missing, or the indentation wrong?)",
                                 noun(), given.size(), listed(given)));
  }

 private:
  /// Number of entries from one on that are one number, which is reported; 1: it is none. In
  /// brackets a comma ends a value, and of `{radius: 0,006}` the key `006` remains, without a
  /// value.
  std::size_t parts_of_number(const std::vector<Entry>& entries, std::size_t first) {
    const auto* written = std::get_if<Plain>(&entries[first].value.content);
    if (!written) return 1;
    std::size_t parts = 1;
    std::string number = written->text;
    std::string split;
    std::string problem;
    for (std::size_t i = first + 1; i < std::min(entries.size(), first + kMostParts); ++i) {
      if (!entries[i].value.is_null() || table_.find(entries[i].key) >= 0) break;
      number += "," + entries[i].key;
      if (std::string longer = separator_problem(number); !longer.empty()) {
        parts = i + 1 - first;
        split = number;
        problem = std::move(longer);
      }
    }
    if (parts > 1) {
      const std::string values = parts == 2 ? "two values, parted by a comma"
                                            : fmt::format("{} values, parted by commas", parts);
      report(entries[first], fmt::format("'{}' is {}: {}", split, values, problem));
    }
    return parts;
  }

  /// "a rod"
  [[nodiscard]] std::string noun() const { return with_article(table_.name); }

  void report(const Entry& entry, std::string message) {
    diagnostics_.add_key(place_, entry.key, entry.mark, std::move(message));
  }

  void report_missing(const std::string& key, const std::string& why) {
    diagnostics_.add_key(place_, key, place_.value->mark,
                         fmt::format("{} needs the key '{}'{}", noun(), key, why));
  }

  [[nodiscard]] std::string unknown_key(const std::string& key) const {
    const std::string message = fmt::format("{} has no key '{}'", noun(), shortened(key));
    if (const std::size_t colon = key.find(':'); colon != std::string::npos && colon > 0) {
      return fmt::format("{}; is a space missing after the colon?", message);
    }
    if (std::string near = did_you_mean(key, table_.keys()); !near.empty()) return message + near;
    if (looks_like_number(key)) return message + "; is a list missing its brackets?";
    if (const std::string owner = owner_of(key); !owner.empty()) {
      return fmt::format("{}; it belongs under '{}' (indent it further)", message, owner);
    }
    if (std::string near = did_you_mean_part_of(key, table_.keys()); !near.empty()) {
      return message + near;
    }
    return fmt::format("{}; its keys are {}", message, listed(table_.keys()));
  }

  /// The key whose own mapping knows `key`, if that is the only one that could be meant.
  [[nodiscard]] std::string owner_of(const std::string& key) const {
    std::string owner;
    for (const FieldInfo& field : table_.fields) {
      if (!field.shape.table || field.shape.table->find(key) < 0) continue;
      const bool present = find_entry(*place_.value->mapping(), field.key) != nullptr;
      if (present || (!table_.one_key && owner.empty())) owner = field.key;
    }
    return owner;
  }

  static std::string line_of_first(const Entry& first) {
    return first.mark.line > 0 ? fmt::format(" (first in line {})", first.mark.line)
                               : std::string();
  }

  [[nodiscard]] const Entry* seen(const std::string& key) const {
    return seen_[static_cast<std::size_t>(table_.find(key))];
  }

  static std::string described(const Alternatives& alternatives) {
    return "either " + alternatives.described([](const auto& branch) { return listed(branch); });
  }

  void check(const Alternatives& alternatives) {
    using Branch = std::vector<std::string>;
    const auto has = [](const Branch& branch, const std::string& key) {
      return std::find(branch.begin(), branch.end(), key) != branch.end();
    };
    const auto without = [&](const Branch& branch, const Branch& other) {
      Branch rest;
      for (const std::string& key : branch) {
        if (!has(other, key)) rest.push_back(key);
      }
      return rest;
    };
    Branch given;
    for (const Branch& branch : alternatives.branches) {
      for (const std::string& key : branch) {
        if (seen(key) && !has(given, key)) given.push_back(key);
      }
    }
    // The first branch with all that is given; branches may share keys.
    const Branch* chosen = nullptr;
    for (const Branch& branch : alternatives.branches) {
      if (!given.empty() && without(given, branch).empty()) {
        chosen = &branch;
        break;
      }
    }
    if (!chosen && !given.empty()) {
      const auto& branches = alternatives.branches;
      // The one with the most keys among those that have the first.
      const Branch* first = nullptr;
      for (const Branch& branch : branches) {
        const auto beyond = [&](const Branch& each) { return without(given, each).size(); };
        if (has(branch, given.front()) && (!first || beyond(branch) < beyond(*first))) {
          first = &branch;
        }
      }
      const std::string key = without(given, *first).front();
      const Branch& other = *std::find_if(branches.begin(), branches.end(),
                                          [&](const Branch& branch) { return has(branch, key); });
      const Branch excluding = without(other, *first);
      report(*seen(key), fmt::format("{} exclude{} {}: give {}", listed(excluding),
                                     excluding.size() == 1 ? "s" : "",
                                     listed(without(*first, other)), described(alternatives)));
      return;
    }
    if (chosen) {
      for (const std::string& key : *chosen) {
        if (!seen(key)) report_missing(key, ", as " + listed(*chosen) + " go together");
      }
    } else if (alternatives.required) {
      diagnostics_.add_key(place_, alternatives.branches.front().front(), place_.value->mark,
                           fmt::format("{} needs {}", noun(), described(alternatives)));
    }
  }

  const TableInfo& table_;
  const Place& place_;
  Diagnostics& diagnostics_;
  std::vector<const Entry*> seen_;  // by field
};

}  // namespace

bool read_keys(const TableInfo& table, const Place& place, Diagnostics& diagnostics,
               const std::function<bool(int, const Place&)>& read) {
  const std::size_t before = diagnostics.size();
  if (!place.value->mapping()) {
    report_expected(expected_mapping(table), place, diagnostics);
    return false;
  }
  KeyReader reader(table, place, diagnostics);
  reader.read_entries(read);
  reader.check_required();
  reader.check_alternatives();
  if (diagnostics.size() == before) reader.check_one_key();
  return diagnostics.size() == before;
}

}  // namespace der::scenario
