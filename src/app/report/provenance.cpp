#include "app/report/provenance.h"

#include <filesystem>

#include "base/error.h"
#include "io/json/json.h"

namespace parian {
namespace {

// The provenance of others' tables may be any text.
Document parse_leniently(const std::string& text) {
  try {
    return parse_document(text, "provenance");
  } catch (const Error&) {
    return text;
  }
}

}  // namespace

std::string make_fit_provenance(const SliceSource& table, const FitParams& params) {
  FitParams copy = params;
  Document source{Document::Object{}};
  set(source, "file", std::filesystem::path(table.name()).filename().string());
  if (!table.header().provenance.empty())
    set(source, "provenance", parse_leniently(table.header().provenance));
  Document provenance{Document::Object{}};
  set(provenance, "kind", "fit");
  set(provenance, "program", "parian " PARIAN_VERSION);
  set(provenance, "parameters", write_params(describe(copy)));
  set(provenance, "table", source);
  return format_document(provenance);
}

std::string make_blend_provenance(const std::string& file, const std::string& map_provenance,
                                  const CompressParams& params) {
  CompressParams copy = params;
  Document source{Document::Object{}};
  set(source, "file", std::filesystem::path(file).filename().string());
  if (!map_provenance.empty()) set(source, "provenance", parse_leniently(map_provenance));
  Document provenance{Document::Object{}};
  set(provenance, "kind", "compress");
  set(provenance, "program", "parian " PARIAN_VERSION);
  set(provenance, "parameters", write_params(describe(copy)));
  set(provenance, "source", source);
  return format_document(provenance);
}

std::string make_edit_provenance(const std::string& file, const std::string& provenance,
                                 const std::string& recipe_file, const Document& recipe) {
  Document source{Document::Object{}};
  set(source, "file", std::filesystem::path(file).filename().string());
  if (!provenance.empty()) set(source, "provenance", parse_leniently(provenance));
  Document edit{Document::Object{}};
  set(edit, "kind", "edit");
  set(edit, "program", "parian " PARIAN_VERSION);
  set(edit, "recipe", std::filesystem::path(recipe_file).filename().string());
  set(edit, "layers", get(recipe, "layers"));
  set(edit, "source", source);
  return format_document(edit);
}

std::string make_transport_provenance(const std::string& scene_file,
                                      const PrecomputeParams& params) {
  PrecomputeParams copy = params;
  Document provenance{Document::Object{}};
  set(provenance, "kind", "precompute");
  set(provenance, "program", "parian " PARIAN_VERSION);
  set(provenance, "parameters", write_params(describe(copy)));
  set(provenance, "scene", std::filesystem::path(scene_file).filename().string());
  return format_document(provenance);
}

}  // namespace parian
