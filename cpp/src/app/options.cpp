#include "der/app/options.hpp"

#include <CLI/CLI.hpp>
#include <string>

#include "der/version.hpp"

namespace der::app {
namespace {

constexpr const char* kDescription =
    "Runs the scene of a YAML file and writes its results to a folder: summary.json, results.h5 "
    "and "
    "scene.yaml.";

/// `der run` starts this program under its own name.
std::string program_name(int argc, const char* const* argv) {
  return argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "der_run";
}

std::string examples(const std::string& program) {
  std::string text = "Examples:\n";
  for (const char* arguments : {"configs/cantilever.yaml",
                                "configs/cantilever.yaml --set rods.arm.nodes=101 --out runs/fine",
                                "configs/cantilever.yaml --check"}) {
    text += "  " + program + " " + arguments + "\n";
  }
  return text;
}

constexpr const char* kFooter =
    "\n"
    "DER_LOOPS=plain in the environment keeps the innermost loops to what every processor has, "
    "for\n"
    "the same bits on all of one kind; DER_LOOPS=avx2 refuses processors without AVX2.\n"
    "\n"
    "Exit codes: 0 completed, 1 mistake in the scene, 2 mistake on the command line or in "
    "DER_LOOPS,\n"
    "3 not converged or diverged, 4 file or folder not readable or writable,\n"
    "130 interrupted by Ctrl-C, 143 by SIGTERM (what has been computed is saved; see --resume).";

Override parse_override(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw CLI::ValidationError("--set", "'" + text +
                                            "' is not of the form path=value, as in "
                                            "rods.beam.nodes=101");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::filesystem::path default_folder(const std::filesystem::path& scene) {
  return std::filesystem::path("runs") / scene.stem();
}

/// An empty path would be taken for none.
std::string not_empty(const std::string& path) {
  return path.empty() ? "the name of the folder is empty; the folder you are in is ." : "";
}

}  // namespace

std::variant<Options, ExitCode> parse_options(int argc, const char* const* argv) {
  Options options;
  std::vector<std::string> settings;
  const std::string program = program_name(argc, argv);
  CLI::App app(kDescription, program);
  app.footer(examples(program) + kFooter);
  app.set_version_flag("--version", program + " " + version, "Print the version and exit");
  app.add_option("scene", options.scene, "Scene file (YAML)")->option_text("SCENE");
  app.add_option("--out", options.out, "Folder for the results; runs/<name of SCENE> if not given")
      ->option_text("DIR")
      ->check(not_empty);
  app.add_option("--set", settings, "Replace a value of the scene; can be given more than once")
      ->option_text("PATH=VALUE")
      ->allow_extra_args(false);
  auto* check = app.add_flag("--check", options.check, "Only check the scene and its model");
  check->option_text(" ");  // without the list of what it excludes
  app.add_flag("--resume", options.resume,
               "Go on with an interrupted run as if it had never stopped")
      ->excludes(check)
      ->option_text(" ");
  auto* quiet = app.add_flag("--quiet", options.quiet,
                             "No progress and no summary; errors are still printed");
  quiet->option_text(" ");
  app.add_flag("--verbose", options.verbose, "Say what was not tested, too, and why")
      ->excludes(quiet)
      ->option_text(" ");
  app.add_flag("--schema", options.schema,
               "Print the JSON Schema of scene files, for editors, and exit");
  try {
    app.parse(argc, argv);
    if (options.scene.empty() && !options.schema) throw CLI::RequiredError("SCENE");
    for (const std::string& setting : settings) {
      options.overrides.push_back(parse_override(setting));
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::Completed : ExitCode::Usage;
  }
  if (options.out.empty()) options.out = default_folder(options.scene);
  return options;
}

}  // namespace der::app
