// SPDX-License-Identifier: Apache-2.0
#include "master/operator/operator_input.h"

#include "common/runtime/device_registry.h"
#include "master/operator/udp_foot_switch.h"

namespace telekerf::master {
namespace {

class AlwaysPressed final : public OperatorInput {
 public:
  bool pressed(std::int64_t) noexcept override { return true; }
};

std::unique_ptr<OperatorInput> hand(std::string_view) { return nullptr; }
std::unique_ptr<OperatorInput> pressed(std::string_view) { return std::make_unique<AlwaysPressed>(); }
std::unique_ptr<OperatorInput> udp(std::string_view rest) {
  return std::make_unique<UdpFootSwitch>(udp_address(rest));
}

using Table = DeviceRegistry<std::unique_ptr<OperatorInput>>;
constexpr Table::Kind kKinds[] = {
    {"hand", "hand", stands_alone, hand},
    {"pressed", "pressed", stands_alone, pressed},
    {"udp", "udp:HOST:PORT", complaint_about_udp, udp},
};
constexpr Table kButtons("button", kKinds);

}  // namespace

std::string button_forms() { return kButtons.forms(); }

std::string complaint_about_button(const std::string& button) { return kButtons.complaint(button); }

std::unique_ptr<OperatorInput> attach_button(const std::string& button) { return kButtons.attach(button); }

}  // namespace telekerf::master
