#include "io/json/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/error.h"

namespace parian {
namespace {

namespace fs = std::filesystem;

struct FileDescriptor {
  explicit FileDescriptor(int descriptor) : fd(descriptor) {}
  ~FileDescriptor() {
    if (fd >= 0) ::close(fd);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int fd;
};

struct RemoveOnFailure {
  const std::string& path;
  bool keep = false;
  ~RemoveOnFailure() {
    if (!keep) ::unlink(path.c_str());
  }
};

// What `path` stands for once symbolic links are followed.
fs::path follow_links(const std::string& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  return error ? fs::path(path) : target;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void flush_to_disk(const std::string& file, const std::string& path, int flags) {
  FileDescriptor opened(::open(file.c_str(), flags | O_CLOEXEC));
  if (opened.fd < 0) throw_write_error(path, errno);
  // Some file systems cannot flush folders or special files: not an error of the data.
  if (::fsync(opened.fd) != 0 && errno != EINVAL && errno != ENOTSUP)
    throw_write_error(path, errno);
}

void write_all(int fd, std::string_view text, const std::string& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_write_error(path, errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

void throw_write_error(const std::string& path, int error_number) {
  const auto fail = [&](const char* expected, std::string found) {
    throw Error({.file = path, .expected = expected, .found = std::move(found)},
                ErrorKind::resource);
  };
  switch (error_number) {
    case ENOENT:
    case ENOTDIR:
      fail("a writable folder", "no such directory");
      break;
    case EACCES:
    case EPERM:
      fail("a writable folder", "permission denied");
      break;
    case EROFS:
      fail("a writable folder", "a read-only file system");
      break;
    case ENOSPC:
    case EDQUOT:
      fail("free disk space", "a full disk");
      break;
    default:
      fail("to write the file", std::strerror(error_number));
  }
  throw std::logic_error("unreachable");
}

void throw_read_error(const std::string& path, int error_number) {
  const bool missing = error_number == ENOENT || error_number == ENOTDIR;
  const bool folder = error_number == EISDIR;
  const bool denied = error_number == EACCES || error_number == EPERM;
  throw Error({.file = path,
               .expected = "a readable file",
               .found = missing  ? "no such file"
                        : folder ? "a directory"
                        : denied ? "permission denied"
                                 : std::strerror(error_number)});
}

std::string read_file(const std::string& path, std::size_t max_bytes) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.fd < 0) throw_read_error(path, errno);
  struct stat status {};
  if (::fstat(file.fd, &status) != 0) throw_read_error(path, errno);
  // Pipes and devices state no size: grow as their bytes arrive.
  const std::size_t stated =
      S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) : std::size_t{0};
  const auto too_large = [&] {
    throw Error({.file = path,
                 .expected = fmt::format("a file of at most {} bytes", max_bytes),
                 .found = stated > 0 ? fmt::format("{} bytes", stated) : "more"});
  };
  if (stated > max_bytes) too_large();
  std::string text(std::min(stated + 1, max_bytes + 1), '\0');
  std::size_t size = 0;
  while (true) {
    if (size == text.size()) text.resize(std::min(2 * size, max_bytes + 1));
    const ssize_t count = ::read(file.fd, text.data() + size, text.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_read_error(path, errno);
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
    if (size > max_bytes) too_large();
  }
  text.resize(size);
  return text;
}

void make_folder(const std::string& path) {
  std::error_code failure;
  fs::create_directories(path, failure);
  if (failure)
    throw Error({.file = path, .expected = "a folder that can be made", .found = failure.message()},
                ErrorKind::resource);
}

void check_writable(const std::string& path) {
  const fs::path target = follow_links(path);
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  // A rename would replace a device or a folder by a file.
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error({.file = path,
                 .expected = "the name of a file to write",
                 .found = fs::is_directory(status) ? "a directory" : "a device"},
                ErrorKind::resource);
  const fs::path folder = folder_of(target);
  const fs::file_status folder_status = fs::status(folder, error);
  if (!fs::is_directory(folder_status))
    throw_write_error(path, fs::exists(folder_status) ? ENOTDIR : ENOENT);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw_write_error(path, errno);
}

std::string temporary_name(const std::string& path) {
  static std::atomic<unsigned> count{0};  // names differ, results do not depend on it
  const fs::path target = follow_links(path);
  // The name is cut so that the whole stays within the 255 bytes of common file systems.
  const std::string name = target.filename().string().substr(0, 200);
  return (folder_of(target) / fmt::format(".{}.{}.{}.partial", name, ::getpid(), count++)).string();
}

void commit_file(const std::string& temporary, const std::string& path) {
  flush_to_disk(temporary, path, O_RDWR);
  const fs::path target = follow_links(path);
  if (::rename(temporary.c_str(), target.c_str()) != 0) throw_write_error(path, errno);
  flush_to_disk(folder_of(target).string(), path, O_RDONLY | O_DIRECTORY);
}

void write_file_atomically(const std::string& path,
                           const std::function<void(const std::string& temporary)>& write) {
  check_writable(path);
  const std::string temporary = temporary_name(path);
  RemoveOnFailure guard{temporary};
  write(temporary);
  commit_file(temporary, path);
  guard.keep = true;
}

void write_text(const std::string& path, std::string_view text) {
  write_file_atomically(path, [&](const std::string& temporary) {
    FileDescriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.fd < 0) throw_write_error(path, errno);
    write_all(file.fd, text, path);
  });
}

}  // namespace parian
