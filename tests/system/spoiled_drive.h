// SPDX-License-Identifier: Apache-2.0
// A drive whose readings are spoiled between it and its controller.
#pragma once

#include <array>
#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstring>
#include <limits>
#include <string>
#include <thread>

namespace telekerf::integration {

/// Between a controller and its drive; hands everything on until it is told to spoil what the drive reads.
class SpoiledDrive {
  using Udp = boost::asio::ip::udp;

 public:
  explicit SpoiledDrive(const std::string& drive) {
    const std::size_t colon = drive.rfind(':');
    drive_ = {boost::asio::ip::address_v4::loopback(),
              static_cast<std::uint16_t>(std::stoi(drive.substr(colon + 1)))};
    for (auto* socket : {&controllers_, &drives_}) {
      socket->open(Udp::v4());
      socket->bind({boost::asio::ip::address_v4::loopback(), 0});
      socket->non_blocking(true);
    }
    thread_ = std::jthread([this](const std::stop_token& stop) {
      for (; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::microseconds(100))) hand_on();
    });
  }
  std::string drive() const {
    return "udp:127.0.0.1:" + std::to_string(controllers_.local_endpoint().port());
  }
  void spoil() { spoils_ = true; }

 private:
  void hand_on() {
    boost::system::error_code error;
    Udp::endpoint from;
    while (const std::size_t size = controllers_.receive_from(boost::asio::buffer(bytes_), from, 0, error)) {
      controller_ = from;
      drives_.send_to(boost::asio::buffer(bytes_, size), drive_, 0, error);
    }
    while (const std::size_t size = drives_.receive_from(boost::asio::buffer(bytes_), from, 0, error)) {
      constexpr std::size_t kSecondJoint = 40;  // docs/how-to/add-a-drive.md
      const double nonsense = std::numeric_limits<double>::quiet_NaN();
      if (spoils_) std::memcpy(bytes_.data() + kSecondJoint, &nonsense, sizeof(nonsense));
      controllers_.send_to(boost::asio::buffer(bytes_, size), controller_, 0, error);
    }
  }

  boost::asio::io_context context_;
  Udp::socket controllers_{context_}, drives_{context_};
  Udp::endpoint drive_, controller_;
  std::array<char, 512> bytes_{};
  std::atomic<bool> spoils_ = false;
  std::jthread thread_;
};

}  // namespace telekerf::integration
