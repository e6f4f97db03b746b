#include "app/cli/cli.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <deque>
#include <new>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/interrupt.h"
#include "app/cli/progress_bar.h"
#include "base/error.h"
#include "base/names.h"
#include "base/parallel.h"
#include "io/json/files.h"

namespace parian {
namespace {

[[noreturn]] void throw_usage(std::string place, std::string expected, std::string found) {
  throw Error({{}, std::move(place), std::move(expected), std::move(found)}, ErrorKind::usage);
}

// Flags that every command has.
struct CommonFlags {
  int threads = 0;
  Param threads_param{.name = "threads",
                      .help = "threads to use, 0 for one per processor",
                      .target = &threads,
                      .min = 0,
                      .max = 4096};
  bool quiet = false;
  bool portable = false;
  std::string json;
};

// CLI11 only splits the command line; values stay text until parse_value reads them, so that the
// messages are those of every other reader of parameters.
struct ParamText {
  const Param* param;
  CLI::Option* option = nullptr;
  std::string text;
  bool flipped = false;  // --no-name was given
};

bool is_negated(const Param& param) {
  const auto* boolean = std::get_if<bool*>(&param.target);
  return boolean && **boolean;
}

std::string describe_param(const Param& param) {
  std::vector<std::string> notes;
  if (!param.symbol.empty()) notes.push_back(param.symbol);
  if (!param.unit.empty()) notes.push_back("in " + param.unit);
  if (std::string range = format_range(param); !range.empty()) notes.push_back(std::move(range));
  if (!std::holds_alternative<bool*>(param.target)) {
    const std::string value = format_value(param);
    if (!value.empty()) notes.push_back("default " + value);
  }
  std::string text = is_negated(param) ? "turn off: " + param.help : param.help;
  for (std::size_t i = 0; i < notes.size(); ++i) text += (i == 0 ? " [" : "; ") + notes[i];
  return notes.empty() ? text : text + "]";
}

std::string value_name_of(const Param& param) {
  if (std::holds_alternative<std::vector<double>*>(param.target)) return "X,X,...";
  if (std::holds_alternative<ChoiceTarget>(param.target)) return "NAME";
  if (std::holds_alternative<std::string*>(param.target)) return "TEXT";
  return std::holds_alternative<double*>(param.target) ? "X" : "N";
}

void add_param(CLI::App& app, ParamText& entry, const char* group) {
  const Param& param = *entry.param;
  const std::string letter = param.letter ? fmt::format("-{},", param.letter) : std::string();
  const std::string name = letter + (is_negated(param) ? "--no-" : "--") + param.name;
  if (std::holds_alternative<bool*>(param.target)) {
    entry.option = app.add_flag(name, entry.flipped, describe_param(param));
  } else {
    entry.option = app.add_option(name, entry.text, describe_param(param));
    entry.option->type_name(value_name_of(param));
  }
  if (*group != 0) entry.option->group(group);
}

void add_flag(CLI::App& app, const Flag& flag) {
  const std::string name =
      (flag.letter ? fmt::format("-{},", flag.letter) : std::string()) + "--" + flag.name;
  if (const auto* boolean = std::get_if<bool*>(&flag.target)) {
    app.add_flag(name, **boolean, flag.help);
  } else if (const auto* text = std::get_if<std::string*>(&flag.target)) {
    const std::string preset =
        (*text)->empty() ? std::string() : fmt::format(" [default {}]", **text);
    app.add_option(name, **text, flag.help + preset)->type_name(flag.value_name);
  } else {
    auto& list = *std::get<std::vector<std::string>*>(flag.target);
    app.add_option(name, list, flag.help + " (may be repeated)")
        ->type_name(flag.value_name)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }
}

CLI::App* add_command(CLI::App& app, const CommandSpec& command, std::deque<ParamText>& texts,
                      CommonFlags& common) {
  CLI::App* sub = app.add_subcommand(command.name, command.summary);
  sub->allow_extras();
  sub->set_help_flag("-h,--help", "this text");
  sub->footer("example:\n  " + command.example);
  for (const Positional& positional : command.positionals)
    sub->add_option(positional.name, *positional.target, positional.help)->type_name("");
  for (const Flag& flag : command.flags) add_flag(*sub, flag);
  for (const Param& param : command.params)
    add_param(*sub, texts.emplace_back(ParamText{&param}), "Parameters");
  add_param(*sub, texts.emplace_back(ParamText{&common.threads_param}), "");
  sub->add_flag("--quiet", common.quiet, "print nothing but errors");
  sub->add_flag(
      "--portable", common.portable,
      "the same bits on every x86-64 machine (keeps the C library from fused operations)");
  if (command.has_figures)
    sub->add_option("--json", common.json, "write the figures as JSON; - for standard output")
        ->type_name("FILE");
  return sub;
}

std::string hint(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? "" : " (did you mean '" + nearest + "'?)";
}

// Words that no flag or place took: unknown flags first, as they also displace files.
void check_leftovers(const CLI::App& sub, const CommandSpec& command) {
  const std::vector<std::string> extras = sub.remaining();
  std::vector<std::string> known;
  for (const CLI::Option* option : sub.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (const std::string& extra : extras) {
    if (extra.size() < 2 || extra[0] != '-') continue;
    const std::string name = extra.substr(0, extra.find('='));
    throw_usage({}, "a flag of 'parian " + command.name + "'",
                "'" + name + "'" + hint(name, known));
  }
  if (!extras.empty())
    throw_usage({},
                fmt::format("{} file{} after '{}'", command.positionals.size(),
                            command.positionals.size() == 1 ? "" : "s", command.name),
                "'" + extras.front() + "' too");
  for (const Flag& flag : command.flags)
    if (flag.alone && sub.get_option("--" + flag.name)->count() > 0) return;
  for (const Positional& positional : command.positionals)
    if (!positional.optional && positional.target->empty())
      throw_usage({}, positional.name + " after '" + command.name + "'", "nothing");
  for (const Flag& flag : command.flags)
    if (flag.required && std::get<std::string*>(flag.target)->empty())
      throw_usage("--" + flag.name, flag.value_name, "nothing");
}

// Reads texts into their parameters and checks ranges; errors name the flag.
void read_param_texts(const std::deque<ParamText>& texts) {
  try {
    for (const ParamText& entry : texts) {
      if (entry.option->count() == 0) continue;
      if (auto* const* boolean = std::get_if<bool*>(&entry.param->target)) {
        **boolean = !**boolean;
      } else {
        parse_value(*entry.param, entry.text);
      }
    }
    for (const ParamText& entry : texts) check(ParamList{*entry.param});
  } catch (const Error& error) {
    ErrorParts parts = error.parts;
    parts.place = "--" + parts.place;
    throw Error(std::move(parts), ErrorKind::usage);
  }
}

// Before the work: figures must not take the place of a file that the command reads or writes.
void check_figures(const CommandSpec& command, const std::string& path) {
  if (path.empty() || path == "-") return;
  const auto check_apart = [&](const std::string& other) {
    if (is_same_file(path, other))
      throw_usage("--json", "a file of its own", "'" + other + "' again");
  };
  for (const Positional& positional : command.positionals) check_apart(*positional.target);
  for (const Flag& flag : command.flags)
    if (const auto* text = std::get_if<std::string*>(&flag.target)) check_apart(**text);
  check_writable(path);
}

void run_command(const CommandSpec& command, const CommonFlags& common) {
  check_figures(command, common.json);
  const ThreadLimit limit(common.threads);
  ProgressBar bar(!common.quiet);
  Context context;
  context.quiet = common.quiet;
  context.json = common.json;
  context.progress.report = [&](std::string_view stage, double done) { bar.show(stage, done); };
  context.progress.is_cancelled = was_interrupted;
  command.run(context);
}

const CommandSpec& find_command(const std::vector<CommandSpec>& commands, const std::string& name) {
  std::vector<std::string> names;
  for (const CommandSpec& command : commands) {
    if (command.name == name) return command;
    names.push_back(command.name);
  }
  throw_usage({}, "a command: " + list_names(names), "'" + name + "'" + hint(name, names));
}

int parse_and_run(int argc, const char* const* argv) {
  const std::vector<CommandSpec> commands = all_commands();
  CLI::App app("Translucent materials: from measured tables to fitted scattering profiles.",
               "parian");
  app.set_help_flag("-h,--help", "this text");
  app.set_version_flag("--version", PARIAN_VERSION);
  app.get_formatter()->column_width(32);
  CommonFlags common;
  std::deque<ParamText> texts;  // CLI11 keeps pointers into it
  const std::string name = argc > 1 ? argv[1] : "";
  const bool is_named = !name.empty() && name[0] != '-';
  const CommandSpec* chosen = is_named ? &find_command(commands, name) : nullptr;
  CLI::App* sub = nullptr;
  for (const CommandSpec& command : commands) {
    if (&command == chosen) {
      sub = add_command(app, command, texts, common);
    } else if (!chosen) {
      app.add_subcommand(command.name, command.summary);
    }
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    throw_usage({}, "flags as in 'parian " + (is_named ? name + " " : "") + "--help'",
                error.what());
  }
  if (!chosen) {
    std::fputs(app.help().c_str(), stderr);
    return 2;
  }
  check_leftovers(*sub, *chosen);
  read_param_texts(texts);
  run_command(*chosen, common);
  return 0;
}

int report_error(const char* text, int status) {
  fmt::print(stderr, "parian: error: {}\n", text);
  return status;
}

}  // namespace

int run_cli(int argc, const char* const* argv) {
  try {
    return parse_and_run(argc, argv);
  } catch (const Error& error) {
    return report_error(error.what(), error.kind == ErrorKind::usage ? 2 : 1);
  } catch (const std::bad_alloc&) {
    return report_error("expected more memory, found none left", 1);
  } catch (const std::exception& error) {
    return report_error(error.what(), 1);
  }
}

}  // namespace parian
