// SPDX-License-Identifier: Apache-2.0
// Plain CDR (little-endian, no encapsulation) of a wire type, with Fast CDR 1 (Debian 12) and 2 (Debian 13).
// Inside the bus only.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/Exception.h>
#if __has_include(<telekerfCdrAux.hpp>)
#include <fastcdr/CdrSizeCalculator.hpp>
#include <fastcdr/exceptions/NotEnoughMemoryException.h>
#include <telekerf.hpp>
#include <telekerfCdrAux.hpp>
#else
#include <telekerf.h>
#endif

#include <cstddef>
#include <span>

namespace telekerf::bus {

/// Into `room`; the number of bytes written. Throws eprosima::fastcdr::exception::Exception where it is too
/// small.
template <class Wire>
std::size_t write_cdr(const Wire& wire, std::span<char> room) {
  using eprosima::fastcdr::Cdr;
  eprosima::fastcdr::FastBuffer buffer(room.data(), room.size());
#if __has_include(<telekerfCdrAux.hpp>)
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::CdrVersion::XCDRv1);
  cdr << wire;
  return cdr.get_serialized_data_length();
#else
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::CORBA_CDR);
  wire.serialize(cdr);
  return cdr.getSerializedDataLength();
#endif
}

/// Throws eprosima::fastcdr::exception::Exception where the bytes are none of its kind. They are not changed.
template <class Wire>
void read_cdr(std::span<char> bytes, Wire& wire) {
  using eprosima::fastcdr::Cdr;
  eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
#if __has_include(<telekerfCdrAux.hpp>)
  constexpr auto kVersion = eprosima::fastcdr::CdrVersion::XCDRv1;
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, kVersion);
  cdr >> wire;
  // Where the bytes end between two members, this release is content and leaves the rest as it was.
  std::size_t alignment = 0;
  if (eprosima::fastcdr::CdrSizeCalculator(kVersion).calculate_serialized_size(wire, alignment) > bytes.size())
    throw eprosima::fastcdr::exception::NotEnoughMemoryException("the bytes end before the message does");
#else
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::CORBA_CDR);
  wire.deserialize(cdr);
#endif
}

}  // namespace telekerf::bus
