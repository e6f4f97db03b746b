// parian demo: the whole pipeline on bundled samples.
#include "app/report/demo.h"

#include <memory>

#include "app/cli/command.h"
#include "app/cli/output.h"

namespace parian {

CommandSpec make_demo_command() {
  const auto options = std::make_shared<DemoParams>();
  CommandSpec command;
  command.name = "demo";
  command.summary =
      "take bundled samples from table to fit to a picture of a shape, and show it on a page";
  command.example = "parian demo -o out/demo";
  command.flags = {
      {"output", 'o', "DIR", "folder for the page and its files", &options->folder},
      {"data", 0, "DIR", "folder with the bundled samples", &options->data},
      {"assets", 0, "DIR", "folder with fetched meshes and environments", &options->assets},
      {"small",
       0,
       {},
       "a small chessboard instead of the one at the paper's size, small pictures",
       &options->small}};
  command.run = [options](const Context& context) {
    DemoParams params = *options;
    if (params.data.empty()) params.data = find_data_folder();
    const std::string page = make_demo(params, context.progress);
    print_summary(context, "the demo's page: " + page + "\n");
  };
  return command;
}

}  // namespace parian
