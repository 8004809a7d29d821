#include <doctest/doctest.h>

#include "der/scenario/scenario.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using test::beam;
using test::contains;
using test::diagnostics;

TEST_CASE("overrides: by key, by name and by number") {
  const Scenario scene = beam({{"rods.beam.nodes", "21"}, {"rods.0.to.0", "2"}});
  CHECK(scene.scene().rods[0].points.size() == 21);
  CHECK(scene.scene().rods[0].points.back()[0] == 2.0);
}

TEST_CASE("overrides: add keys that the scene leaves to their defaults") {
  const Scenario scene = beam({{"solver.linear", "banded"},
                               {"output.probes.tip", "{rod: beam, at: end, quantity: y}"},
                               {"title", "'A: b'"}});
  CHECK(scene.scene().solver.linear == "banded");
  CHECK(scene.scene().output.probes.at(0).name == "tip");
  CHECK(scene.scene().title == "A: b");
}

TEST_CASE("overrides: an empty value removes") {
  const Scenario dynamic = beam({{"supports",
                                  "[{rod: beam, at: start, clamp: true}, {rod: beam, "
                                  "at: end, fix: [y]}]"}});
  const Scenario statics =
      dynamic.with({{"time", ""}, {"analysis", "static"}, {"supports.1", "null"}});
  CHECK(!statics.scene().is_dynamic());
  CHECK(statics.scene().supports.size() == 1);
  CHECK(dynamic.scene().supports.size() == 2);
}

TEST_CASE("overrides: what they make is validated, under its path") {
  CHECK(diagnostics({{"rods.beam.nodes", "1"}}) ==
        "beam: rods.beam.nodes: must be between 2 and 1000000, got '1'");
  CHECK(contains(diagnostics({{"tme.step", "1"}}), "did you mean 'time'?"));
  CHECK(contains(diagnostics({{"rods.beam.nods", "5"}}), "did you mean 'nodes'?"));
}

TEST_CASE("overrides: a path that leads nowhere says where it ends") {
  CHECK(diagnostics({{"rods.baem.nodes", "5"}}) ==
        "beam: rods.baem.nodes: 'rods' has no item 'baem'; did you mean 'beam'?");
  CHECK(
      contains(diagnostics({{"rods.arm.nodes", "5"}}), "'rods' has no item 'arm'; it has 'beam'"));
  CHECK(
      contains(diagnostics({{"rods.1.nodes", "5"}}), "'rods' has the items 0 to 0, but no item 1"));
  CHECK(contains(diagnostics({{"loads.0.gravity", "[0, 1]"}}), "the scene has no 'loads'"));
  CHECK(contains(diagnostics({{"rods.beam.nodes.x", "5"}}), "'rods.beam.nodes' is a single value"));
  CHECK(contains(diagnostics({{"suports", ""}}), "the scene has no 'suports'"));
  CHECK(contains(diagnostics({{"a..b", "1"}}), "joined by single dots"));
  CHECK(contains(diagnostics({{"", "1"}}), "joined by single dots"));
  CHECK(contains(diagnostics({{"title", "[1"}}), "the value '[1' cannot be read"));
}

TEST_CASE("overrides: all that lead nowhere are reported together") {
  const std::string said = diagnostics({{"rods.x.nodes", "5"}, {"loads.0", "1"}, {"title", "]"}});
  CHECK(contains(said, "rods.x.nodes"));
  CHECK(contains(said, "loads.0"));
  CHECK(contains(said, "title"));
}

}  // namespace
}  // namespace der
