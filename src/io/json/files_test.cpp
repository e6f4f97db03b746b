#include "io/json/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/test_errors.h"
#include "io/json/json.h"
#include "io/json/test_folder.h"

namespace parian {
namespace {

struct Files : testing::Test, TestFolder {
  Files() : TestFolder("files") {}
};

TEST_F(Files, TextRoundTrips) {
  const std::string text("a\0b\n", 4);
  write_text(at("t"), text);
  EXPECT_EQ(read_file(at("t"), 4), text);
  EXPECT_EQ(count(), 1u);
  EXPECT_EQ(error_of([&] { read_file(at("t"), 3); }),
            at("t") + ": expected a file of at most 3 bytes, found 4 bytes");
}

TEST_F(Files, ReadErrorsNameTheFile) {
  EXPECT_EQ(error_of([&] { read_file(at("none"), 9); }),
            at("none") + ": expected a readable file, found no such file");
  EXPECT_EQ(error_of([&] { read_file(path.string(), 9); }),
            path.string() + ": expected a readable file, found a directory");
}

TEST_F(Files, UnwritableOutputsAreToldApart) {
  const Error missing = catch_error([&] { write_text(at("out/x.h5"), "x"); });
  EXPECT_EQ(missing.what(),
            at("out/x.h5") + ": expected a writable folder, found no such directory");
  EXPECT_EQ(missing.kind, ErrorKind::resource);
  write_text(at("file"), "x");
  EXPECT_EQ(error_of([&] { check_writable(at("file/x")); }),
            at("file/x") + ": expected a writable folder, found no such directory");
  EXPECT_EQ(error_of([&] { check_writable(path.string()); }),
            path.string() + ": expected the name of a file to write, found a directory");
  EXPECT_EQ(error_of([&] { check_writable("/dev/null"); }),
            "/dev/null: expected the name of a file to write, found a device");
}

TEST_F(Files, InterruptedWriteLeavesTheOldFile) {
  write_text(at("t"), "old");
  EXPECT_THROW(write_file_atomically(at("t"),
                                     [&](const std::string& temporary) {
                                       write_text(temporary, "half");
                                       throw make_cancelled_error();
                                     }),
               Error);
  EXPECT_EQ(read_file(at("t"), 99), "old");
  EXPECT_EQ(count(), 1u);
}

TEST_F(Files, TemporaryNamesAreHiddenUniqueNeighbours) {
  const std::string first = temporary_name(at("a.h5"));
  EXPECT_EQ(std::filesystem::path(first).parent_path(), path);
  EXPECT_THAT(std::filesystem::path(first).filename().string(),
              testing::MatchesRegex("\\.a\\.h5\\.[0-9]+\\.[0-9]+\\.partial"));
  EXPECT_NE(first, temporary_name(at("a.h5")));
}

TEST_F(Files, SymbolicLinksAreFollowed) {
  write_text(at("real"), "old");
  std::filesystem::create_symlink("real", at("link"));
  write_text(at("link"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(at("link")));
  EXPECT_EQ(read_file(at("real"), 99), "new");
}

TEST_F(Files, DocumentsRoundTrip) {
  Document document;
  set(document, "key", Document::Array{1, "two"});
  save_document(at("d.json"), document);
  EXPECT_EQ(read_file(at("d.json"), 99), "{\n  \"key\": [1, \"two\"]\n}\n");
  EXPECT_EQ(as_string(as_array(get(load_document(at("d.json")), "key"))[1]), "two");
}

}  // namespace
}  // namespace parian
