#include "commands.hpp"

#include <rubato/core/error.hpp>
#include <rubato/core/version.hpp>
#include <rubato/io/schema.hpp>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <new>

namespace {

std::string called(int argc, char** argv) {
  std::string line = "rubato";
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace rubato;
  CLI::App cli{
      "Rubato integrates structures with friction in time.\n\n"
      "  rubato example underplatform-damper     copies an example here\n"
      "  rubato run underplatform-damper/study.toml\n"};
  cli.name("rubato");
  cli.set_version_flag("--version", std::string("rubato ") + version);
  cli.require_subcommand(1);
  cli.failure_message(CLI::FailureMessage::simple);

  app::RunOptions run_options;
  run_options.command = called(argc, argv);
  auto* run = cli.add_subcommand("run", "run a study: results.nc, CSV files and report.html");
  const auto study_options = [](CLI::App* command, app::StudyOptions& options) {
    command->add_option("study", options.study, "the study file (TOML)")->required();
    command->add_option("--only", options.only, "run only these analyses");
    command->add_option("--set", options.set, "replace the value of a parameter: PARAM=VALUE")->allow_extra_args(false);
  };
  study_options(run, run_options.study);
  run->add_option("-o,--output", run_options.folder, "folder of the results (default: results/ beside the study)");
  run->add_flag("-q,--quiet", run_options.quiet, "no progress, no messages but errors");

  app::StudyOptions check_options;
  auto* check = cli.add_subcommand("check", "read and validate a study, and say what would run");
  study_options(check, check_options);

  std::string method;
  std::vector<std::string> method_parameters;
  bool csv = false;
  auto* methods = cli.add_subcommand("methods", "list the methods, or show one with its curves");
  methods->add_option("name", method, "a method");
  methods->add_option("--set", method_parameters, "a parameter of the method: PARAM=NUMBER")->allow_extra_args(false);
  methods->add_flag("--csv", csv, "the curves over omega h as CSV");

  std::string example_name, example_folder;
  auto* example = cli.add_subcommand("example", "list the examples, or copy one here");
  example->add_option("name", example_name, "an example");
  example->add_option("folder", example_folder, "where to copy it (default: a folder of its name)");

  auto* schema = cli.add_subcommand("schema", "print the JSON schema of the study file, for editors");

  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& fault) {
    return cli.exit(fault) == 0 ? app::exit_done : app::exit_wrong;
  }
  try {
    if (*run) return app::run(run_options);
    if (*check) return app::check(check_options);
    if (*methods) {
      if (method.empty() && (csv || !method_parameters.empty()))
        throw InvalidInput("--csv and --set need the name of a method");
      return method.empty() ? app::list_methods() : app::show_method(method, method_parameters, csv);
    }
    if (*example) return example_name.empty() ? app::list_examples() : app::copy_example(example_name, example_folder);
    if (*schema) fmt::print("{}", io::study_schema());
    return app::exit_done;
  } catch (const InvalidInput& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return app::exit_wrong;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: out of memory; observe fewer coordinates, or take a smaller model\n");
    return app::exit_failed;
  } catch (const std::exception& fault) {
    fmt::print(stderr, "error: {}\n", fault.what());
    return app::exit_failed;
  }
}
