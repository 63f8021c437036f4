// SPDX-License-Identifier: Apache-2.0
// As much of HDF5's C interface as a recording needs, with owners and exceptions. HDF5 itself is not made for
// several threads: whoever owns a file is alone with the library's calls at that time, see `library()`.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace telekerf::h5 {

/// HDF5 did not do it. The sentence says what.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Held around every call: one thread at a time.
std::recursive_mutex& library();

/// Owns an identifier of any kind.
class Id {
 public:
  Id() = default;
  /// Throws Failure with `what` if `id` is none.
  Id(hid_t id, const char* what) : id_(id) {
    if (id_ < 0) throw Failure(what);
  }
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Id() { close(); }
  void close() noexcept;
  hid_t get() const noexcept { return id_; }
  explicit operator bool() const noexcept { return id_ >= 0; }

 private:
  hid_t id_ = -1;
};

/// Throws Failure with `what` if `status` is an error's.
void check(herr_t status, const char* what);

/// In this thread: errors are said in our own words.
void prepare();
/// `newest`: a new file in the format that SWMR needs; otherwise one that HDF5 1.8 reads, in place of any.
Id create_file(const std::filesystem::path& path, bool newest);
/// A finished file, or one that is being written or was left by a killed process. Throws Failure that says
/// whether it is missing, a folder, no HDF5 file, or one that is cut off or damaged, and what to do.
Id open_file(const std::filesystem::path& path);

Id make_group(hid_t file, const std::string& name);
bool has(hid_t where, const std::string& name);

void set_text(hid_t object, const char* name, const std::string& text);
void set_texts(hid_t object, const char* name, const std::vector<std::string>& texts);
void set_number(hid_t object, const char* name, double number);
void set_count(hid_t object, const char* name, std::uint64_t number);
std::optional<std::string> text_of(hid_t object, const char* name);
std::vector<std::string> texts_of(hid_t object, const char* name);
std::optional<double> number_of(hid_t object, const char* name);
std::vector<std::string> attributes_of(hid_t object);

/// A dataset that grows in rows of `width` (1: a plain list) of `type`. `packed`: shuffled, compressed and
/// with a checksum.
Id make_dataset(hid_t where, const std::string& name, hid_t type, std::size_t width, bool packed);
hsize_t rows_of(hid_t dataset);
/// Likewise, of a file that nobody may trust: throws Failure if what is stored cannot be so many rows.
hsize_t rows_to_read(hid_t dataset);
/// Numbers or texts a row. Throws Failure: it is no list and no table.
std::size_t width_of(hid_t dataset);
/// What an attribute takes in memory as `type`. Throws Failure if that is more than any recording has.
std::size_t bytes_of_attribute(hid_t attribute, hid_t type);
/// "tool: rows 4096 to 8191 are damaged".
std::string damaged_rows(const std::string& dataset, hsize_t first, hsize_t rows);
/// After the last row.
void append(hid_t dataset, hid_t memory_type, std::size_t width, std::size_t rows, const void* data);
/// False: damaged there.
bool read_rows(hid_t dataset, hid_t memory_type, std::size_t width, hsize_t first, hsize_t rows, void* out);
/// Text of this length, ended by zeros.
Id text_type(std::size_t length);

}  // namespace telekerf::h5
