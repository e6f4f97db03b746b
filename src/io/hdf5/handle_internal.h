// The RAII layer over the C API of HDF5 1.10: handles that close themselves, one lock around all
// calls, HDF5's failures as text. Internal to this folder and its tests.
#pragma once

#include <hdf5.h>

#include <mutex>
#include <string>

namespace parian::hdf5 {

// Every call of HDF5 happens while a Guard lives. Distributions build HDF5 without thread safety,
// and its state (open objects, metadata cache, error stack) belongs to the process, not to a file:
// so must the lock. It is recursive because handles close themselves inside guarded code. While
// one lives, HDF5 does not print its errors.
class Guard {
 public:
  Guard();
  ~Guard();
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

// A handle, closed by the function that fits its kind. Move-only; negative when empty.
class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id() = default;
  Id(hid_t id, Close close_function) : id_(id), close_(close_function) {}
  Id(Id&& other) noexcept;
  Id& operator=(Id&& other) noexcept;
  ~Id() { close(); }

  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }
  // False when HDF5 could not close it (files: not flush it); empty afterwards in any case.
  bool close();

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

// What the last failed call said, from its innermost function.
struct Failure {
  std::string message;
  int error_number = 0;  // errno, when the system refused something
};
Failure last_failure();

// For calls that fail only on a damaged file or a lack of memory.
[[noreturn]] void throw_failure(const std::string& path, const std::string& place);
inline hid_t require(hid_t id, const std::string& path, const std::string& place) {
  if (id < 0) throw_failure(path, place);
  return id;
}

}  // namespace parian::hdf5
