// parian reconstruct: a material's R_d as a table.
#include <fmt/format.h>

#include <limits>
#include <memory>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "base/error.h"
#include "io/hdf5/table_file.h"
#include "io/json/json.h"

namespace parian {
namespace {

struct ReconstructOptions {
  std::string material, output, like;
};

// A model is exact: it has no noise, and tables without noise hold positive values only. Beyond a
// profile's support R_d is 0; the file says the smallest normal float instead.
class PositiveSource : public SliceSource {
 public:
  PositiveSource(const SliceSource& source, TableHeader header)
      : source_(source), header_(std::move(header)) {}
  const TableHeader& header() const override { return header_; }
  std::string name() const override { return source_.name(); }
  void read_slice(int channel, int offset_index, float* slice) const override {
    source_.read_slice(channel, offset_index, slice);
    for (std::size_t i = 0; i < header_.pixels(); ++i)
      if (slice[i] < std::numeric_limits<float>::min())
        slice[i] = std::numeric_limits<float>::min();
  }

 private:
  const SliceSource& source_;
  TableHeader header_;
};

void reconstruct(const ReconstructOptions& options, const Context& context) {
  check_output(options.output, {options.material, options.like});
  const std::unique_ptr<SliceSource> like = open_table(options.like);
  const Surface surface = open_surface(options.material, &like->header());
  if (!surface.material)
    throw Error({options.material, {}, "a material", "a BSSRDF table"}, ErrorKind::input);
  TableHeader header = surface.slices->header();
  header.provenance = format_document(Document::Object{
      {"kind", "reconstruction"}, {"material", options.material}, {"like", options.like}});
  const PositiveSource source(*surface.slices, header);
  const auto sink = create_table(options.output, header);
  copy_slices(source, *sink, context.progress);
  print_summary(context,
                fmt::format("{}: table of the {}, {} x {} pixels, {} offsets, {} channels\n",
                            options.output, describe_kind(*surface.material), header.width,
                            header.height, header.offsets.size(), header.channels));
}

}  // namespace

CommandSpec make_reconstruct_command() {
  const auto options = std::make_shared<ReconstructOptions>();
  CommandSpec command;
  command.name = "reconstruct";
  command.summary = "write a material as a table, at the offsets of another";
  command.example = "parian reconstruct stone-map.h5 --like stone.h5 -o stone-again.h5";
  command.positionals = {{"MATERIAL", "profile map or blend", &options->material}};
  command.flags = {
      {"output", 'o', "TABLE.h5", "table to write", &options->output, /*required=*/true},
      {"like", 0, "TABLE.h5", "table with the grid and offsets", &options->like,
       /*required=*/true}};
  command.run = [options](const Context& context) { reconstruct(*options, context); };
  return command;
}

}  // namespace parian
