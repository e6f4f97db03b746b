// What a sub-command is. Each file of this folder that is named after a command makes one; cli.cpp
// turns their descriptions into command-line flags.
//
// To add a command: a file with its make_..._command, a line below and a line in all_commands.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "base/document.h"
#include "base/params.h"
#include "base/progress.h"

namespace parian {

// A file or word by its place on the command line.
struct Positional {
  std::string name;  // "TABLE.h5"
  std::string help;
  std::string* target;
  bool optional = false;
};

// A flag that is not a parameter of an algorithm: files, and switches of the command itself.
struct Flag {
  std::string name;  // without "--"
  char letter = 0;   // short form, 0: none
  std::string value_name;
  std::string help;
  std::variant<bool*, std::string*, std::vector<std::string>*> target;  // a vector: repeatable
  bool required = false;
  bool alone = false;  // with it, nothing that is required is needed
};

// What every command gets from the common flags.
struct Context {
  Progress progress;
  bool quiet = false;
  std::string json;  // file for figures, "-": standard output, empty: none
};

struct CommandSpec {
  std::string name;
  std::string summary;
  std::string example;  // a whole command line
  std::vector<Positional> positionals;
  std::vector<Flag> flags;
  ParamList params;  // each becomes --name; a bool that is true by default becomes --no-name
  bool has_figures = false;  // takes --json
  // Does the work; throws Error. Owns what the targets above point into.
  std::function<void(const Context&)> run;
};

CommandSpec make_simulate_command();
CommandSpec make_capture_command();
CommandSpec make_import_command();
CommandSpec make_fit_command();
CommandSpec make_compress_command();
CommandSpec make_edit_command();
CommandSpec make_reconstruct_command();
CommandSpec make_compare_command();
CommandSpec make_relight_command();
CommandSpec make_precompute_command();
CommandSpec make_render_command();
CommandSpec make_info_command();
CommandSpec make_studio_command();
CommandSpec make_demo_command();

inline std::vector<CommandSpec> all_commands() {
  return {make_simulate_command(),    make_capture_command(),  make_import_command(),
          make_fit_command(),         make_compress_command(), make_edit_command(),
          make_reconstruct_command(), make_compare_command(),  make_relight_command(),
          make_precompute_command(),  make_render_command(),   make_info_command(),
          make_studio_command(),      make_demo_command()};
}

}  // namespace parian
