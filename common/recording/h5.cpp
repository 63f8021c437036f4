// SPDX-License-Identifier: Apache-2.0
#include "common/recording/h5.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace telekerf::h5 {
namespace {

// A chunk that is not full is written anew by every flush, so while recording they are small.
constexpr hsize_t kLiveRows = 256;
constexpr hsize_t kPackedRows = 4096;
// Of a file that nobody may trust: sizes beyond these are damage.
constexpr std::size_t kMostBytesOfAnAttribute = std::size_t{1} << 24U;
constexpr hsize_t kMostCompression = 1100;  // deflate makes one byte of 1032 at the most

Id scalar() { return {H5Screate(H5S_SCALAR), "a scalar cannot be described"}; }

void write_attribute(hid_t object, const char* name, hid_t type, hid_t space, const void* data) {
  const Id attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT),
                     "an attribute cannot be made");
  check(H5Awrite(attribute.get(), type, data), "an attribute cannot be written");
}

std::string trimmed(const char* text, std::size_t length) {
  return {text, static_cast<std::size_t>(std::find(text, text + length, '\0') - text)};
}

}  // namespace

std::recursive_mutex& library() {
  static std::recursive_mutex mutex;
  return mutex;
}

void Id::close() noexcept {
  if (id_ < 0) return;
  const hid_t id = std::exchange(id_, -1);
  switch (H5Iget_type(id)) {
    case H5I_FILE:
      H5Fclose(id);
      break;
    case H5I_GROUP:
      H5Gclose(id);
      break;
    case H5I_DATASET:
      H5Dclose(id);
      break;
    case H5I_DATASPACE:
      H5Sclose(id);
      break;
    case H5I_DATATYPE:
      H5Tclose(id);
      break;
    case H5I_ATTR:
      H5Aclose(id);
      break;
    default:
      H5Pclose(id);
  }
}

void check(herr_t status, const char* what) {
  if (status < 0) throw Failure(what);
}

void prepare() {
  // A file that a full disk has kept from being closed is closed once more at the process' end, which crashes
  // (HDF5 1.10). What we open we close.
  [[maybe_unused]] static const herr_t asked = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Id create_file(const std::filesystem::path& path, bool newest) {
  prepare();
  const Id access(H5Pcreate(H5P_FILE_ACCESS), "no file access");
  check(newest ? H5Pset_libver_bounds(access.get(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST)
               : H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18),
        "the format is not known");
  const unsigned how = newest ? H5F_ACC_EXCL : H5F_ACC_TRUNC;
  return {H5Fcreate(path.c_str(), how, H5P_DEFAULT, access.get()), "the file cannot be made"};
}

Id open_file(const std::filesystem::path& path) {
  prepare();
  const hid_t plain = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (plain >= 0) return {plain, ""};
  // What a writer is at reads wrongly for a moment; HDF5 tries again after 1, 2, 4, ... ns. Of its 100
  // attempts the last would come after more than an age: a damaged piece would be waited for without an end.
  constexpr unsigned kAttempts = 24;  // 17 ms
  const Id access(H5Pcreate(H5P_FILE_ACCESS), "no file access");
  check(H5Pset_metadata_read_attempts(access.get(), kAttempts), "no number of attempts can be set");
  const hid_t live = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.get());
  if (live >= 0) return {live, ""};
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw Failure("it is a folder; name a file in it, such as master.h5");
  if (!std::filesystem::exists(path, error))
    throw Failure("it is not there; `telekerf-inspect runs` lists what is");
  if (std::filesystem::file_size(path, error) == 0 && !error)
    throw Failure("it is empty: its disk was full, or it was cut off; copy it again from where it was recorded");
  if (H5Fis_hdf5(path.c_str()) > 0)
    throw Failure("it is HDF5, but cut off or damaged; copy it again from where it was recorded");
  return {-1, "it is no HDF5 file; name the recording of a process, such as master.h5"};
}

