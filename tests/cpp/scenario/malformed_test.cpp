// Each file of tests/malformed says in its head what the reader has to say about it:
// `# expect: LINE: a part of the message`, once for each diagnostic.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "der/core/error.hpp"
#include "der/scenario/reader.hpp"

namespace der {
namespace {

struct Expectation {
  int line;
  std::string part;
};

std::vector<Expectation> expectations_in(const std::filesystem::path& file) {
  const std::string marker = "# expect: ";
  std::ifstream stream(file);
  std::vector<Expectation> expectations;
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(marker, 0) != 0) continue;
    const std::size_t colon = line.find(": ", marker.size());
    expectations.push_back(
        {std::stoi(line.substr(marker.size(), colon - marker.size())), line.substr(colon + 2)});
  }
  return expectations;
}

std::vector<Diagnostic> diagnostics_about(const std::filesystem::path& file) {
  try {
    Scenario::load(file);
  } catch (const SceneError& error) {
    return error.diagnostics();
  }
  return {};
}

bool is_met(const Expectation& expectation, const Diagnostic& diagnostic) {
  const std::string text = diagnostic.path + ": " + diagnostic.message;
  return diagnostic.line == expectation.line && text.find(expectation.part) != std::string::npos;
}

std::vector<std::filesystem::path> malformed_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(DER_SOURCE_DIR "/tests/malformed")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST_CASE("malformed scenes: each diagnostic has the right line and a helpful message") {
  const auto files = malformed_files();
  CHECK(files.size() >= 30);
  for (const auto& file : files) {
    CAPTURE(file.filename().string());
    std::vector<Expectation> expected = expectations_in(file);
    CHECK_FALSE(expected.empty());
    for (const Diagnostic& diagnostic : diagnostics_about(file)) {
      const auto met = std::find_if(expected.begin(), expected.end(),
                                    [&](const Expectation& e) { return is_met(e, diagnostic); });
      CHECK_MESSAGE(met != expected.end(), "not expected: ", diagnostic.line, ": ", diagnostic.path,
                    ": ", diagnostic.message);
      if (met != expected.end()) expected.erase(met);
    }
    for (const Expectation& missed : expected) {
      CHECK_MESSAGE(false, "not said: ", missed.line, ": ", missed.part);
    }
  }
}

TEST_CASE("malformed scenes: diagnostics come in the order of the text, with file and column") {
  const std::string file = DER_SOURCE_DIR "/tests/malformed/everything_at_once.yaml";
  try {
    Scenario::load(file);
    FAIL("a malformed scene was accepted");
  } catch (const SceneError& error) {
    CHECK(error.status() == "invalid_scene");
    const auto& found = error.diagnostics();
    CHECK(std::is_sorted(found.begin(), found.end(),
                         [](const auto& a, const auto& b) { return a.line < b.line; }));
    const std::string text = error.what();
    const std::string first = file + ":14:12: rods.beam.nodes: expected a whole number, got '010'";
    CHECK(text.substr(0, first.size()) == first);
    CHECK(std::count(text.begin(), text.end(), '\n') + 1 == static_cast<long>(found.size()));
  }
}

TEST_CASE("malformed scenes: a text with endless mistakes is read as far as the first hundred") {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "key" + std::to_string(i) + ": 1\n";
  try {
    Scenario::parse(text);
    FAIL("a malformed scene was accepted");
  } catch (const SceneError& error) {
    const auto& found = error.diagnostics();
    REQUIRE(found.size() == 101);
    CHECK(found[99].path == "key99");
    CHECK(found[100].message == "there is more wrong than that; mend these first");
  }
}

TEST_CASE("a file that cannot be read is named") {
  CHECK_THROWS_WITH_AS(Scenario::load("no/such/scene.yaml"),
                       "no/such/scene.yaml: cannot read the scene file: there is no such file",
                       SceneError);
  CHECK_THROWS_AS(Scenario::load(DER_SOURCE_DIR), UnreadableSceneError);
  CHECK_THROWS_WITH_AS(Scenario::load("/dev/zero"),
                       "/dev/zero: cannot read the scene file: it is longer than 256 MiB, which no "
                       "scene is",
                       UnreadableSceneError);
}

}  // namespace
}  // namespace der
