#include <doctest/doctest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "der/scenario/document.hpp"
#include "der/scenario/scenario.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using scenario::Document;
using scenario::make_mapping;
using scenario::make_scalar;
using scenario::make_sequence;
using scenario::Value;
using test::contains;
using test::diagnostics;

bool same(const Value& a, const Value& b);

bool same(const scenario::Entry& a, const scenario::Entry& b) {
  return a.key == b.key && same(a.value, b.value);
}

template <class List>
bool same_items(const List& a, const List& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!same(a[i], b[i])) return false;
  }
  return true;
}

/// Equal but for the marks, and for a text's quotes.
bool same(const Value& a, const Value& b) {
  if (a.sequence() && b.sequence()) return same_items(*a.sequence(), *b.sequence());
  if (a.mapping() && b.mapping()) return same_items(*a.mapping(), *b.mapping());
  if (a.is_null() || b.is_null()) return a.is_null() && b.is_null();
  const auto text = [](const Value& value) {
    if (const auto* plain = std::get_if<scenario::Plain>(&value.content)) return plain->text;
    return std::get<std::string>(value.content);
  };
  // A number that has had a unit.
  if (const auto* number = std::get_if<double>(&a.content)) return std::stod(text(b)) == *number;
  return text(a) == text(b);
}

Value mapping(std::vector<std::pair<std::string, Value>> entries) {
  scenario::Mapping result;
  for (auto& [key, value] : entries) result.push_back({key, std::move(value), {}});
  return make_mapping(std::move(result));
}

TEST_CASE("documents: a scene built by hand is the scene of the text") {
  const Value root = mapping(
      {{"rods",
        make_sequence({mapping(
            {{"name", make_scalar("beam")},
             {"nodes", make_scalar(11)},
             {"from", make_sequence({make_scalar(0), make_scalar(0)})},
             {"to", make_sequence({make_scalar(1.0), make_scalar(0.0)})},
             {"cross_section", mapping({{"circle", mapping({{"radius", make_scalar(0.01)}})}})},
             {"material", mapping({{"youngs_modulus", make_scalar(1e9)},
                                   {"density", make_scalar(std::int64_t{1000})}})}})})},
       {"time", mapping({{"duration", make_scalar(1)}, {"step", make_scalar(0.01)}})},
       {"supports", make_sequence({mapping({{"rod", make_scalar("beam")},
                                            {"at", make_scalar("start")},
                                            {"clamp", make_scalar(true)}})})}});
  const Scenario scene = Scenario::from_document(std::make_shared<const Document>(Document(root)));
  CHECK(scene.source().empty());
  CHECK(scene.scene().rods[0].points == test::beam().scene().rods[0].points);
  CHECK(scene.scene().supports[0].clamps());
  const Scenario again = Scenario::parse(scene.to_yaml());
  CHECK(again.scene().rods[0].points == scene.scene().rods[0].points);
  CHECK(again.to_yaml() == scene.to_yaml());
}

TEST_CASE("documents: diagnostics about a dictionary have a path, but no line") {
  const Value root = mapping({{"rods", make_sequence({make_scalar(3)})},
                              {"time", mapping({{"duration", make_scalar("1")}})}});
  try {
    Scenario::from_document(std::make_shared<const Document>(Document(root)));
    FAIL("accepted");
  } catch (const SceneError& error) {
    const std::string text = error.what();
    CHECK(text.rfind("rods.0: expected a mapping", 0) == 0);
    CHECK(contains(text, "\ntime.duration: expected a number in s, got the text '1': remove"));
    CHECK(contains(text, "\ntime.step: a time needs either 'step' or 'tolerance'"));
  }
}

TEST_CASE("documents: aliases stand for what their anchors hold") {
  const Scenario scene = Scenario::parse(
      "rods:\n"
      "  - name: a\n"
      "    points: &shape [[0, 0], [1, 0]]\n"
      "    cross_section: &section {circle: {radius: &r 0.01}}\n"
      "    material: &steel {youngs_modulus: 2e11, density: 7800}\n"
      "  - {name: b, points: *shape, cross_section: {tube: {inner_radius: 0.001, outer_radius: "
      "*r}},"
      " material: *steel}\n" +
      test::kTime);
  CHECK(scene.scene().rods[1].points == scene.scene().rods[0].points);
  CHECK(std::get<scenario::Tube>(scene.scene().rods[1].cross_section).outer_radius == 0.01);
}

TEST_CASE("documents: aliases cannot fill the memory") {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) text += before + (k < 9 ? ", " : "]\n");
  }
  const auto said = diagnostics(text);
  REQUIRE(said.size() == 1);
  CHECK(contains(said[0].message, "the aliases of this scene stand for more than"));
}

