#include "io/image/exr_internal.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <fmt/format.h>

#include <cstring>
#include <vector>

#include "base/error.h"
#include "io/image/image_limits_internal.h"

namespace parian {
namespace {

class MemoryReader final : public Imf::IStream {
 public:
  explicit MemoryReader(const std::string& bytes) : IStream(""), bytes_(bytes) {}
  bool read(char data[], int count) override {
    if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size() - at_)
      throw std::runtime_error("the file ends early");
    std::memcpy(data, bytes_.data() + at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::uint64_t>(count);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw std::runtime_error("the file ends early");
    at_ = position;
  }

 private:
  const std::string& bytes_;
  std::uint64_t at_ = 0;
};

class MemoryWriter final : public Imf::OStream {
 public:
  MemoryWriter() : OStream("") {}
  void write(const char data[], int count) override {
    const auto end = static_cast<std::size_t>(at_) + static_cast<std::size_t>(count);
    if (bytes.size() < end) bytes.resize(end);
    std::memcpy(bytes.data() + at_, data, static_cast<std::size_t>(count));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }

  std::string bytes;

 private:
  std::uint64_t at_ = 0;
};

// The channels of the file that become ours, in order; an empty name is filled with 0.
std::vector<std::string> choose_channels(const Imf::ChannelList& channels,
                                         const std::string& path) {
  std::vector<std::string> names{"R", "G", "B"};
  bool any = false;
  for (std::string& name : names) {
    if (channels.findChannel(name) == nullptr) {
      name.clear();
    } else {
      any = true;
    }
  }
  if (!any) {
    if (channels.findChannel("Y") == nullptr)
      throw Error({.file = path, .expected = "channels R, G, B or Y", .found = "none of them"});
    names = {"Y"};
  }
  for (const std::string& name : names) {
    const Imf::Channel* channel = name.empty() ? nullptr : channels.findChannel(name);
    if (channel != nullptr && (channel->xSampling != 1 || channel->ySampling != 1))
      throw Error({path, "channel " + name, "one value per pixel", "a subsampled channel"});
  }
  return names;
}

// OpenEXR wraps what happened in 'Cannot read image file "". ...'.
std::string shorten(const std::string& message) {
  const std::size_t at = message.find("\"\". ");
  return at == std::string::npos ? message : message.substr(at + 4);
}

Imf::Slice make_slice(Image& image, int channel, int left, int top) {
  const std::size_t pixel = sizeof(float) * static_cast<std::size_t>(image.channels);
  return Imf::Slice::Make(Imf::FLOAT, image.values.data() + channel, Imath::V2i(left, top),
                          image.width, image.height, pixel,
                          pixel * static_cast<std::size_t>(image.width), 1, 1, 0.0);
}

}  // namespace

Image decode_exr(const std::string& bytes, const std::string& path) try {
  MemoryReader reader(bytes);
  Imf::InputFile file(reader, 1);
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  check_image_size(path, width, height, bytes.size(), exr_compression);
  const std::vector<std::string> names = choose_channels(file.header().channels(), path);
  Image image =
      make_image(static_cast<int>(width), static_cast<int>(height), static_cast<int>(names.size()));
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < names.size(); ++c)
    if (!names[c].empty())
      buffer.insert(names[c], make_slice(image, static_cast<int>(c), window.min.x, window.min.y));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return image;
} catch (const Error&) {
  throw;
} catch (const std::exception& error) {
  throw Error({.file = path, .expected = "a whole OpenEXR image", .found = shorten(error.what())});
}

std::string encode_exr(const Image& image, const std::string& path) try {
  const std::vector<const char*> names =
      image.channels == 1 ? std::vector<const char*>{"Y"} : std::vector<const char*>{"R", "G", "B"};
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < names.size(); ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
    // Slices point to writable memory, but writing a file only reads it.
    buffer.insert(names[c], make_slice(const_cast<Image&>(image), static_cast<int>(c), 0, 0));
  }
  MemoryWriter writer;
  {
    Imf::OutputFile file(writer, header, 1);
    file.setFrameBuffer(buffer);
    file.writePixels(image.height);
  }
  return std::move(writer.bytes);
} catch (const std::exception& error) {
  throw Error({.file = path, .expected = "to write OpenEXR", .found = shorten(error.what())},
              ErrorKind::resource);
}

}  // namespace parian
