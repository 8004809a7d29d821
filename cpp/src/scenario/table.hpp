#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "scenario/format.hpp"

namespace der::scenario {

/// Checks the keys of a mapping against its table (unknown, duplicate, missing, excluding each
/// other) and has each known one read once, by its position in the table. False after diagnostics.
bool read_keys(const TableInfo& table, const Place& place, Diagnostics& diagnostics,
               const std::function<bool(int, const Place&)>& read);

template <class S, class = void>
struct HasMark : std::false_type {};
template <class S>
struct HasMark<S, std::void_t<decltype(std::declval<S&>().mark)>> : std::true_type {};

/// The keys of one mapping, each bound to a member of the struct that it is read into. The one
/// place where a key is declared: reading, checking, suggestions, JSON Schema and scene reference
/// all follow from it.
template <class S>
class Table {
 public:
  using Check = std::function<void(S&, const Place&, Diagnostics&)>;

  Table(std::string name, std::string doc) {
    info_.name = std::move(name);
    info_.doc = std::move(doc);
  }

  /// `Owner` is S or a base of it; a member of type std::optional<T> takes a Format<T>.
  template <class Owner, class Member, class T>
  Table& required(std::string key, Member Owner::* member, const Format<T>& format,
                  std::string doc) {
    return field({std::move(key), format.shape, true, {}, false, std::move(doc)}, format,
                 assign(member));
  }

  /// `default_words` says what holds without the key where that is not the member's own value.
  template <class Owner, class Member, class T>
  Table& optional(std::string key, Member Owner::* member, const Format<T>& format, std::string doc,
                  std::string default_words = {}) {
    FieldInfo info{std::move(key),           format.shape, false,
                   std::move(default_words), false,        std::move(doc)};
    if constexpr (std::is_same_v<Member, T>) {
      if (info.default_text.empty() && format.print) {
        info.default_text = format.print(S{}.*member);
        info.default_is_literal = !info.default_text.empty();
      }
    }
    return field(std::move(info), format, assign(member));
  }

  /// One kind of a mapping in which one key says which kind it is.
  template <class T, class Assign>
  Table& kind(std::string key, const Format<T>& format, Assign set, std::string doc) {
    info_.one_key = true;
    return field({std::move(key), format.shape, false, {}, false, std::move(doc), true}, format,
                 set);
  }

  /// Exactly one of the branches has to be given, with all its keys.
  Table& either(std::vector<std::vector<std::string>> branches) {
    info_.alternatives.push_back({std::move(branches), true});
    return *this;
  }
  /// At most one of the branches has to be given, with all its keys.
  Table& at_most_one(std::vector<std::vector<std::string>> branches) {
    info_.alternatives.push_back({std::move(branches), false});
    return *this;
  }
  /// Adds a check of several keys of one mapping; called only if each of them is valid.
  Table& check(Check check) {
    check_ = std::move(check);
    return *this;
  }
  /// Values take the unit of the key that the mapping stands under.
  Table& in_unit_of_the_key() {
    info_.unit_of_the_key = true;
    return *this;
  }

  [[nodiscard]] const TableInfo& info() const { return info_; }

  bool read(const Place& place, Diagnostics& diagnostics, S& out) const {
    const std::size_t before = diagnostics.size();
    if constexpr (HasMark<S>::value) out.mark = place.value->mark;
    const bool fine = read_keys(info_, place, diagnostics, [&](int field, const Place& value) {
      return readers_[static_cast<std::size_t>(field)](value, diagnostics, out);
    });
    if (fine && check_) check_(out, place, diagnostics);
    return diagnostics.size() == before;
  }

 private:
  template <class Member, class Owner>
  static auto assign(Member Owner::* member) {
    return [member](S& target, auto&& value) {
      target.*member = std::forward<decltype(value)>(value);
    };
  }

  template <class T, class Assign>
  Table& field(FieldInfo info, Format<T> format, Assign set) {
    info_.fields.push_back(std::move(info));
    readers_.push_back(
        [format = std::move(format), set](const Place& place, Diagnostics& diagnostics, S& out) {
          T value{};
          const bool fine = format.read(place, diagnostics, value);
          set(out, std::move(value));  // what could be read is still good for other checks
          return fine;
        });
    return *this;
  }

  TableInfo info_;
  std::vector<std::function<bool(const Place&, Diagnostics&, S&)>> readers_;
  Check check_;
};

/// A mapping with the keys of a table.
template <class S>
Format<S> mapping(Table<S> table) {
  const auto shared = std::make_shared<const Table<S>>(std::move(table));
  Shape shape{Shape::Kind::Table};
  shape.table = std::shared_ptr<const TableInfo>(shared, &shared->info());
  return {std::move(shape),
          [shared](const Shape& /*self*/, const Place& place, Diagnostics& diagnostics, S& out) {
            return shared->read(place, diagnostics, out);
          }};
}

}  // namespace der::scenario
