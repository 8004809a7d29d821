// The only file that knows yaml-cpp.

#include <fmt/core.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <istream>
#include <optional>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "der/core/error.hpp"
#include "der/scenario/document.hpp"
#include "scenario/utf8.hpp"

namespace der::scenario {
namespace {

/// Aliases are copied out; this many values stop a text that nests them to fill the memory.
constexpr std::size_t kMaxAliasedValues = 1'000'000;
/// A text of this many characters takes as much memory as a value.
constexpr std::size_t kTextOfAValue = 64;
/// Far beyond a rod of a million nodes drawn as a polyline, and less than any memory.
constexpr std::size_t kMaxFileSize = std::size_t{256} << 20;  // [bytes]

Mark mark_of(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

/// A syntax error, before it is known which source it is in.
struct SyntaxError {
  Mark mark;
  std::string message;
};

/// Builds the tree from the parser's events. Until the text has ended, values stand in one list and
/// hold the numbers of their parts: so an anchor and its aliases are the same number, and no text
/// takes more memory than its length, however it nests them.
class TreeBuilder : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_ > 0) {
      throw SyntaxError{mark_of(mark),
                        "a second YAML document starts here, but a scene is one document (is there "
                        "a '---' too many, or a line at the wrong indentation?)"};
    }
    ++documents_;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add_scalar({std::monostate{}, mark_of(mark)}, 1, anchor);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    const bool quoted = tag == "!";
    if (!quoted) refuse_tag(mark, tag);
    if (quoted) last_quoted_ = mark_of(mark);
    add_scalar(quoted ? Value{text, mark_of(mark)} : Value{Plain{text}, mark_of(mark)},
               1 + text.size() / kTextOfAValue, anchor);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = anchors_.find(anchor);
    if (known == anchors_.end()) {
      throw SyntaxError{mark_of(mark), "an alias inside the value that it stands for"};
    }
    const Node& node = nodes_[known->second];
    refuse_depth(mark, stack_.size() + node.depth);
    aliased_values_ += node.size;
    if (aliased_values_ > kMaxAliasedValues) {
      throw SyntaxError{mark_of(mark), fmt::format("the aliases of this scene stand for more than "
                                                   "{} values",
                                                   kMaxAliasedValues)};
    }
    add(known->second, YAML::NullAnchor);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override {
    refuse_tag(mark, tag);
    open(mark, Sequence{}, anchor, style);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override {
    refuse_tag(mark, tag);
    open(mark, Mapping{}, anchor, style);
  }
  void OnMapEnd() override { close(); }

  [[nodiscard]] Value root() const {
    return documents_ == 0 ? Value{std::monostate{}, {1, 1}} : copied_out(root_);
  }
  [[nodiscard]] const std::optional<Mark>& last_quoted() const { return last_quoted_; }
  /// Where the innermost bracket that is still open stands.
  [[nodiscard]] std::optional<Mark> open_bracket() const {
    if (stack_.empty() || !stack_.back().in_brackets) return std::nullopt;
    return nodes_[stack_.back().node].value.mark;
  }

 private:
  /// An item of a list, or the value of a key.
  struct Part {
    std::size_t node;
    std::string key;
    Mark key_mark;
  };
  struct Node {
    Value value;  // without its parts
    std::vector<Part> parts;
    std::size_t size;   // values in it, aliases copied out
    std::size_t depth;  // levels in it, itself included
  };
  /// A list or mapping whose end has not come yet.
  struct Frame {
    std::size_t node;
    YAML::anchor_t anchor;
    bool in_brackets;
    std::optional<std::string> key;  // read, its value not yet
    Mark key_mark;
  };

  static void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (tag != "?") {
      throw SyntaxError{mark_of(mark),
                        "YAML tags (such as '!!float') are not read: remove the tag"};
    }
  }

  static void refuse_depth(const YAML::Mark& mark, std::size_t depth) {
    if (depth > kMaxDepth) {
      throw SyntaxError{mark_of(mark),
                        fmt::format("values nested in more than {} levels: no scene needs that (is "
                                    "a closing bracket missing?)",
                                    kMaxDepth)};
    }
  }

  void add_scalar(Value value, std::size_t size, YAML::anchor_t anchor) {
    nodes_.push_back({std::move(value), {}, size, 1});
    add(nodes_.size() - 1, anchor);
  }

