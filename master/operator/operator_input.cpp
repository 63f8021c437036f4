// SPDX-License-Identifier: Apache-2.0
#include "master/operator/hand_input.h"

#include "common/runtime/device_table.h"
#include "master/operator/udp_pedal.h"

namespace telekerf::master {
namespace {

class AlwaysPressed final : public HandInput {
 public:
  bool pressed(std::int64_t) noexcept override { return true; }
};

std::unique_ptr<HandInput> hand(std::string_view) { return nullptr; }
std::unique_ptr<HandInput> pressed(std::string_view) { return std::make_unique<AlwaysPressed>(); }
std::unique_ptr<HandInput> udp(std::string_view rest) {
  return std::make_unique<UdpPedal>(udp_address(rest));
}

using Table = DeviceTable<std::unique_ptr<HandInput>>;
constexpr Table::Kind kKinds[] = {
    {"hand", "hand", stands_alone, hand},
    {"pressed", "pressed", stands_alone, pressed},
    {"udp", "udp:HOST:PORT", complaint_about_udp, udp},
};
constexpr Table kButtons("button", kKinds);

}  // namespace

std::string button_forms() { return kButtons.forms(); }

std::string complaint_about_button(const std::string& button) { return kButtons.complaint(button); }

std::unique_ptr<HandInput> attach_button(const std::string& button) { return kButtons.attach(button); }

}  // namespace telekerf::master
