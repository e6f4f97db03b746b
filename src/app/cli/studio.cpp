// parian studio: the desktop editor.
#include <memory>

#include "app/cli/command.h"
#include "app/report/demo.h"
#include "app/studio/run_studio.h"

namespace parian {

CommandSpec make_studio_command() {
  struct Arguments {
    StudioOptions studio;
    std::string file, second;
  };
  const auto arguments = std::make_shared<Arguments>();
  CommandSpec command;
  command.name = "studio";
  command.summary = "edit materials in a window: scribble, paint, compress, and see it on a mesh";
  command.example = "parian studio data/stone-72x64.h5 dragon.ply";
  command.positionals = {
      {"FILE", "table, map, blend, mesh, recipe, scene or environment", &arguments->file,
       /*optional=*/true},
      {"FILE2", "another one", &arguments->second, /*optional=*/true}};
  command.flags = {
      {"data", 0, "DIR", "folder with the bundled samples", &arguments->studio.data_folder},
      {"state", 0, "DIR", "folder for recent files and autosave", &arguments->studio.state_folder},
      {"screenshots", 0, "DIR", "folder for screenshots", &arguments->studio.screenshots},
      {"probe", 0, "FILE", "JSON file for scripted runs: state and places of widgets",
       &arguments->studio.probe}};
  command.params = {{.name = "width",
                     .help = "of the window",
                     .target = &arguments->studio.width,
                     .min = 1,
                     .max = 16384,
                     .unit = "pixels"},
                    {.name = "height",
                     .help = "of the window",
                     .target = &arguments->studio.height,
                     .min = 1,
                     .max = 16384,
                     .unit = "pixels"},
                    {.name = "scale",
                     .help = "of text and widgets; 0: the display's",
                     .target = &arguments->studio.scale,
                     .min = 0,
                     .max = 4}};
  command.run = [arguments](const Context& context) {
    StudioOptions options = arguments->studio;
    options.is_cancelled = context.progress.is_cancelled;
    if (options.data_folder.empty()) options.data_folder = find_data_folder();
    for (const std::string& file : {arguments->file, arguments->second})
      if (!file.empty()) options.files.push_back(file);
    run_studio(options);
  };
  return command;
}

}  // namespace parian
