// SPDX-License-Identifier: Apache-2.0
// Somebody with a DDS library and some keys, who commands a slave: nothing is checked beforehand, all is
// tried. Usage: rogue DOMAIN CELL TRIES [property=value ..] Writes TRIES blocks to telekerf/command and says
// "commanded N, readers M"; or what the library refused it.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <string>
#include <thread>

#include "common/bus/middleware.h"
#include "common/bus/topics.h"
#include "common/bus/wire_messages.h"
#include "common/protocol/contract_version.h"

namespace telekerf {
namespace {

namespace dds = eprosima::fastdds::dds;
using namespace std::chrono_literals;

int refused(const char* what) {
  std::printf("refused: no %s\n", what);
  std::fflush(stdout);
  std::_Exit(0);  // a participant with a refused writer does not survive its end
}

/// A master that has joined, in the name of which it speaks.
std::vector<std::uint8_t> lie(const std::string& cell) {
  return bus::presence_bytes({.contract = kContractVersion,
                              .cell = cell,
                              .role = "master",
                              .name = "rogue",
                              .epoch = 1,
                              .joined = true,
                              .version = "rogue"});
}

int run(int argc, char** argv) {
  const std::string cell = argv[2];
  const int tries = std::atoi(argv[3]);
  setenv("SKIP_DEFAULT_XML", "1", 1);
  dds::Log::SetVerbosity(dds::Log::Error);
  dds::DomainParticipantQos qos;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>()};
  qos.user_data().data_vec(lie(cell));
  for (int i = 4; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t equal = word.find('=');
    qos.properties().properties().emplace_back(word.substr(0, equal), word.substr(equal + 1));
  }
  auto* const factory = dds::DomainParticipantFactory::get_instance();
  auto* const participant = factory->create_participant(static_cast<unsigned>(std::atoi(argv[1])), qos);
  if (participant == nullptr) return refused("participant");
  dds::TypeSupport type(new wire::CommandBlockPubSubType);
  type.register_type(participant);
  dds::PublisherQos in_cell;
  in_cell.partition().push_back(cell.c_str());
  auto* const publisher = participant->create_publisher(in_cell);
  auto* const topic =
      participant->create_topic("telekerf/command", type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) return refused("topic");
  dds::DataWriterQos writing;
  writing.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  writing.data_sharing().off();
  writing.user_data().data_vec(lie(cell));
  auto* const writer = publisher->create_datawriter(topic, writing);
  if (writer == nullptr) return refused("writer");

  dds::PublicationMatchedStatus matched;
  for (int n = 0; n < 150 && matched.current_count == 0; ++n) {
    std::this_thread::sleep_for(20ms);
    writer->get_publication_matched_status(matched);
  }
  wire::CommandBlock block;
  int said = 0;
  for (int n = 0; n < tries; ++n) {
    block.octets().assign(60, static_cast<std::uint8_t>(n));
    said += middleware::succeeded(writer->write(&block)) ? 1 : 0;
    std::this_thread::sleep_for(200us);
  }
  writer->get_publication_matched_status(matched);
  std::printf("commanded %d, readers %d\n", said, matched.current_count);
  participant->delete_contained_entities();
  factory->delete_participant(participant);
  return 0;
}

}  // namespace
}  // namespace telekerf

int main(int argc, char** argv) { return argc < 4 ? 2 : telekerf::run(argc, argv); }
