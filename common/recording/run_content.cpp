// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_content.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace telekerf::run_content {
namespace {

constexpr const char* kSum = "content_sum";
constexpr std::string_view kLeftOut[] = {kSum,   "label",          "label_text",    "CLASS",
                                         "NAME", "REFERENCE_LIST", "DIMENSION_LIST"};
constexpr hsize_t kRowsAtOnce = 4096;
constexpr std::size_t kMostBytesOfARow = 4096;
constexpr int kMostLevels = 4;

class Sum {
 public:
  void add(const void* bytes, std::size_t count) {
    sum_ = ::crc32_z(sum_, static_cast<const Bytef*>(bytes), count);
  }
  void add(std::string_view text) {
    add(text.size());
    add(text.data(), text.size());
  }
  void add(std::uint64_t number) { add(&number, sizeof number); }
  std::uint32_t value() const { return static_cast<std::uint32_t>(sum_); }

 private:
  uLong sum_ = ::crc32_z(0, nullptr, 0);
};

/// The type that values have in memory; text stays as it is.
h5::Id native(hid_t type, const std::string& what) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_STRING && H5Tis_variable_str(type) == 0) return {H5Tcopy(type), "a type cannot be copied"};
  if (kind != H5T_INTEGER && kind != H5T_FLOAT)
    throw h5::Failure(what + ": its type is none that a recording has");
  return {H5Tget_native_type(type, H5T_DIR_ASCEND), "a type is not known"};
}

void add_attributes(hid_t object, const std::string& path, Sum& sum) {
  for (const std::string& name : h5::attributes_of(object)) {
    if (std::find(std::begin(kLeftOut), std::end(kLeftOut), name) != std::end(kLeftOut)) continue;
    const std::string what = fmt::format("attribute {} of {}", name, path.empty() ? "/" : path);
    const h5::Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), "an attribute cannot be opened");
    const h5::Id type = native(h5::Id(H5Aget_type(attribute.get()), "an attribute has no type").get(), what);
    std::vector<char> bytes(h5::bytes_of_attribute(attribute.get(), type.get()));
    if (!bytes.empty() && H5Aread(attribute.get(), type.get(), bytes.data()) < 0)
      throw h5::Failure(what + " cannot be read");
    sum.add(name);
    sum.add(std::string_view(bytes.data(), bytes.size()));
  }
}

void add_dataset(hid_t dataset, const std::string& path, Sum& sum) {
  const h5::Id type = native(h5::Id(H5Dget_type(dataset), "a data set has no type").get(), path);
  const hsize_t rows = h5::rows_to_read(dataset);
  const std::size_t width = h5::width_of(dataset);
  const std::size_t row_bytes = width * H5Tget_size(type.get());
  if (row_bytes > kMostBytesOfARow)
    throw h5::Failure(path + ": its rows are longer than any that a recording has");
  sum.add(rows);
  sum.add(width);
  std::vector<char> bytes;
  for (hsize_t first = 0; first < rows; first += kRowsAtOnce) {
    const hsize_t count = std::min(kRowsAtOnce, rows - first);
    bytes.resize(count * row_bytes);
    if (!h5::read_rows(dataset, type.get(), width, first, count, bytes.data()))
      throw h5::Failure(h5::damaged_rows(path, first, count));
    sum.add(bytes.data(), bytes.size());
  }
}

void add_group(hid_t group, const std::string& path, int levels, Sum& sum) {
  if (levels == 0) throw h5::Failure(path + ": groups lie deeper than in any recording");
  add_attributes(group, path, sum);
  hsize_t count = 0;
  h5::check(H5Gget_num_objs(group, &count), "a group cannot be listed");
  for (hsize_t n = 0; n < count; ++n) {
    char name[256] = {};
    if (H5Gget_objname_by_idx(group, n, name, sizeof name) < 0)
      throw h5::Failure(path + ": cannot be listed");
    const std::string inner = path.empty() ? std::string(name) : path + "/" + name;
    sum.add(inner);
    const hid_t opened = H5Oopen(group, name, H5P_DEFAULT);
    if (opened < 0) throw h5::Failure(inner + ": cannot be opened");
    const h5::Id object(opened, "");
    if (H5Iget_type(opened) == H5I_GROUP) {
      add_group(opened, inner, levels - 1, sum);
    } else if (H5Iget_type(opened) == H5I_DATASET) {
      add_attributes(opened, inner, sum);
      add_dataset(opened, inner, sum);
    }
  }
}

}  // namespace

std::uint32_t sum_of(hid_t file) {
  Sum sum;
  const h5::Id root(H5Gopen2(file, "/", H5P_DEFAULT), "it has no root");
  add_group(root.get(), "", kMostLevels, sum);
  return sum.value();
}

void write_sum(hid_t file) { h5::set_count(file, kSum, sum_of(file)); }

void check_sum(hid_t file) {
  const std::uint32_t now = sum_of(file);
  if (h5::number_of(file, kSum) != static_cast<double>(now))
    throw h5::Failure("its contents are not those that were written: their checksum is another one");
}

}  // namespace telekerf::run_content