  template <class Content>
  void open(const YAML::Mark& mark, Content content, YAML::anchor_t anchor,
            YAML::EmitterStyle::value style) {
    refuse_depth(mark, stack_.size() + 1);
    nodes_.push_back({{std::move(content), mark_of(mark)}, {}, 1, 1});
    stack_.push_back(
        {nodes_.size() - 1, anchor, style == YAML::EmitterStyle::Flow, std::nullopt, {}});
  }

  void close() {
    const Frame frame = std::move(stack_.back());
    stack_.pop_back();
    add(frame.node, frame.anchor);
  }

  void add(std::size_t node, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) anchors_[anchor] = node;
    if (stack_.empty()) {
      root_ = node;
      return;
    }
    Frame& frame = stack_.back();
    const bool is_list = nodes_[frame.node].value.sequence() != nullptr;
    if (!is_list && !frame.key) {
      take_key(frame, nodes_[node].value);
      return;
    }
    Node& parent = nodes_[frame.node];
    parent.parts.push_back({node, std::move(frame.key).value_or(std::string()), frame.key_mark});
    parent.size += nodes_[node].size;
    parent.depth = std::max(parent.depth, 1 + nodes_[node].depth);
    frame.key.reset();
  }

  static void take_key(Frame& frame, const Value& value) {
    frame.key_mark = value.mark;
    if (const auto* plain = std::get_if<Plain>(&value.content)) {
      if (plain->text == "<<") {
        throw SyntaxError{value.mark,
                          "merge keys ('<<') are not read: repeat the keys, or give the whole "
                          "value an anchor (&name) and write *name where it is needed again"};
      }
      frame.key = plain->text;
    } else if (const auto* text = std::get_if<std::string>(&value.content)) {
      frame.key = *text;
    } else {
      throw SyntaxError{value.mark, "a key has to be a plain word"};
    }
  }

  /// A value with all its parts.
  [[nodiscard]] Value copied_out(std::size_t number) const {
    const Node& node = nodes_[number];
    Value value = node.value;
    if (auto* items = std::get_if<Sequence>(&value.content)) {
      items->reserve(node.parts.size());
      for (const Part& part : node.parts) items->push_back(copied_out(part.node));
    } else if (auto* entries = std::get_if<Mapping>(&value.content)) {
      entries->reserve(node.parts.size());
      for (const Part& part : node.parts) {
        Entry& entry = entries->emplace_back(Entry{part.key, copied_out(part.node), part.key_mark});
        // The parser marks a missing value where the next thing stands, maybe lines below.
        if (entry.value.is_null()) entry.value.mark = part.key_mark;
      }
    }
    return value;
  }

  std::vector<Node> nodes_;
  std::size_t root_ = 0;
  std::vector<Frame> stack_;
  std::unordered_map<YAML::anchor_t, std::size_t> anchors_;
  std::size_t aliased_values_ = 0;
  int documents_ = 0;
  std::optional<Mark> last_quoted_;
};

std::string_view line_at(std::string_view text, int line) {
  for (int i = 1; i < line && !text.empty(); ++i) {
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  return text.substr(0, text.find('\n'));
}

bool indented_by_tab(std::string_view line) {
  const std::string_view indentation = line.substr(0, line.find_first_not_of(" \t"));
  return indentation.find('\t') != std::string_view::npos;
}

/// yaml-cpp ends a quoted scalar at the end of the text without a word.
bool is_closed(std::string_view text, const Mark& mark) {
  const std::string_view line = line_at(text, mark.line);
  text.remove_prefix(static_cast<std::size_t>(line.data() - text.data()) +
                     static_cast<std::size_t>(mark.column - 1));
  text.remove_prefix(std::min(text.find_first_of("\"'|>"), text.size()));  // past an anchor
  if (text.empty() || text.front() == '|' || text.front() == '>') return true;
  const char quote = text.front();
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == quote) {
      if (quote == '"' || i + 1 >= text.size() || text[i + 1] != quote) return true;
      ++i;
    }
  }
  return false;
}

