// SPDX-License-Identifier: Apache-2.0
// Writes MCAP (https://mcap.dev/spec): chunks compressed with zstd, an index, statistics and metadata.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/results.h"

namespace telekerf::inspect {

class McapFile {
 public:
  using Words = std::map<std::string, std::string>;
  /// Written beside `file` and put in its place by finish(). Throws StartupError.
  explicit McapFile(const std::filesystem::path& file);
  ~McapFile();
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;

  /// Before the first message. `encoding` of the schema: "ros2msg", "jsonschema".
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& text);
  /// `encoding` of the messages: "cdr", "json".
  std::uint16_t add_channel(const std::string& topic, std::uint16_t schema, const std::string& encoding,
                            const Words& words);
  /// In order of time, ns since 1970.
  void add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view bytes);
  void add_metadata(const std::string& name, const Words& words);
  void finish();

 private:
  struct Channel {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  ///< time, place in the chunk
    std::uint64_t messages = 0;
  };
  struct Chunk {
    std::uint64_t first_ns, last_ns, place, length, index_length, packed, unpacked;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> index;
  };
  void write(std::uint8_t opcode, const std::string& content);
  void write_chunk();

  OutputPlace place_;
  std::ofstream out_;
  std::uint64_t at_ = 0;
  std::string schemas_, channels_;  ///< records, for the summary
  std::vector<Channel> all_;
  std::uint16_t schema_count_ = 0;
  std::string chunk_;
  std::uint64_t first_ns_ = 0, last_ns_ = 0;  ///< of the chunk
  std::vector<Chunk> chunks_;
  struct Metadata {
    std::uint64_t place, length;
    std::string name;
  };
  std::vector<Metadata> metadata_;
};

}  // namespace telekerf::inspect
