#include "commands.hpp"
#include "messages.hpp"

#include <rubato/core/error.hpp>
#include <rubato/core/version.hpp>
#include <rubato/io/schema.hpp>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

namespace {

std::string called(int argc, char** argv) {
  std::string line = "rubato";
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

/// `--only NAME ...` and `--set PARAM=VALUE ...` take every word that follows, a study among them: the one with a dot
/// or a slash, which the name of an analysis cannot hold, and without the equals sign of a setting.
void find_study(rubato::app::StudyOptions& options) {
  const auto take = [&](std::vector<std::string>& words, const auto& is_study) {
    const auto found = std::find_if(words.begin(), words.end(), is_study);
    if (!options.study.empty() || found == words.end()) return;
    options.study = *found;
    words.erase(found);
  };
  const auto is_path = [](const std::string& word) { return word.find_first_of("./") != std::string::npos; };
  take(options.only, is_path);
  take(options.set, [&](const std::string& word) { return is_path(word) && word.find('=') == std::string::npos; });
  if (options.study.empty()) throw rubato::InvalidInput("name the study file: rubato run STUDY.toml");
}

/// `error: ...` in the manner of the other messages, with the nearest option or subcommand.
std::string usage_message(const CLI::App* cli, const CLI::Error& fault) {
  const auto chosen = cli->get_subcommands();
  const CLI::App* command = chosen.empty() ? cli : chosen.front();
  const std::string help =
      fmt::format("\n`{} --help` says more\n", command == cli ? "rubato" : "rubato " + command->get_name());
  const auto extras = cli->remaining(true);
  if (extras.empty()) return fmt::format("error: {}{}", fault.what(), help);
  std::vector<std::string> known;
  if (command == cli)
    for (const CLI::App* other : cli->get_subcommands([](const CLI::App*) { return true; }))
      known.push_back(other->get_name());
  for (const CLI::Option* option : command->get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  return fmt::format("error: {} \"{}\" is unknown{}{}", command == cli ? "the subcommand or option" : "the argument",
                     extras.front(), rubato::suggestion(extras.front(), known), help);
}

/// What stdout holds back is written now, while it can still be said that it cannot. A reader that has gone (`| head`)
/// wanted no more.
int finish(int status) {
  if (std::fflush(stdout) == 0 || errno == EPIPE) return status;
  rubato::app::tell(fmt::format("error: the answer cannot be written to stdout: {}", std::strerror(errno)));
  return status == rubato::app::exit_done ? rubato::app::exit_failed : status;
}

/// Files that a run opens take the lowest numbers that are free: where a shell has closed stdout or stderr (`>&-`),
/// what is said would go into the results. The numbers are given to a device which refuses what they are for.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) == -1 && errno == EBADF)
      (void)!open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace rubato;
  occupy_standard_streams();
  CLI::App cli{
      "Rubato integrates structures with friction in time.\n\n"
      "  rubato example underplatform-damper     copies an example here\n"
      "  rubato run underplatform-damper/study.toml\n"};
  cli.name("rubato");
  cli.set_version_flag("--version", std::string("rubato ") + version);
  cli.require_subcommand(1);
  cli.failure_message(usage_message);

  app::RunOptions run_options;
  run_options.command = called(argc, argv);
  auto* run = cli.add_subcommand("run", "run a study: results.nc, CSV files and report.html");
  const auto study_options = [](CLI::App* command, app::StudyOptions& options) {
    command->add_option("study", options.study, "the study file (TOML), required");
    command->add_option("--only", options.only, "run only these analyses")->type_name("NAME");
    command->add_option("--set", options.set, "replace the values of parameters")->type_name("PARAM=VALUE");
  };
  study_options(run, run_options.study);
  run->add_option("-o,--output", run_options.folder, "folder of the results (default: results/ beside the study)")
      ->type_name("DIR");
  run->add_option("--jobs", run_options.jobs,
                  "run so many analyses at a time, and sweeps on so many threads (default: one analysis, on all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024).description(""));
  run->add_flag("--resume", run_options.resume, "go on where an interrupted sweep stopped");
  run->add_flag("--yes", run_options.yes, "run sweeps of more than a million points");
  run->add_flag("--vtk", run_options.vtk, "also write the motion of structures for ParaView: DIR/vtk/ANALYSIS.pvd");
  run->add_flag("-q,--quiet", run_options.quiet, "no progress; warnings and errors only");

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

  auto* laws = cli.add_subcommand("laws", "list sliders, stops and other laws, and which analysis takes which");

  std::string example_name, example_folder;
  auto* example = cli.add_subcommand("example", "list the examples, or copy one here");
  example->add_option("name", example_name, "an example");
  example->add_option("folder", example_folder, "where to copy it (default: a folder of its name)");

  app::CompareOptions compare_options;
  auto* compare = cli.add_subcommand(
      "compare",
      "two results side by side: the largest difference of each column (status 0: within --tolerance; 1: not)");
  compare->add_option("first", compare_options.first, "a folder of results (-o of `rubato run`)")->required();
  compare->add_option("second", compare_options.second, "another one")->required();
  compare
      ->add_option("--tolerance", compare_options.tolerance,
                   "of differences over the largest value of their column (default: 1e-6)")
      ->type_name("NUMBER")
      ->check(CLI::NonNegativeNumber.description(""));
  compare->add_flag("--all", compare_options.all, "tell every column, equal ones too");

  auto* schema = cli.add_subcommand("schema", "print the JSON schema of the study file, for editors");

  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& fault) {
    return cli.exit(fault) == 0 ? finish(app::exit_done) : app::exit_wrong;
  }
  try {
    if (*run) find_study(run_options.study);
    if (*check) find_study(check_options);
    if (*run) return finish(app::run(run_options));
    if (*check) return finish(app::check(check_options));
    if (*methods) {
      if (method.empty() && (csv || !method_parameters.empty()))
        throw InvalidInput("--csv and --set need the name of a method");
      return finish(method.empty() ? app::list_methods() : app::show_method(method, method_parameters, csv));
    }
    if (*laws) return finish(app::list_laws());
    if (*example)
      return finish(example_name.empty() ? app::list_examples() : app::copy_example(example_name, example_folder));
    if (*compare) return finish(app::compare(compare_options));
    if (*schema) fmt::print("{}", io::study_schema());
    return finish(app::exit_done);
  } catch (const InvalidInput& fault) {
    app::tell(fault.what());
    return app::exit_wrong;
  } catch (const std::bad_alloc&) {
    app::tell("error: memory ran out; observe fewer coordinates, or take a smaller model");
    return app::exit_failed;
  } catch (const std::exception& fault) {
    app::tell(fmt::format("error: {}", fault.what()));
    return app::exit_failed;
  }
}
