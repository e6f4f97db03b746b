// parian demo: the whole pipeline on bundled samples.
#include "app/report/demo.h"

#include <memory>

#include "app/cli/command.h"
#include "app/cli/output.h"

namespace parian {
namespace {

struct DemoOptions {
  std::string output = "out/demo", data;
};

}  // namespace

CommandSpec make_demo_command() {
  const auto options = std::make_shared<DemoOptions>();
  CommandSpec command;
  command.name = "demo";
  command.summary = "take bundled samples from table to relit fit, and show it on a page";
  command.example = "parian demo -o out/demo";
  command.flags = {{"output", 'o', "DIR", "folder for the page and its files", &options->output},
                   {"data", 0, "DIR", "folder with the bundled samples", &options->data}};
  command.run = [options](const Context& context) {
    const std::string data = options->data.empty() ? find_data_folder() : options->data;
    const std::string page = make_demo(data, options->output, context.progress);
    print_summary(context, "the demo's page: " + page + "\n");
  };
  return command;
}

}  // namespace parian
