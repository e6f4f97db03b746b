// The line at the bottom, messages, and what runs.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/ui.h"

namespace parian {
namespace {

constexpr ImU32 error_color = IM_COL32(255, 140, 115, 255);
constexpr double notice_s = 20;  // that an error stays over the view

std::string text_of(const Message& message) {
  return message.count > 1 ? fmt::format("{} ({} times)", message.text, message.count)
                           : message.text;
}

void draw_last_message(Ui& ui, float width) {
  if (ui.studio.messages.empty()) return;
  const Message& last = ui.studio.messages.back();
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
  ImGui::PushStyleColor(ImGuiCol_Text,
                        last.is_error ? error_color : ImGui::GetColorU32(ImGuiCol_Text));
  ImGui::PushStyleVar(ImGuiStyleVar_ButtonTextAlign, ImVec2(0, 0.5f));
  ImGui::Button((text_of(last) + "###last").c_str(), {width, 0});
  ImGui::PopStyleVar();
  ImGui::PopStyleColor(2);
  mark(ui.probe, "messages");
  explain(last.text.c_str());
}

// True: it shall be cancelled.
bool draw_progress(const std::string& name, const std::string& text, double done) {
  const float em = ImGui::GetFontSize();
  ImGui::SameLine();
  ImGui::ProgressBar(static_cast<float>(std::clamp(done, 0.0, 1.0)), {14 * em, 0}, text.c_str());
  explain(text.c_str());
  ImGui::SameLine(0, 2);
  return ImGui::Button(("×##" + name).c_str(), {1.5f * em, 0});
}

bool is_shown(const JobView& job) {
  return job.name != "flat" && job.name != "measured";
}

void draw_jobs(Ui& ui, const std::vector<JobView>& jobs, const EditorActivity& activity) {
  Studio& studio = ui.studio;
  for (const JobView& job : jobs) {
    if (!is_shown(job)) continue;
    const std::string text = fmt::format("{} {:.0f} %", job.name, 100 * job.done);
    if (draw_progress(job.name, text, job.done)) {
      studio.jobs.cancel(job.name);
      if (job.name == "refine") studio.still = Still::fine;
    }
    mark(ui.probe, "cancel/" + job.name);
  }
  if (activity.busy && studio.editor != nullptr &&
      draw_progress("edit", activity.stage.empty() ? "edit" : activity.stage, activity.done))
    studio.editor->cancel();
}

}  // namespace

void draw_messages(Ui& ui) {
  if (ui.studio.messages.empty()) ImGui::TextDisabled("none yet");
  for (auto message = ui.studio.messages.rbegin(); message != ui.studio.messages.rend();
       ++message) {
    if (message->is_error) ImGui::PushStyleColor(ImGuiCol_Text, error_color);
    ImGui::TextWrapped("%s", text_of(*message).c_str());
    if (message->is_error) ImGui::PopStyleColor();
  }
}

void draw_status(Ui& ui) {
  const Studio& studio = ui.studio;
  const std::vector<JobView> jobs = studio.jobs.views();
  const EditorActivity activity =
      studio.editor != nullptr ? studio.editor->activity() : EditorActivity{};
  const auto shown = static_cast<float>(std::count_if(jobs.begin(), jobs.end(), is_shown) +
                                        (activity.busy ? 1 : 0));
  const float em = ImGui::GetFontSize();
  const std::string figures =
      studio.picture != nullptr
          ? fmt::format("{} × {}  {:.0f} ms  {:.0f} fps", studio.picture->width,
                        studio.picture->height, 1e3 * studio.picture->seconds,
                        static_cast<double>(ImGui::GetIO().Framerate))
          : "";
  const float figures_width = 15 * em, job_width = 16.5f * em;
  const float room = ImGui::GetContentRegionAvail().x;
  draw_last_message(ui, std::max(4 * em, room - figures_width - shown * job_width));
  draw_jobs(ui, jobs, activity);
  ImGui::SameLine(std::max(4 * em, room - ImGui::CalcTextSize(figures.c_str()).x));
  ImGui::TextDisabled("%s", figures.c_str());
}

// The last error, over the view until it is clicked away or old.
void draw_notice(Ui& ui, const PanelBox& view) {
  Studio& studio = ui.studio;
  if (studio.unseen_errors == 0) return;
  const auto error = std::find_if(studio.messages.rbegin(), studio.messages.rend(),
                                  [](const Message& message) { return message.is_error; });
  if (error == studio.messages.rend() || studio.now_s - error->time_s > notice_s) {
    studio.unseen_errors = 0;
    return;
  }
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({view.x + em, view.y + view.height - em}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSize({std::max(1.0f, std::min(view.width - 2 * em, 42 * em)), 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.28f, 0.12f, 0.10f, 0.96f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 4);
  ImGui::Begin("notice", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushTextWrapPos(ImGui::GetContentRegionAvail().x - 2.5f * em);
  ImGui::TextUnformatted(error->text.c_str());
  if (studio.unseen_errors > 1)
    ImGui::TextDisabled("and %zu more under Messages", studio.unseen_errors - 1);
  ImGui::PopTextWrapPos();
  ImGui::SetCursorPos({ImGui::GetWindowWidth() - 2.4f * em, ImGui::GetStyle().WindowPadding.y});
  if (ImGui::SmallButton("×")) studio.unseen_errors = 0;
  mark(ui.probe, "notice/close");
  ImGui::End();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

}  // namespace parian
