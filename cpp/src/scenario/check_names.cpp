#include <map>
#include <string>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

/// The names by which programs call parts of the scene, each with the part that has it.
class Names {
 public:
  explicit Names(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  template <class Item>
  void enter(const char* list, const std::vector<Item>& items) {
    for (int i = 0; i < static_cast<int>(items.size()); ++i) {
      const Item& item = items[static_cast<std::size_t>(i)];
      if (item.name.empty()) continue;
      const std::string here = fmt::format("{}.{}", list, i);
      const auto [first, is_new] = owners_.emplace(item.name, Owner{here, item.mark.line});
      if (is_new) continue;
      const auto& [owner, line] = first->second;
      diagnostics_.add({list, i, "name"},
                       fmt::format("'{}' is the name of {}{} already: a program could not tell "
                                   "them apart",
                                   item.name, owner,
                                   line > 0 ? fmt::format(" (line {})", line) : std::string()));
    }
  }

 private:
  struct Owner {
    std::string path;
    int line;
  };
  std::map<std::string, Owner> owners_;
  Diagnostics& diagnostics_;
};

}  // namespace

void check_names(CheckContext& context) {
  Names names(context.diagnostics);
  names.enter("joints", context.scene.joints);
  names.enter("springs", context.scene.springs);
  names.enter("supports", context.scene.supports);
  names.enter("loads", context.scene.loads);
  names.enter("actuation", context.scene.actuations);
}

}  // namespace der::scenario
