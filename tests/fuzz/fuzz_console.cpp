// SPDX-License-Identifier: Apache-2.0
// libFuzzer entry for what pages send: any bytes as command and as frame, and any frames at any times from a
// page that drives. Beside crashes: what reaches the hand is of the driver's lease, and fires only while
// armed.
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>

#include "master/console/driver_seat.h"

namespace {

using namespace telekerf::master;

void expect(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)parse_command({reinterpret_cast<const char*>(data), size});
  DriverSeat seat(7);
  std::int64_t now_ns = 1;
  const std::uint32_t lease = *seat.take(1, now_ns);
  const std::span bytes(data, size);
  for (std::size_t at = 0; at + sizeof(PageFrame) + 2 <= size; at += sizeof(PageFrame) + 2) {
    now_ns += std::int64_t{bytes[at]} * 1'000'000;
    seat.arm((bytes[at + 1] & 1U) != 0);
    const std::optional<PageFrame> frame =
        parse_frame(std::as_bytes(bytes.subspan(at + 2, sizeof(PageFrame))));
    if (!frame) continue;
    const std::optional<UdpHandFrame> hand = seat.hear(1 + (bytes[at + 1] & 2U), *frame, now_ns);
    if (!hand) continue;
    expect(hand->session == lease && frame->lease == lease);
    expect((hand->flags & UdpHandFrame::kTrigger) == 0 || seat.armed());
    expect(hand->x_m >= -10.0 && hand->x_m <= 10.0);
  }
  return 0;
}
