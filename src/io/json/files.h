// Whole files: reading with a size limit, and writing so that an interrupted run leaves the old
// file whole (temporary file in the same folder, then rename).
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace parian {

// Throws Error naming `path` when there is no such file, it cannot be read or is larger.
std::string read_file(const std::string& path, std::size_t max_bytes);

// Calls write(temporary path), then renames it to `path`. Removes the temporary file when write
// throws. Throws Error(resource) naming `path` when the folder is missing or not writable.
void write_file_atomically(const std::string& path,
                           const std::function<void(const std::string& temporary)>& write);
void write_text(const std::string& path, std::string_view text);

// A temporary name beside `path`, for writers that stay open: ".<name>.<pid>.<n>.partial". A
// symbolic link is followed, so that the file it leads to is replaced and not the link.
std::string temporary_name(const std::string& path);
// A folder to write into, and those above it, where there is none yet; else Error(resource).
void make_folder(const std::string& path);
// Throws the same Error as write_file_atomically when `path` cannot be written.
void check_writable(const std::string& path);
// rename(2), flushed to disk first.
void commit_file(const std::string& temporary, const std::string& path);

// The Error(resource) for a system error (errno) met while writing what shall become `path`:
// "PATH: expected free disk space, found a full disk".
[[noreturn]] void throw_write_error(const std::string& path, int error_number);
// The Error for a system error (errno) met while opening or reading.
[[noreturn]] void throw_read_error(const std::string& path, int error_number);

}  // namespace parian
