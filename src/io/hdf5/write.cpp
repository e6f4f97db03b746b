#include "io/hdf5/write_internal.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "io/hdf5/raw_file_internal.h"
#include "io/json/files.h"

namespace parian::hdf5 {

NewFile::NewFile(std::string path) : path_(std::move(path)) {
  check_writable(path_);
  temporary_ = temporary_name(path_);
}

NewFile::~NewFile() {
  if (committed_) return;
  if (file_.valid()) let_go();
  file_.close();
  ::unlink(temporary_.c_str());
}

// Where disk space cannot be reserved, HDF5 meets a full disk after all: what is given up is led
// to memory, where the writes that closing needs succeed.
void NewFile::let_go() {
  const Guard guard;
  void* descriptor = nullptr;
  if (!file_.valid() || H5Fget_vfd_handle(file_.get(), H5P_DEFAULT, &descriptor) < 0) return;
  const int memory = ::memfd_create("parian-given-up", MFD_CLOEXEC);
  if (memory < 0) return;
  ::dup3(memory, *static_cast<const int*>(descriptor), O_CLOEXEC);
  ::close(memory);
}

hid_t NewFile::check(hid_t id_or_status) {
  if (id_or_status >= 0) return id_or_status;
  const Failure failure = last_failure();
  let_go();
  if (failure.error_number != 0) throw_write_error(path_, failure.error_number);
  throw Error({.file = path_, .expected = "to write HDF5", .found = failure.message},
              ErrorKind::resource);
}

// A full disk is met here, before HDF5 is asked: what H5Fcreate leaves behind when it cannot write
// its first bytes crashes the program at exit.
static void probe_disk(const std::string& temporary, const std::string& path) {
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const std::string block(std::size_t{8} << 10u, '\0');
  const ssize_t written = fd < 0 ? -1 : ::write(fd, block.data(), block.size());
  const int error_number = errno;
  if (fd >= 0) ::close(fd);
  if (written < 0) throw_write_error(path, error_number);
  if (static_cast<std::size_t>(written) < block.size()) throw_write_error(path, ENOSPC);
}

void NewFile::create() {
  probe_disk(temporary_, path_);
  const Guard guard;
  file_ =
      Id(check(H5Fcreate(temporary_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)), H5Fclose);
  raw_.emplace(temporary_, RawFile::Mode::write, path_);
  reserve(0);
}

void NewFile::reserve(std::uint64_t bytes) {
  constexpr std::uint64_t metadata = std::uint64_t{64} << 10u;
  const Guard guard;
  hsize_t size = 0;
  check(H5Fget_filesize(file_.get(), &size));
  raw_->reserve(size + bytes + metadata);
}

void NewFile::write_attribute(const char* name, hid_t type, const std::vector<double>* values,
                              const void* data) {
  const hsize_t count = values == nullptr ? 1 : values->size();
  const Id space(
      check(values == nullptr ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr)),
      H5Sclose);
  const Id attribute(
      check(H5Acreate2(file_.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  check(H5Awrite(attribute.get(), type, data));
}

// Variable-length UTF-8, as h5py writes: its bytes lie in the global heap, so that a long
// provenance is not bound by the 64 KiB of an object header message.
void NewFile::write_text(const char* name, const std::string& text) {
  if (text.empty()) return;
  const Guard guard;
  reserve(text.size());
  const Id type(check(H5Tcopy(H5T_C_S1)), H5Tclose);
  check(H5Tset_size(type.get(), H5T_VARIABLE));
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8));
  const char* data = text.c_str();
  write_attribute(name, type.get(), nullptr, &data);
}

void NewFile::write_number(const char* name, double value) {
  const Guard guard;
  write_attribute(name, H5T_NATIVE_DOUBLE, nullptr, &value);
}

void NewFile::write_int(const char* name, int value) {
  const Guard guard;
  write_attribute(name, H5T_NATIVE_INT32, nullptr, &value);
}

void NewFile::write_u64(const char* name, std::uint64_t value) {
  const Guard guard;
  write_attribute(name, H5T_NATIVE_UINT64, nullptr, &value);
}

void NewFile::write_numbers(const char* name, const std::vector<double>& values) {
  if (values.empty()) return;
  const Guard guard;
  write_attribute(name, H5T_NATIVE_DOUBLE, &values, values.data());
}

void NewFile::add_dataset(const char* name, hid_t type, const std::vector<hsize_t>& shape,
                          const void* data) {
  const Guard guard;
  std::size_t bytes = H5Tget_size(type);
  for (const hsize_t size : shape) bytes *= static_cast<std::size_t>(size);
  reserve(bytes);
  const Id plist(check(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  check(H5Pset_obj_track_times(plist.get(), false));  // the same table gives the same bytes
  check(H5Pset_obj_track_times(plist.get(), false));  // the same bytes at any time of day
  check(H5Pset_alloc_time(plist.get(), H5D_ALLOC_TIME_EARLY));
  check(H5Pset_fill_time(plist.get(), H5D_FILL_TIME_NEVER));
  const Id space(check(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr)),
                 H5Sclose);
  const Id dataset(check(H5Dcreate2(file_.get(), name, type, space.get(), H5P_DEFAULT, plist.get(),
                                    H5P_DEFAULT)),
                   H5Dclose);
  const haddr_t address = H5Dget_offset(dataset.get());
  PARIAN_CHECK(address != HADDR_UNDEF);
  pending_.push_back({address, data, bytes});
}

Id NewFile::add_chunked(const char* name, const std::vector<hsize_t>& shape,
                        const std::vector<hsize_t>& chunk, int deflate) {
  const Guard guard;
  const int rank = static_cast<int>(shape.size());
  const float fill = std::numeric_limits<float>::quiet_NaN();
  const Id plist(check(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  check(H5Pset_obj_track_times(plist.get(), false));  // the same table gives the same bytes
  check(H5Pset_obj_track_times(plist.get(), false));
  check(H5Pset_chunk(plist.get(), rank, chunk.data()));
  check(H5Pset_fill_value(plist.get(), H5T_NATIVE_FLOAT, &fill));
  check(H5Pset_fill_time(plist.get(), H5D_FILL_TIME_NEVER));
  if (deflate > 0) {
    check(H5Pset_shuffle(plist.get()));
    check(H5Pset_deflate(plist.get(), static_cast<unsigned>(deflate)));
  } else {
    check(H5Pset_alloc_time(plist.get(), H5D_ALLOC_TIME_EARLY));
    // A chunk of one slice and, at most, two entries of 56 bytes in the chunk index.
    reserve(shape[0] * shape[1] * (shape[2] * shape[3] * sizeof(float) + 112));
  }
  // Chunks are written whole and once: caching them would only copy them.
  const Id access(check(H5Pcreate(H5P_DATASET_ACCESS)), H5Pclose);
  check(H5Pset_chunk_cache(access.get(), 0, 0, 1));
  const Id space(check(H5Screate_simple(rank, shape.data(), nullptr)), H5Sclose);
  return Id(check(H5Dcreate2(file_.get(), name, H5T_IEEE_F32LE, space.get(), H5P_DEFAULT,
                             plist.get(), access.get())),
            H5Dclose);
}

void NewFile::close_hdf5() {
  const Guard guard;
  check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL));
  if (!file_.close()) check(-1);
  for (const PendingValues& values : pending_)
    raw_->write(values.address, values.data, values.bytes);
  raw_->trim();
}

void NewFile::commit() {
  commit_file(temporary_, path_);
  committed_ = true;
}

}  // namespace parian::hdf5
