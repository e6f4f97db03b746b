// The recipe being edited, on a thread of its own: changes are queued, applied to the session and
// evaluated there, and each result is handed out as a snapshot that never changes. Frames are drawn
// from the last snapshot and never wait.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edit/session.h"
#include "material/material.h"

namespace parian {

struct LayerSnapshot {
  Document source;  // as the recipe has it
  std::string name, kind;
  bool enabled = true;
  std::shared_ptr<const Mask> mask;  // null: not evaluated, or all
  EditReport report;
};

struct EditorSnapshot {
  std::uint64_t version = 0;   // grows with every result
  std::uint64_t original = 0;  // grows when another map is opened
  Document recipe;
  std::vector<LayerSnapshot> layers;
  EditState before, after;
  std::shared_ptr<const Material> material;  // of `after`
  std::shared_ptr<const ProfileMap> map;     // the same
  std::vector<std::string> history;          // labels of what can be undone, oldest first
  std::vector<std::string> future;           // of what can be redone, next first
  double seconds = 0;                        // of the last evaluation
};

struct EditorActivity {
  bool busy = false;
  std::string stage;
  double done = 0;
};

// All functions may be called from one thread (the window's).
class Editor {
 public:
  Editor(const ProfileMap& map, RecipeLoaders loaders);
  ~Editor();  // cancels what runs
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  // A change with the label that history shows. Changes with the same `merge_key`, as while a
  // slider is dragged, become one entry; of those that wait only the newest is evaluated.
  using Change = std::function<Recipe(EditSession&)>;
  void post(std::string label, Change change, std::string merge_key = {});
  void undo();
  void redo();
  void cancel();  // the evaluation that runs, which leaves everything as it was

  std::shared_ptr<const EditorSnapshot> snapshot() const;
  EditorActivity activity() const;
  // Of a change that failed, which is taken back; empty: none since the last call.
  std::optional<std::string> take_error();
  // Until all changes are done. For tests and scripted runs.
  void wait();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Changes. One of a layer that an earlier one took away changes nothing.
Editor::Change set_layer(std::size_t index, const Document& layer);
Editor::Change insert_layer(std::size_t index, const Document& layer);
Editor::Change remove_layer(std::size_t index);
Editor::Change move_layer(std::size_t from, std::size_t to);
Editor::Change set_whole_recipe(Document recipe);

}  // namespace parian
