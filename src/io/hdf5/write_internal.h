// An HDF5 file in the making: it appears under its name, whole, with commit(); destroyed before
// that it leaves nothing behind. Internal to this folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/handle_internal.h"
#include "io/hdf5/raw_file_internal.h"

namespace parian::hdf5 {

// Values that HDF5 has laid out but not written: they go to the file past it (raw_file_internal.h),
// so that a full disk is met by plain system calls and not in the middle of HDF5's own bookkeeping.
struct PendingValues {
  std::uint64_t address = 0;
  const void* data = nullptr;
  std::size_t bytes = 0;
};

class NewFile {
 public:
  // Throws Error(resource) when `path` cannot be written.
  explicit NewFile(std::string path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void create();
  void write_text(const char* name, const std::string& text);  // nothing when empty
  void write_number(const char* name, double value);
  void write_int(const char* name, int value);
  void write_u64(const char* name, std::uint64_t value);
  void write_numbers(const char* name, const std::vector<double>& values);  // nothing when empty
  // A contiguous dataset whose values are written by close_hdf5(); `data` stays the caller's.
  void add_dataset(const char* name, hid_t type, const std::vector<hsize_t>& shape,
                   const void* data);
  Id add_chunked(const char* name, const std::vector<hsize_t>& shape,
                 const std::vector<hsize_t>& chunk, int deflate);
  // Before HDF5 writes up to `bytes` of values and some metadata: throws Error(resource) when the
  // disk has no room for them. HDF5 1.10 cannot close a file whose flush has failed and crashes the
  // program at exit, so it must not meet a full disk itself.
  void reserve(std::uint64_t bytes);
  // Flushes and closes HDF5's part, then writes the pending values; the temporary file is complete
  // but for what the caller itself writes to raw addresses.
  void close_hdf5();
  void commit();

  // For calls of HDF5 that write: throws Error(resource) naming the final path.
  hid_t check(hid_t id_or_status);

  const std::string& path() const { return path_; }
  const std::string& temporary() const { return temporary_; }

 private:
  void let_go();
  void write_attribute(const char* name, hid_t type, const std::vector<double>* values,
                       const void* data);
  std::string path_;
  std::string temporary_;
  bool committed_ = false;
  std::vector<PendingValues> pending_;
  std::optional<RawFile> raw_;
  Id file_;
};

}  // namespace parian::hdf5
