// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_cells.h"

#include <algorithm>

namespace telekerf::run_cells {
namespace {

struct Member {
  std::string name;
  h5::Id type;
  std::size_t offset;
  std::size_t size;
};

std::vector<Member> members_of(hid_t type) {
  std::vector<Member> members;
  for (int n = 0; n < H5Tget_nmembers(type); ++n) {
    const auto index = static_cast<unsigned>(n);
    char* const name = H5Tget_member_name(type, index);
    Member member{name, h5::Id(H5Tget_member_type(type, index), "a member has no type"),
                  H5Tget_member_offset(type, index), 0};
    H5free_memory(name);
    member.size = H5Tget_size(member.type.get());
    members.push_back(std::move(member));
  }
  return members;
}

}  // namespace

void write(hid_t where, const std::string& name, hid_t type, const std::vector<std::byte>& cells) {
  const h5::Id group = h5::make_group(where, name);
  const std::size_t width = H5Tget_size(type);
  const std::size_t rows = cells.size() / width;
  std::vector<std::byte> column;
  for (const Member& member : members_of(type)) {
    column.resize(rows * member.size);
    for (std::size_t n = 0; n < rows; ++n)
      std::copy_n(cells.data() + n * width + member.offset, member.size, column.data() + n * member.size);
    const h5::Id dataset = h5::make_dataset(group.get(), member.name, member.type.get(), 1, true);
    h5::append(dataset.get(), member.type.get(), 1, rows, column.data());
  }
}

std::vector<std::byte> read(hid_t where, const std::string& name, hid_t type) {
  const std::size_t width = H5Tget_size(type);
  std::vector<std::byte> cells;
  if (const hid_t one = H5Dopen2(where, name.c_str(), H5P_DEFAULT); one >= 0) {
    const h5::Id dataset(one, "");
    cells.resize(h5::rows_to_read(dataset.get()) * width);
    if (!h5::read_rows(dataset.get(), type, 1, 0, cells.size() / width, cells.data()))
      throw h5::Failure(h5::damaged_rows(name, 0, cells.size() / width));
    return cells;
  }
  const h5::Id group(H5Gopen2(where, name.c_str(), H5P_DEFAULT), "a list is missing");
  std::vector<std::byte> column;
  const std::vector<Member> members = members_of(type);
  for (const Member& member : members) {
    const h5::Id dataset(H5Dopen2(group.get(), member.name.c_str(), H5P_DEFAULT), "a dataset is missing");
    const std::size_t rows = h5::rows_to_read(dataset.get());
    if (&member != &members.front() && rows * width != cells.size())
      throw h5::Failure(name + "/" + member.name + ": has another number of rows than its neighbours");
    column.resize(rows * member.size);
    cells.resize(rows * width);
    if (!h5::read_rows(dataset.get(), member.type.get(), 1, 0, rows, column.data()))
      throw h5::Failure(h5::damaged_rows(name + "/" + member.name, 0, rows));
    for (std::size_t n = 0; n < rows; ++n)
      std::copy_n(column.data() + n * member.size, member.size, cells.data() + n * width + member.offset);
  }
  return cells;
}

}  // namespace telekerf::run_cells
