// SPDX-License-Identifier: Apache-2.0
#include "master/console/hand_line.h"

#include <boost/asio/buffer.hpp>
#include <utility>

namespace telekerf::master {

HandLine::HandLine(boost::asio::io_context& context, const UdpAddress& master,
                   std::function<void(const UdpHandAnswer&)> answered)
    : socket_(context), answered_(std::move(answered)) {
  master_ = open_udp(socket_, master, "hand");
  listen();
}

void HandLine::send(const UdpHandFrame& frame) noexcept {
  boost::system::error_code ignored;
  (void)socket_.send_to(boost::asio::buffer(&frame, sizeof(frame)), master_, 0, ignored);
}

void HandLine::listen() {
  socket_.async_receive_from(boost::asio::buffer(&answer_, sizeof(answer_)), from_,
                             [this](const boost::system::error_code& error, std::size_t size) {
                               if (error == boost::asio::error::operation_aborted) return;
                               if (!error && from_ == master_ && size == sizeof(answer_) &&
                                   answer_.magic == UdpHandAnswer::kMagic &&
                                   answer_.version == UdpHandFrame::kVersion) {
                                 answered_(answer_);
                               }
                               listen();
                             });
}

}  // namespace telekerf::master
