// SPDX-License-Identifier: Apache-2.0
#include "tools/inspect/mcap_file.h"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <concepts>
#include <utility>

#include "common/runtime/startup_error.h"

namespace telekerf::inspect {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
constexpr std::size_t kChunkBytes = 1U << 20U;

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// Little-endian content of a record.
struct Content {
  std::string bytes;
  template <std::unsigned_integral T>
  Content& number(T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Content& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes += value;
    return *this;
  }
  Content& words(const McapFile::Words& all) {
    Content inner;
    for (const auto& [name, value] : all) inner.text(name).text(value);
    return text(inner.bytes);
  }
};

std::string record(std::uint8_t opcode, std::string_view content) {
  Content head;
  head.number(opcode).number(static_cast<std::uint64_t>(content.size()));
  head.bytes += content;
  return std::move(head.bytes);
}

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

}  // namespace

McapFile::McapFile(const std::filesystem::path& file)
    : place_(output_place(file)), out_(place_.draft, std::ios::binary) {
  if (!out_) throw environment_error(fmt::format("--mcap {}: cannot be written", place_.file.string()));
  out_ << kMagic;
  at_ = kMagic.size();
  write(kHeader, Content().text("").text("telekerf").bytes);
}

McapFile::~McapFile() {
  std::error_code ignored;
  if (!place_.straight()) std::filesystem::remove(place_.draft, ignored);  // unless it has been put in place
}

void McapFile::write(std::uint8_t opcode, const std::string& content) {
  const std::string bytes = record(opcode, content);
  out_ << bytes;
  at_ += bytes.size();
}

std::uint16_t McapFile::add_schema(const std::string& name, const std::string& encoding, const std::string& text) {
  Content content;
  content.number(++schema_count_).text(name).text(encoding).text(text);
  write(kSchema, content.bytes);
  schemas_ += record(kSchema, content.bytes);
  return schema_count_;
}

std::uint16_t McapFile::add_channel(const std::string& topic, std::uint16_t schema, const std::string& encoding,
                                    const Words& words) {
  const auto id = static_cast<std::uint16_t>(all_.size());
  all_.emplace_back();
  Content content;
  content.number(id).number(schema).text(topic).text(encoding).words(words);
  write(kChannel, content.bytes);
  channels_ += record(kChannel, content.bytes);
  return id;
}

void McapFile::add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view bytes) {
  Channel& to = all_[channel];
  if (chunk_.empty()) first_ns_ = last_ns_ = time_ns;
  first_ns_ = std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  to.index.emplace_back(time_ns, chunk_.size());
  Content content;
  content.number(channel).number(static_cast<std::uint32_t>(to.messages++)).number(time_ns).number(time_ns);
  content.bytes += bytes;
  chunk_ += record(kMessage, content.bytes);
  if (chunk_.size() >= kChunkBytes) write_chunk();
}

void McapFile::write_chunk() {
  if (chunk_.empty()) return;
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), 1);
  if (ZSTD_isError(size) != 0) throw environment_error(fmt::format("--mcap {}: zstd failed", place_.file.string()));
  packed.resize(size);
  Chunk chunk{first_ns_, last_ns_, at_, 0, 0, size, chunk_.size(), {}};
  Content content;
  content.number(first_ns_).number(last_ns_).number(static_cast<std::uint64_t>(chunk_.size())).number(crc_of(chunk_));
  content.text("zstd").number(static_cast<std::uint64_t>(size));
  content.bytes += packed;
  write(kChunk, content.bytes);
  chunk.length = at_ - chunk.place;
  for (std::size_t id = 0; id < all_.size(); ++id) {
    if (all_[id].index.empty()) continue;
    chunk.index.emplace_back(static_cast<std::uint16_t>(id), at_);
    Content places;
    for (const auto& [time_ns, place] : all_[id].index) places.number(time_ns).number(place);
    write(kMessageIndex, Content().number(static_cast<std::uint16_t>(id)).text(places.bytes).bytes);
    all_[id].index.clear();
  }
  chunk.index_length = at_ - chunk.place - chunk.length;
  chunks_.push_back(std::move(chunk));
  chunk_.clear();
}

void McapFile::add_metadata(const std::string& name, const Words& words) {
  write_chunk();
  const std::uint64_t place = at_;
  write(kMetadata, Content().text(name).words(words).bytes);
  metadata_.push_back({place, at_ - place, name});
}

void McapFile::finish() {
  write_chunk();
  write(kDataEnd, Content().number(std::uint32_t{0}).bytes);
  const std::uint64_t summary = at_;
  std::string offsets;
  const auto group = [&](std::uint8_t opcode, const std::string& records) {
    if (records.empty()) return;
    offsets += record(kSummaryOffset,
                      Content().number(opcode).number(at_).number(static_cast<std::uint64_t>(records.size())).bytes);
    out_ << records;
    at_ += records.size();
  };
  group(kSchema, schemas_);
  group(kChannel, channels_);
  std::uint64_t messages = 0, first_ns = 0, last_ns = 0;
  Content counts;
  for (std::size_t id = 0; id < all_.size(); ++id) {
    messages += all_[id].messages;
    if (all_[id].messages > 0) counts.number(static_cast<std::uint16_t>(id)).number(all_[id].messages);
  }
  std::string indices;
  for (const Chunk& chunk : chunks_) {
    first_ns = &chunk == &chunks_.front() ? chunk.first_ns : std::min(first_ns, chunk.first_ns);
    last_ns = std::max(last_ns, chunk.last_ns);
    Content places;
    for (const auto& [id, place] : chunk.index) places.number(id).number(place);
    Content content;
    content.number(chunk.first_ns).number(chunk.last_ns).number(chunk.place).number(chunk.length);
    content.text(places.bytes).number(chunk.index_length).text("zstd").number(chunk.packed).number(chunk.unpacked);
    indices += record(kChunkIndex, content.bytes);
  }
  Content statistics;
  statistics.number(messages).number(schema_count_).number(static_cast<std::uint32_t>(all_.size()));
  statistics.number(std::uint32_t{0}).number(static_cast<std::uint32_t>(metadata_.size()));
  statistics.number(static_cast<std::uint32_t>(chunks_.size())).number(first_ns).number(last_ns).text(counts.bytes);
  group(kStatistics, record(kStatistics, statistics.bytes));
  group(kChunkIndex, indices);
  std::string metadata;
  for (const Metadata& one : metadata_)
    metadata += record(kMetadataIndex, Content().number(one.place).number(one.length).text(one.name).bytes);
  group(kMetadataIndex, metadata);
  const std::uint64_t offset_start = at_;
  out_ << offsets;
  at_ += offsets.size();
  write(kFooter, Content().number(summary).number(offset_start).number(std::uint32_t{0}).bytes);
  out_ << kMagic;
  out_.close();
  std::error_code failed;
  if (out_ && !place_.straight()) std::filesystem::rename(place_.draft, place_.file, failed);
  if (!out_ || failed) throw environment_error(fmt::format("--mcap {}: cannot be written", place_.file.string()));
}

}  // namespace telekerf::inspect
