// Plain reads and writes at given addresses of a file: where the values of a dataset lie is asked
// of HDF5 once, and then they go past it, without its lock and its copies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace parian {

class RawFile {
 public:
  enum class Mode { read, write };
  // `name` is how errors call the file, which may have a temporary path.
  RawFile(const std::string& path, Mode mode, std::string name);
  ~RawFile();
  RawFile(RawFile&& other) noexcept;
  RawFile& operator=(RawFile&&) = delete;

  // At opening.
  std::uint64_t size() const { return size_; }
  // Thread-safe; throw Error, on a short read too.
  void read(std::uint64_t address, void* data, std::size_t bytes) const;
  void write(std::uint64_t address, const void* data, std::size_t bytes) const;
  // Claims disk space for the first `bytes`, so that a full disk shows now and not when they are
  // written; the file's size stays. Nothing where the file system cannot do that.
  void reserve(std::uint64_t bytes) const;
  // Gives back what was claimed beyond the end of the file.
  void trim() const;

 private:
  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::string name_;
};

}  // namespace parian
