#include "app/studio/editor.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <variant>

#include "base/error.h"
#include "io/json/json.h"

namespace parian {
namespace {

enum class CommandKind { change, undo, redo };

struct Command {
  CommandKind kind = CommandKind::change;
  std::string label, merge_key;
  Editor::Change change;
};

// Changes wait in a queue: one before may have taken away the layer that they are about.
void check_layer(const EditSession& session, std::size_t index) {
  if (index >= session.recipe.layers.size()) throw make_cancelled_error();
}

// As if read from a file, so that errors name the layer and the key.
Document with_places(const Document& layer) {
  const Document* name = find(layer, "name");
  const auto* text = name != nullptr ? std::get_if<std::string>(&name->value) : nullptr;
  return parse_document(format_document(layer),
                        text != nullptr ? fmt::format("layer '{}'", *text) : "layer");
}

std::shared_ptr<EditorSnapshot> make_snapshot(const EditSession& session, const EditState& state) {
  auto snapshot = std::make_shared<EditorSnapshot>();
  snapshot->recipe = write_recipe(session.recipe);
  snapshot->before = session.original;
  snapshot->after = state;
  for (std::size_t i = 0; i < session.recipe.layers.size(); ++i) {
    const Layer& layer = *session.recipe.layers[i];
    LayerSnapshot view{
        .source = layer.source, .name = layer.name, .kind = layer.kind, .enabled = layer.enabled};
    if (const LayerResult* result = find_result(session, i); result != nullptr) {
      view.mask = result->mask;
      view.report = result->report;
    }
    snapshot->layers.push_back(std::move(view));
  }
  snapshot->material = std::make_shared<const Material>(make_profile_map(state));
  snapshot->map = {snapshot->material, &std::get<ProfileMap>(*snapshot->material)};
  return snapshot;
}

}  // namespace

struct Editor::Impl {
  mutable std::mutex mutex;
  std::condition_variable wake, idle;
  std::deque<Command> queue;
  bool stops = false, cancels = false, works = false;
  std::string stage;
  double done = 0;
  std::optional<std::string> error;
  std::shared_ptr<const EditorSnapshot> snapshot;

  // The thread's own.
  EditSession session;
  std::vector<std::string> history, future;
  std::string last_merge_key;
  std::uint64_t version = 0;
  std::thread thread;

  void run();
  void apply(const Command& command);
  void evaluate_and_publish();
  Progress make_progress();
};

Progress Editor::Impl::make_progress() {
  return {.report =
              [this](std::string_view name, double part) {
                const std::scoped_lock lock(mutex);
                stage = name;
                done = part;
              },
          .is_cancelled =
              [this] {
                const std::scoped_lock lock(mutex);
                return cancels || stops;
              }};
}

void Editor::Impl::evaluate_and_publish() {
  const auto start = std::chrono::steady_clock::now();
  const EditState state = evaluate(session, make_progress());
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  auto next = make_snapshot(session, state);
  next->seconds = taken.count();
  next->version = ++version;
  next->history = history;
  next->future.assign(future.rbegin(), future.rend());
  const std::scoped_lock lock(mutex);
  snapshot = std::move(next);
}

void Editor::Impl::apply(const Command& command) {
  if (command.kind != CommandKind::change) {
    auto& from = command.kind == CommandKind::undo ? history : future;
    auto& to = command.kind == CommandKind::undo ? future : history;
    last_merge_key.clear();
    const bool moved =
        command.kind == CommandKind::undo ? parian::undo(session) : parian::redo(session);
    if (!moved) return;
    to.push_back(std::move(from.back()));
    from.pop_back();
    return evaluate_and_publish();
  }
  const EditSession before = session;
  const bool merge = !command.merge_key.empty() && command.merge_key == last_merge_key;
  try {
    set_recipe(session, command.change(session), merge);
    const auto old_history = history;
    const auto old_future = future;
    if (!merge) history.push_back(command.label);
    future.clear();
    try {
      evaluate_and_publish();
    } catch (...) {
      history = old_history;
      future = old_future;
      throw;
    }
    last_merge_key = command.merge_key;
  } catch (...) {
    session = before;
    throw;
  }
}

void Editor::Impl::run() {
  std::unique_lock lock(mutex);
  while (true) {
    wake.wait(lock, [this] { return stops || !queue.empty(); });
    if (stops) return;
    Command command = std::move(queue.front());
    queue.pop_front();
    // What a newer one of the same kind replaces need not be seen.
    while (!queue.empty() && !command.merge_key.empty() &&
           queue.front().merge_key == command.merge_key) {
      command = std::move(queue.front());
      queue.pop_front();
    }
    works = true;
    cancels = false;
    lock.unlock();
    std::optional<std::string> message;
    try {
      apply(command);
    } catch (const Error& caught) {
      if (caught.kind != ErrorKind::cancelled) message = caught.what();
    } catch (const std::exception& caught) {
      message = caught.what();
    }
    lock.lock();
    works = false;
    stage.clear();
    done = 0;
    if (message) error = message;
    if (queue.empty()) idle.notify_all();
  }
}

Editor::Editor(const ProfileMap& map, RecipeLoaders loaders) : impl_(std::make_unique<Impl>()) {
  impl_->session = make_edit_session(map, std::move(loaders));
  impl_->evaluate_and_publish();
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
}

Editor::~Editor() {
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->stops = true;
  }
  impl_->wake.notify_all();
  impl_->thread.join();
}