std::string explain(const std::string& problem) {
  struct Explanation {
    std::string_view problem;
    std::string_view meaning;
  };
  static constexpr std::array<Explanation, 8> explanations{{
      {"illegal map value",
       "a ':' where no key can stand: check the indentation of this line and the one above, and "
       "put a text that holds ': ' in quotes"},
      {"end of map not found",
       "this does not continue the mapping above: check the indentation, and that each key has "
       "its ':'"},
      {"end of sequence not found",
       "this does not continue the list above: check the indentation, and that each item has its "
       "'- '"},
      {"illegal flow end", "a closing bracket without its opening one"},
      {"illegal block entry", "a list item '- ' cannot stand here: put it on a line of its own"},
      {"the referenced anchor is not defined", "an alias (*name) without its anchor (&name)"},
      {"unknown token", "no value can start with this character: put the text in quotes"},
      {"illegal tab when looking for indentation",
       "a tab indents this line; YAML is indented by spaces"},
  }};
  const auto* known =
      std::find_if(explanations.begin(), explanations.end(),
                   [&](const Explanation& candidate) { return candidate.problem == problem; });
  const std::string meaning(known == explanations.end() ? problem : known->meaning);
  return "not valid YAML: " + meaning;
}

SyntaxError explain(const YAML::Exception& error, const TreeBuilder& builder,
                    std::string_view text) {
  const Mark mark = mark_of(error.mark);
  if (indented_by_tab(line_at(text, mark.line))) {
    return {mark, "not valid YAML: a tab indents this line; YAML is indented by spaces"};
  }
  const bool in_brackets = error.msg.find("flow not found") != std::string::npos;
  if (const std::optional<Mark> bracket = builder.open_bracket(); in_brackets && bracket) {
    return {*bracket,
            fmt::format("not valid YAML: this bracket is not closed (noticed in line {}); "
                        "is a bracket or a comma missing?",
                        mark.line)};
  }
  return {mark, explain(error.msg)};
}

/// Control characters have no place in a scene; some end the text for yaml-cpp, silently.
void refuse_control_characters(std::string_view text) {
  Mark mark{1, 1};
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '\n') {
      mark = {mark.line + 1, 1};
      continue;
    }
    if ((code < 0x20 && c != '\t' && c != '\r') || code == 0x7f) {
      throw SyntaxError{mark, fmt::format("control character 0x{:02x}: a scene is plain text in "
                                          "UTF-8",
                                          code)};
    }
    ++mark.column;
  }
}

void refuse_other_encodings(std::string_view text) {
  const std::size_t place = first_not_utf8(text);
  if (place == text.size()) return;
  const std::string_view before = text.substr(0, place);
  const auto lines = std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  throw SyntaxError{{static_cast<int>(lines) + 1, static_cast<int>(place - line_start) + 1},
                    fmt::format("the byte 0x{:02x} is not UTF-8: save the file in UTF-8",
                                static_cast<unsigned char>(text[place]))};
}

Value parse_tree(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text.substr(0, byte_order_mark.size()) == byte_order_mark) {
    text.remove_prefix(byte_order_mark.size());
  }
  refuse_control_characters(text);
  refuse_other_encodings(text);
  TreeBuilder builder;
  const auto refuse_open_quote = [&] {
    if (builder.last_quoted() && !is_closed(text, *builder.last_quoted())) {
      throw SyntaxError{*builder.last_quoted(), "not valid YAML: this quoted text is never closed"};
    }
  };
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    refuse_open_quote();
    throw explain(error, builder, text);
  }
  refuse_open_quote();
  return builder.root();
}

[[noreturn]] void refuse_file(const std::string& file, const std::string& reason) {
  throw UnreadableSceneError(file, "cannot read the scene file: " + reason);
}

/// All of a stream; a device that never ends, such as /dev/zero, is none.
std::string text_of(std::istream& stream, const std::string& file) {
  constexpr std::size_t piece = std::size_t{1} << 16;
  std::string text;
  std::size_t read = 0;
  do {
    text.resize(read + piece);
    stream.read(text.data() + read, piece);
    read += static_cast<std::size_t>(stream.gcount());
    if (read > kMaxFileSize) {
      refuse_file(file,
                  fmt::format("it is longer than {} MiB, which no scene is", kMaxFileSize >> 20));
    }
  } while (stream);
  text.resize(read);
  return text;
}

}  // namespace

Document Document::parse(std::string_view text, const std::string& source) {
  try {
    return Document(parse_tree(text), source);
  } catch (const SyntaxError& error) {
    throw SceneError(source, {{error.mark.line, error.mark.column, "", error.message}});
  }
}

Document Document::load(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) refuse_file(file.string(), "there is no such file");
  if (std::filesystem::is_directory(status)) refuse_file(file.string(), "it is a folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse_file(file.string(), "it could not be opened (is reading it allowed?)");
  const std::string text = text_of(stream, file.string());
  if (stream.bad()) refuse_file(file.string(), "reading it failed");
  return parse(text, file.string());
}

}  // namespace der::scenario
