#include "io/hdf5/handle_internal.h"

#include <cstdlib>
#include <utility>

#include "base/error.h"

namespace parian::hdf5 {
namespace {

std::recursive_mutex& global_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

// Upward walks begin at the innermost function: its text is the cause.
herr_t keep_first(unsigned index, const H5E_error2_t* error, void* message) {
  if (index == 0 && error->desc != nullptr) *static_cast<std::string*>(message) = error->desc;
  return 0;
}

}  // namespace

Guard::Guard() : lock_(global_mutex()) {
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Guard::~Guard() {
  H5Eset_auto2(H5E_DEFAULT, print_, print_data_);
}

Id::Id(Id&& other) noexcept
    : id_(std::exchange(other.id_, -1)), close_(std::exchange(other.close_, nullptr)) {}

Id& Id::operator=(Id&& other) noexcept {
  if (this != &other) {
    close();
    id_ = std::exchange(other.id_, -1);
    close_ = std::exchange(other.close_, nullptr);
  }
  return *this;
}

bool Id::close() {
  if (id_ < 0) return true;
  const Guard guard;
  return close_(std::exchange(id_, -1)) >= 0;
}

Failure last_failure() {
  Failure failure;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &failure.message);
  const std::string key = "errno = ";
  if (const std::size_t at = failure.message.find(key); at != std::string::npos)
    failure.error_number = std::atoi(failure.message.c_str() + at + key.size());
  return failure;
}

void throw_failure(const std::string& path, const std::string& place) {
  Failure failure = last_failure();
  throw Error({path, place, "readable HDF5",
               failure.message.empty() ? "damaged data" : std::move(failure.message)});
}

}  // namespace parian::hdf5