TEST_CASE("documents: a long text behind many aliases counts for its length") {
  std::string text = "a: &a " + std::string(100'000, 'x') + "\nb: [";
  for (int i = 0; i < 1000; ++i) text += "*a, ";
  const auto said = diagnostics(text + "]\n");
  REQUIRE(said.size() == 1);
  CHECK(contains(said[0].message, "the aliases of this scene stand for more than"));
}

TEST_CASE("documents: deep nesting ends in an error, not in a crash") {
  const auto said = diagnostics("a: " + std::string(100'000, '['));
  REQUIRE(said.size() == 1);
  CHECK(contains(said[0].message, "values nested in more than 100 levels"));
  // By aliases, each of which is one level deeper than the one before.
  std::string text = "a0: &a0 [x]\n";
  for (int i = 1; i <= 100; ++i) {
    const std::string number = std::to_string(i);
    text += "a" + number + ": &a" + number + " [*a" + std::to_string(i - 1) + "]\n";
  }
  const auto aliased = diagnostics(text);
  REQUIRE(aliased.size() == 1);
  CHECK(aliased[0].line == 99);  // a98: the scene, 99 lists and x
  CHECK(contains(aliased[0].message, "values nested in more than 100 levels"));
}

TEST_CASE("documents: anchors inside anchors stand for what they hold") {
  const Scenario scene =
      Scenario::parse(test::kRod + "loads: &loads [&one {gravity: &g [0, -1]}]\n" +
                      "title: &t nested\n" + test::kTime);
  CHECK(scene.scene().title == "nested");
  const Document document =
      Document::parse("a: &a [&b [1, &c {k: 2}], *b]\nd: [*a, *c]\n&e e: *e\n", "text");
  CHECK(document.to_yaml() ==
        "a: [[1, {k: 2}], [1, {k: 2}]]\nd: [[[1, {k: 2}], [1, {k: 2}]], {k: 2}]\ne: e\n");
}

TEST_CASE("documents: what is quoted from a scene is one line without control characters") {
  const auto said = diagnostics("\"k\\e[31m\\n\\x9b\": 1\n" + test::kRod + test::kTime);
  REQUIRE(said.size() == 1);
  CHECK(contains(said[0].message, "has no key 'k\\x1b[31m\\n\\x9b'"));
  CHECK(said[0].path == "k\\x1b[31m\\n\\x9b");
  CHECK(contains(diagnostics({{"title", "\"\\e]0;x\""}}),
                 "the text holds the control character 0x1b"));
  CHECK(diagnostics({{"title", "\"two\\nlines\\tTr\u00e4ger\""}}).empty());
}

TEST_CASE("documents: quotes that are closed, and quotes that are not") {
  const auto syntax_error = [](const std::string& title) {
    const auto said = diagnostics("title: " + title + "\n" + test::kRod + test::kTime);
    return !said.empty() && contains(said[0].message, "not valid YAML");
  };
  for (const char* closed : {"'it''s'", "\"a \\\" b\"", "\"a\n  b\"", "&t 'x'", "it's", "5 \"",
                             "''", "|\n  a 'b\n  \"c", ">\n  'a"}) {
    CAPTURE(closed);
    CHECK_FALSE(syntax_error(closed));
  }
  for (const char* open : {"'it''s", "\"a \\\"", "&t 'x", "\"", "'"}) {
    CAPTURE(open);
    CHECK(syntax_error(open));
  }
}

TEST_CASE("documents: control characters are refused, a byte order mark is not") {
  CHECK(diagnostics("\xef\xbb\xbf" + test::kRod + test::kTime).empty());
  std::string text = test::kRod + "time: {duration: 1, step: 0.01}";
  text += '\x04';  // yaml-cpp takes it for the end of the file
  text += "\nnonsense: 1\n";
  const auto said = diagnostics(text);
  REQUIRE(said.size() == 1);
  CHECK(said[0].line == 8);
  CHECK(said[0].column == 32);
  CHECK(contains(said[0].message, "control character 0x04"));
}

TEST_CASE("documents: text that is not UTF-8 is refused where it stands") {
  const auto said_of = [](const std::string& title) {
    return diagnostics(test::kRod + test::kTime + "title: x" + title + "\n");
  };
  // The ends of each row of table 3-7 of the Unicode standard, and what lies just outside.
  for (const char* good : {"\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                           "\xef\xbf\xbd", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbd"}) {
    CAPTURE(good);
    for (const auto& diagnostic : said_of(good)) CHECK_FALSE(contains(diagnostic.message, "UTF-8"));
  }
  for (const char* bad :
       {"\x80", "\xc1\xbf", "\xc2", "\xc2x", "\xe0\x9f\xbf", "\xe2\x82", "\xed\xa0\x80",
        "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"}) {
    CAPTURE(bad);
    const auto said = said_of(bad);
    REQUIRE(said.size() == 1);
    CHECK(contains(said[0].message, "UTF-8"));
    CHECK(said[0].line == 9);
    CHECK(said[0].column == 9);
  }
}

TEST_CASE("documents: lines end as on any system") {
  std::string text;
  for (const char c : test::kRod + test::kTime)
    text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  CHECK(diagnostics(text).empty());
  const auto said = diagnostics(text + "x: 1\r\n");
  REQUIRE(said.size() == 1);
  CHECK(said[0].line == 9);
}

TEST_CASE("documents: scenes of configs survive a round trip") {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(DER_SOURCE_DIR "/configs")) {
    if (entry.path().extension() != ".yaml") continue;
    CAPTURE(entry.path().filename().string());
    ++scenes;
    const Scenario scene = Scenario::load(entry.path());
    const Scenario again = Scenario::parse(scene.to_yaml());
    CHECK(same(scene.document().root(), again.document().root()));
    CHECK(again.to_yaml() == scene.to_yaml());
  }
  CHECK(scenes >= 10);
}

TEST_CASE("documents: texts survive a round trip, whatever is in them") {
  for (const char* title :
       {"plain", "true",      "5",          "1e3",         "null",   "yes",  "a: b", "a, b", "'q'",
        "\"",    "tab\there", "two\nlines", "back\\slash", "Träger", " x ",  "",     "#",    "-",
        "{a}",   "*x",        "&x",         "!x",          "010",    ".inf", "0x1F", "~"}) {
    CAPTURE(title);
    const std::string yaml = scenario::to_flow_yaml(make_scalar(title));
    CAPTURE(yaml);
    CHECK(test::beam({{"title", yaml}}).scene().title == title);
    const Scenario scene = Scenario::parse(test::beam({{"title", yaml}}).to_yaml());
    CHECK(scene.scene().title == title);
  }
}

}  // namespace
}  // namespace der
