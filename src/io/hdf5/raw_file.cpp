#include "io/hdf5/raw_file_internal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "base/error.h"
#include "io/json/files.h"

namespace parian {

RawFile::RawFile(const std::string& path, Mode mode, std::string name)
    : fd_(::open(path.c_str(), (mode == Mode::read ? O_RDONLY : O_RDWR) | O_CLOEXEC)),
      name_(std::move(name)) {
  struct stat status {};
  if (fd_ >= 0 && ::fstat(fd_, &status) == 0) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    return;
  }
  const int error_number = errno;
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  if (mode == Mode::read) throw_read_error(name_, error_number);
  throw_write_error(name_, error_number);
}

RawFile::~RawFile() {
  if (fd_ >= 0) ::close(fd_);
}

RawFile::RawFile(RawFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), size_(other.size_), name_(std::move(other.name_)) {}

void RawFile::read(std::uint64_t address, void* data, std::size_t bytes) const {
  auto* to = static_cast<char*>(data);
  while (bytes > 0) {
    const ssize_t count = ::pread(fd_, to, bytes, static_cast<off_t>(address));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_read_error(name_, errno);
    if (count == 0)
      throw Error({name_, "", fmt::format("{} more bytes at address {}", bytes, address),
                   "the end of the file"});
    to += count;
    address += static_cast<std::uint64_t>(count);
    bytes -= static_cast<std::size_t>(count);
  }
}

void RawFile::write(std::uint64_t address, const void* data, std::size_t bytes) const {
  const auto* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t count = ::pwrite(fd_, from, bytes, static_cast<off_t>(address));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_write_error(name_, errno);
    from += count;
    address += static_cast<std::uint64_t>(count);
    bytes -= static_cast<std::size_t>(count);
  }
}

void RawFile::reserve(std::uint64_t bytes) const {
  while (::fallocate(fd_, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) != 0) {
    if (errno == EINTR) continue;
    if (errno == ENOSPC || errno == EDQUOT || errno == EFBIG) throw_write_error(name_, errno);
    return;
  }
}

void RawFile::trim() const {
  struct stat status {};
  if (::fstat(fd_, &status) != 0 || ::ftruncate(fd_, status.st_size) != 0)
    throw_write_error(name_, errno);
}

}  // namespace parian