Id make_group(hid_t file, const std::string& name) {
  return {H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "a group cannot be made"};
}

bool has(hid_t where, const std::string& name) { return H5Lexists(where, name.c_str(), H5P_DEFAULT) > 0; }

Id text_type(std::size_t length) {
  Id type(H5Tcopy(H5T_C_S1), "no text");
  check(H5Tset_size(type.get(), std::max<std::size_t>(length, 1)), "no text");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "no text");
  return type;
}

void set_text(hid_t object, const char* name, const std::string& text) {
  write_attribute(object, name, text_type(text.size()).get(), scalar().get(), text.c_str());
}

void set_texts(hid_t object, const char* name, const std::vector<std::string>& texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string all;
  for (const std::string& text : texts) (all += text).resize((&text - texts.data() + 1) * length, '\0');
  const hsize_t count = texts.size();
  const Id space(H5Screate_simple(1, &count, nullptr), "a list cannot be described");
  write_attribute(object, name, text_type(length).get(), space.get(), all.data());
}

void set_number(hid_t object, const char* name, double number) {
  write_attribute(object, name, H5T_NATIVE_DOUBLE, scalar().get(), &number);
}

void set_count(hid_t object, const char* name, std::uint64_t number) {
  write_attribute(object, name, H5T_NATIVE_UINT64, scalar().get(), &number);
}

std::vector<std::string> texts_of(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Id attribute(H5Aopen(object, name, H5P_DEFAULT), "an attribute cannot be opened");
  const Id type(H5Aget_type(attribute.get()), "an attribute has no type");
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0) return {};
  const std::size_t length = H5Tget_size(type.get());
  std::string all(bytes_of_attribute(attribute.get(), type.get()), '\0');
  const std::size_t count = length == 0 ? 0 : all.size() / length;
  check(H5Aread(attribute.get(), type.get(), all.data()), "an attribute cannot be read");
  std::vector<std::string> texts;
  for (std::size_t n = 0; n < count; ++n) texts.push_back(trimmed(all.data() + n * length, length));
  return texts;
}

std::optional<std::string> text_of(hid_t object, const char* name) {
  auto texts = texts_of(object, name);
  if (texts.empty()) return std::nullopt;
  return std::move(texts.front());
}

std::optional<double> number_of(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const Id attribute(H5Aopen(object, name, H5P_DEFAULT), "an attribute cannot be opened");
  double number = 0;
  if (bytes_of_attribute(attribute.get(), H5T_NATIVE_DOUBLE) != sizeof number) return std::nullopt;
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &number) < 0) return std::nullopt;
  return number;
}

std::vector<std::string> attributes_of(hid_t object) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5A_info_t*, void* to) -> herr_t {
    static_cast<std::vector<std::string>*>(to)->emplace_back(name);
    return 0;
  };
  check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names), "attributes cannot be listed");
  return names;
}

Id make_dataset(hid_t where, const std::string& name, hid_t type, std::size_t width, bool packed) {
  const int rank = width > 1 ? 2 : 1;
  const std::array<hsize_t, 2> now{0, width};
  const std::array<hsize_t, 2> most{H5S_UNLIMITED, width};
  const std::array<hsize_t, 2> chunk{packed ? kPackedRows : kLiveRows, width};
  const Id space(H5Screate_simple(rank, now.data(), most.data()), "a dataset cannot be described");
  const Id how(H5Pcreate(H5P_DATASET_CREATE), "a dataset cannot be described");
  check(H5Pset_chunk(how.get(), rank, chunk.data()), "a dataset cannot be cut into chunks");
  if (packed) {
    check(H5Pset_shuffle(how.get()), "HDF5 cannot shuffle");
    check(H5Pset_deflate(how.get(), 1), "HDF5 cannot compress");
    check(H5Pset_fletcher32(how.get()), "HDF5 cannot sum");
  }
  return {H5Dcreate2(where, name.c_str(), type, space.get(), H5P_DEFAULT, how.get(), H5P_DEFAULT),
          "a dataset cannot be made"};
}

