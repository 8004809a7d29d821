#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace der::app {

bool is_terminal(std::FILE* stream);
/// Columns of the terminal behind a stream; 80 if that is not known.
int terminal_width(std::FILE* stream);

/// Colours for a stream: on a terminal only, and not where NO_COLOR is set (https://no-color.org)
/// or TERM is `dumb`.
class Style {
 public:
  static Style of(std::FILE* stream);
  static Style plain() { return Style(false); }

  [[nodiscard]] std::string bold(std::string_view text) const { return wrap("1", text); }
  [[nodiscard]] std::string dim(std::string_view text) const { return wrap("2", text); }
  [[nodiscard]] std::string good(std::string_view text) const { return wrap("32", text); }
  [[nodiscard]] std::string warning(std::string_view text) const { return wrap("33", text); }
  [[nodiscard]] std::string bad(std::string_view text) const { return wrap("1;31", text); }

 private:
  explicit Style(bool colours) : colours_(colours) {}
  [[nodiscard]] std::string wrap(std::string_view code, std::string_view text) const;
  bool colours_;
};

}  // namespace der::app
