#include <bit>
#include <cstring>

#include "base/error.h"
#include "io/hdf5/slice_layout_internal.h"

namespace parian::hdf5 {
namespace {

constexpr std::uint64_t undefined_address = ~std::uint64_t{0};
constexpr std::size_t max_block = std::size_t{1} << 20;

// Bytes of the file with bounds-checked little-endian access; anything out of bounds makes the
// walk fail, never the program.
struct Bytes {
  std::vector<unsigned char> data;

  bool holds(std::size_t at, std::size_t count) const {
    return at <= data.size() && count <= data.size() - at;
  }
  std::uint64_t get(std::size_t at, std::size_t count) const {
    if (!holds(at, count)) throw Error({.found = "out of bounds"});
    std::uint64_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8u | data[at + i];
    return value;
  }
};

Bytes read_block(const RawFile& raw, std::uint64_t address, std::uint64_t bytes) {
  if (bytes > max_block || address > raw.size() || bytes > raw.size() - address)
    throw Error({.found = "a block outside of the file"});
  Bytes block{std::vector<unsigned char>(static_cast<std::size_t>(bytes))};
  raw.read(address, block.data.data(), block.data.size());
  return block;
}

// Version-1 object header: looks for the data layout message (type 8), version 3, chunked, and
// returns the address of its B-tree.
std::uint64_t find_tree(const RawFile& raw, std::uint64_t header_address,
                        const std::vector<std::uint64_t>& shape) {
  constexpr std::uint64_t layout_message = 8, continuation_message = 16;
  const Bytes prefix = read_block(raw, header_address, 16);
  if (prefix.get(0, 1) != 1) return undefined_address;
  struct Block {
    std::uint64_t address, bytes;
  };
  std::vector<Block> blocks{{header_address + 16, prefix.get(8, 4)}};
  for (std::size_t b = 0; b < blocks.size() && b < 64; ++b) {
    const Bytes block = read_block(raw, blocks[b].address, blocks[b].bytes);
    for (std::size_t at = 0; block.holds(at, 8);) {
      const std::uint64_t type = block.get(at, 2), size = block.get(at + 2, 2);
      const std::size_t body = at + 8;
      if (type == continuation_message)
        blocks.push_back({block.get(body, 8), block.get(body + 8, 8)});
      if (type == layout_message) {
        const std::size_t rank = shape.size();
        const bool chunked = block.get(body, 1) == 3 && block.get(body + 1, 1) == 2 &&
                             block.get(body + 2, 1) == rank + 1;
        return chunked ? block.get(body + 3, 8) : undefined_address;
      }
      at = body + static_cast<std::size_t>(size);
    }
  }
  return undefined_address;
}

struct Walk {
  const RawFile& raw;
  const std::vector<std::uint64_t>& shape;
  std::vector<Extent> extents;
  std::size_t found = 0;

  // Chunks are [1][1][H][W]: their coordinates are (channel, offset, 0, 0, 0).
  void add(const Bytes& node, std::size_t key) {
    const std::uint64_t channel = node.get(key + 8, 8), offset = node.get(key + 16, 8);
    const bool whole = channel < shape[0] && offset < shape[1] && node.get(key + 4, 4) == 0;
    const std::size_t key_bytes = 8 + 8 * (shape.size() + 1);
    const std::uint64_t bytes = node.get(key, 4), address = node.get(key + key_bytes, 8);
    if (!whole || bytes == 0) throw Error({.found = "a key that fits no slice"});
    Extent& extent = extents[static_cast<std::size_t>(channel * shape[1] + offset)];
    if (extent.bytes != 0) throw Error({.found = "a slice twice"});
    extent = {address, bytes};
    ++found;
  }

  // Keys and children alternate: key 0, child 0, key 1, ...; `level` falls to 0 at the leaves, and
  // a node holds at least one chunk, so that a damaged file cannot send the walk in circles.
  void visit(std::uint64_t address, std::uint64_t level) {
    const std::size_t entry = 8 + 8 * (shape.size() + 1) + 8;
    const Bytes head = read_block(raw, address, 24);
    const std::uint64_t used = head.get(6, 2);
    if (std::memcmp(head.data.data(), "TREE", 4) != 0 || head.get(4, 1) != 1 ||
        head.get(5, 1) != level || used == 0)
      throw Error({.found = "no chunk index"});
    const Bytes node = read_block(raw, address + 24, used * entry);
    for (std::size_t i = 0; i < used; ++i) {
      const std::size_t key = i * entry;
      if (level == 0) {
        add(node, key);
      } else {
        visit(node.get(key + entry - 8, 8), level - 1);
      }
    }
  }
};

}  // namespace

std::optional<std::vector<Extent>> walk_chunk_index(const RawFile& raw,
                                                    std::uint64_t header_address,
                                                    const std::vector<std::uint64_t>& shape) {
  try {
    const std::uint64_t tree = find_tree(raw, header_address, shape);
    if (tree == undefined_address) return {};
    Walk walk{raw, shape, std::vector<Extent>(static_cast<std::size_t>(shape[0] * shape[1]))};
    const std::uint64_t levels = read_block(raw, tree, 24).get(5, 1);
    if (levels > 8) return {};
    walk.visit(tree, levels);
    return std::move(walk.extents);
  } catch (const Error&) {
    return {};  // HDF5 will say what is wrong with it, if anything is
  }
}

}  // namespace parian::hdf5