hsize_t rows_of(hid_t dataset) {
  const Id space(H5Dget_space(dataset), "a dataset has no size");
  std::array<hsize_t, 2> size{};
  if (H5Sget_simple_extent_ndims(space.get()) > 2) throw Failure("a dataset has too many dimensions");
  check(H5Sget_simple_extent_dims(space.get(), size.data(), nullptr), "a dataset has no size");
  return size[0];
}

std::size_t width_of(hid_t dataset) {
  const Id space(H5Dget_space(dataset), "a dataset has no size");
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank != 1 && rank != 2) throw Failure("a dataset is neither a list nor a table");
  std::array<hsize_t, 2> size{0, 1};
  check(H5Sget_simple_extent_dims(space.get(), size.data(), nullptr), "a dataset has no size");
  return static_cast<std::size_t>(size[1]);
}

hsize_t rows_to_read(hid_t dataset) {
  const hsize_t rows = rows_of(dataset);
  const Id type(H5Dget_type(dataset), "a dataset has no type");
  const auto width = static_cast<hsize_t>(width_of(dataset));
  const hsize_t row_bytes = std::max<hsize_t>(width * H5Tget_size(type.get()), 1);
  if (width > kMostBytesOfAnAttribute || row_bytes > kMostBytesOfAnAttribute ||
      rows > H5Dget_storage_size(dataset) * kMostCompression / row_bytes)
    throw Failure("a dataset says that it has more rows than the file can hold");
  return rows;
}

std::size_t bytes_of_attribute(hid_t attribute, hid_t type) {
  const Id space(H5Aget_space(attribute), "an attribute has no size");
  const auto count =
      static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space.get()), 0));
  const std::size_t size = H5Tget_size(type);
  if (count > kMostBytesOfAnAttribute || size > kMostBytesOfAnAttribute ||
      count * size > kMostBytesOfAnAttribute)
    throw Failure("an attribute says that it is longer than any that a recording has");
  return count * size;
}

std::string damaged_rows(const std::string& dataset, hsize_t first, hsize_t rows) {
  return fmt::format("{}: rows {} to {} are damaged", dataset, first, first + rows - 1);
}

void append(hid_t dataset, hid_t memory_type, std::size_t width, std::size_t rows, const void* data) {
  if (rows == 0) return;
  const int rank = width > 1 ? 2 : 1;
  const std::array<hsize_t, 2> first{rows_of(dataset), 0};
  const std::array<hsize_t, 2> size{first[0] + rows, width};
  const std::array<hsize_t, 2> count{rows, width};
  check(H5Dset_extent(dataset, size.data()), "a dataset cannot grow");
  const Id space(H5Dget_space(dataset), "a dataset has no size");
  check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr),
        "rows cannot be named");
  const Id memory(H5Screate_simple(rank, count.data(), nullptr), "rows cannot be described");
  check(H5Dwrite(dataset, memory_type, memory.get(), space.get(), H5P_DEFAULT, data),
        "rows cannot be written");
}

bool read_rows(hid_t dataset, hid_t memory_type, std::size_t width, hsize_t first, hsize_t rows, void* out) {
  if (rows == 0) return true;
  const int rank = width > 1 ? 2 : 1;
  const std::array<hsize_t, 2> from{first, 0};
  const std::array<hsize_t, 2> count{rows, width};
  const Id space(H5Dget_space(dataset), "a dataset has no size");
  if (H5Sget_simple_extent_ndims(space.get()) != rank) return false;
  const Id memory(H5Screate_simple(rank, count.data(), nullptr), "rows cannot be described");
  return H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr) >= 0 &&
         H5Dread(dataset, memory_type, memory.get(), space.get(), H5P_DEFAULT, out) >= 0;
}

}  // namespace telekerf::h5
