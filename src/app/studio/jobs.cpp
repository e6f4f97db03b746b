#include "app/studio/jobs.h"

#include <algorithm>
#include <atomic>
#include <list>
#include <mutex>
#include <thread>

#include "base/error.h"

namespace parian {
namespace {

struct Job {
  std::string name;
  std::atomic<bool> cancelled{false}, ended{false};
  std::mutex mutex;
  std::string stage;
  double done = 0;
  Jobs::Finish finish;
  std::string error;
  std::thread thread;

  void run(const Jobs::Work& work);
};

void Job::run(const Jobs::Work& work) {
  const Progress progress{.report =
                              [this](std::string_view name_of_stage, double part) {
                                const std::scoped_lock lock(mutex);
                                stage = name_of_stage;
                                done = part;
                              },
                          .is_cancelled = [this] { return cancelled.load(); }};
  try {
    finish = work(progress);
  } catch (const Error& caught) {
    if (caught.kind != ErrorKind::cancelled) error = caught.what();
  } catch (const std::bad_alloc&) {
    error = name + ": there is not enough memory";
  } catch (const std::exception& caught) {
    error = caught.what();
  }
  ended = true;
}

}  // namespace

struct Jobs::Impl {
  std::list<std::unique_ptr<Job>> jobs;
};

Jobs::Jobs() : impl_(std::make_unique<Impl>()) {}

Jobs::~Jobs() {
  for (const auto& job : impl_->jobs) job->cancelled = true;
  for (const auto& job : impl_->jobs) job->thread.join();
}

void Jobs::start(std::string name, Work work) {
  cancel(name);
  auto job = std::make_unique<Job>();
  job->name = std::move(name);
  job->thread = std::thread([job = job.get(), work = std::move(work)] { job->run(work); });
  impl_->jobs.push_back(std::move(job));
}

void Jobs::cancel(const std::string& name) {
  for (const auto& job : impl_->jobs)
    if (job->name == name) job->cancelled = true;
}

bool Jobs::is_running(const std::string& name) const {
  return std::any_of(impl_->jobs.begin(), impl_->jobs.end(),
                     [&](const auto& job) { return job->name == name && !job->cancelled; });
}

std::vector<JobView> Jobs::views() const {
  std::vector<JobView> views;
  for (const auto& job : impl_->jobs) {
    if (job->cancelled) continue;
    const std::scoped_lock lock(job->mutex);
    views.push_back({job->name, job->stage, job->done});
  }
  return views;
}

std::vector<std::string> Jobs::poll() {
  std::vector<std::string> errors;
  // A finish may start other jobs: those that ended are taken out first.
  std::list<std::unique_ptr<Job>> ended;
  for (auto job = impl_->jobs.begin(); job != impl_->jobs.end();) {
    const auto next = std::next(job);
    if ((*job)->ended) ended.splice(ended.end(), impl_->jobs, job);
    job = next;
  }
  for (const auto& job : ended) {
    job->thread.join();
    if (job->cancelled) continue;
    if (!job->error.empty())
      errors.push_back(job->error);
    else if (job->finish)
      job->finish();
  }
  return errors;
}

}  // namespace parian