void Editor::post(std::string label, Change change, std::string merge_key) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->queue.push_back(
      {CommandKind::change, std::move(label), std::move(merge_key), std::move(change)});
  impl_->wake.notify_all();
}

void Editor::undo() {
  const std::scoped_lock lock(impl_->mutex);
  impl_->queue.push_back({.kind = CommandKind::undo});
  impl_->wake.notify_all();
}

void Editor::redo() {
  const std::scoped_lock lock(impl_->mutex);
  impl_->queue.push_back({.kind = CommandKind::redo});
  impl_->wake.notify_all();
}

void Editor::cancel() {
  const std::scoped_lock lock(impl_->mutex);
  impl_->cancels = true;
}

std::shared_ptr<const EditorSnapshot> Editor::snapshot() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->snapshot;
}

EditorActivity Editor::activity() const {
  const std::scoped_lock lock(impl_->mutex);
  return {impl_->works || !impl_->queue.empty(), impl_->stage, impl_->done};
}

std::optional<std::string> Editor::take_error() {
  const std::scoped_lock lock(impl_->mutex);
  return std::exchange(impl_->error, std::nullopt);
}

void Editor::wait() {
  std::unique_lock lock(impl_->mutex);
  impl_->idle.wait(lock, [this] { return !impl_->works && impl_->queue.empty(); });
}

Editor::Change set_layer(std::size_t index, const Document& layer) {
  return [index, layer = with_places(layer)](EditSession& session) {
    check_layer(session, index);
    return with_layer(session, index, layer);
  };
}

Editor::Change insert_layer(std::size_t index, const Document& layer) {
  return [index, layer = with_places(layer)](EditSession& session) {
    return with_new_layer(session, std::min(index, session.recipe.layers.size()), layer);
  };
}

Editor::Change remove_layer(std::size_t index) {
  return [index](EditSession& session) {
    check_layer(session, index);
    return without_layer(session, index);
  };
}

Editor::Change move_layer(std::size_t from, std::size_t to) {
  return [from, to](EditSession& session) {
    check_layer(session, std::max(from, to));
    return with_moved_layer(session, from, to);
  };
}

Editor::Change set_whole_recipe(Document recipe) {
  return [recipe = std::move(recipe)](EditSession& session) {
    return read_recipe(recipe, session.resources, &session.recipe);
  };
}

}  // namespace parian
