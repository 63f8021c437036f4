// SPDX-License-Identifier: Apache-2.0
// A foreign peer in Telekerf's cell: announces an event, waits for the latched contour and one state block, prints both.
// Usage: cyclone_peer DOMAIN CELL CONTRACT           the conversation above
//        cyclone_peer DOMAIN CELL CONTRACT keys STORE   as the cell's peer: the contour and a state, then tries to command
//        cyclone_peer DOMAIN CELL CONTRACT ROLE      says a hundred times what a master says, as this ROLE; "-": unnamed
#include <dds/dds.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "telekerf.h"

static dds_qos_t* qos_of(const char* cell, int reliable, int latched) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, cell);
  dds_qset_reliability(qos, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
  dds_qset_durability(qos, latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, latched ? 1 : 16);
  return qos;
}

// Takes one sample into *sample, within 20 s. Exits with 1 if none comes.
static void take_one(dds_entity_t reader, void** sample, const char* what) {
  dds_sample_info_t info;
  for (int i = 0; i < 2000; ++i) {
    if (dds_take(reader, sample, &info, 1, 1) > 0 && info.valid_data) return;
    dds_sleepfor(DDS_MSECS(10));
  }
  fprintf(stderr, "no %s\n", what);
  exit(1);
}

static uint64_t number_at(const uint8_t* at, int bytes) {
  uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= (uint64_t)at[i] << 8 * i;
  return value;
}

// A block that carries its set (docs/reference/block.md). Returns its contract.
static uint16_t print_state(const uint8_t* block, uint32_t length) {
  const uint8_t* const set = block + 5;
  if (length < 5 + 78 + 84 || (block[4] & 0x60) != 0x60 || set[36] != 1 || set[47] != 1) {
    fprintf(stderr, "no state with a set\n");
    exit(1);
  }
  const uint8_t* const fields = set + 78;
  const uint8_t* const rest = fields + 84;
  const uint32_t number = (uint32_t)number_at(fields, 4);
  const unsigned size = (unsigned)number_at(fields + 82, 2);
  const unsigned sequence = (number + (unsigned)number_at(set + 45, 2)) & 0xffff;
  unsigned octets = 0;
  for (int i = 0; i < 8; ++i) octets = octets * 31u + set[37 + i];
  octets = (octets * 31u + (sequence >> 8)) * 31u + (sequence & 0xff);
  for (unsigned i = 0; i < size; ++i) octets = octets * 31u + rest[i];
  printf("state %u %" PRIu64 " %.9g %.9g %d %" PRId64 " %u %u\n", (unsigned)number, number_at(fields + 56, 8),
         (int32_t)number_at(fields + 32, 4) / 16777216.0, (int32_t)number_at(fields + 36, 4) / 65536.0, (int)set[74],
         (int64_t)number_at(fields + 72, 8), size + 10, octets);
  return (uint16_t)number_at(set, 2);
}

// Within 20 s.
static void wait_for_reader(dds_entity_t writer) {
  for (int i = 0; i < 2000; ++i) {
    dds_publication_matched_status_t status;
    dds_get_publication_matched_status(writer, &status);
    if (status.current_count > 0) break;
    dds_sleepfor(DDS_MSECS(10));
  }
}

// Presence as the IDL has it: little-endian plain CDR in USER_DATA.
struct bytes {
  unsigned char data[512];
  size_t size;
};

static void put(struct bytes* to, const void* value, size_t size, size_t align) {
  while (to->size % align != 0) to->data[to->size++] = 0;
  memcpy(to->data + to->size, value, size);
  to->size += size;
}

static void put_text(struct bytes* to, const char* text) {
  const uint32_t size = (uint32_t)strlen(text) + 1;
  put(to, &size, sizeof size, 4);
  put(to, text, size, 1);
}

static dds_qos_t* announced(const char* cell, uint16_t contract, const char* role, uint32_t epoch) {
  struct bytes presence = {.size = 0};
  const unsigned char joined = 1;
  put(&presence, &contract, sizeof contract, 2);
  put_text(&presence, cell);
  put_text(&presence, role);
  put_text(&presence, "cyclone");
  put(&presence, &epoch, sizeof epoch, 4);
  put(&presence, &joined, 1, 1);
  put_text(&presence, "foreign");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_userdata(qos, presence.data, presence.size);
  return qos;
}

// Blocks that a reader takes for damaged, so that nobody follows them: that it counts them is all that is asked.
static int command(dds_entity_t participant, const char* cell) {
  const dds_entity_t topic =
      dds_create_topic(participant, &telekerf_wire_CommandBlock_desc, "telekerf/command", NULL, NULL);
  dds_qos_t* in_cell = qos_of(cell, 0, 0);
  const dds_entity_t publisher = dds_create_publisher(participant, in_cell, NULL);
  const dds_entity_t writer = dds_create_writer(publisher, topic, in_cell, NULL);
  dds_delete_qos(in_cell);
  telekerf_wire_CommandBlock block;
  memset(&block, 0, sizeof block);
  wait_for_reader(writer);
  for (int i = 0; i < 100; ++i) {
    dds_write(writer, &block);
    dds_sleepfor(DDS_MSECS(10));
  }
  dds_delete(participant);
  return 0;
}

static void set_file(dds_qos_t* qos, const char* name, const char* store, const char* file) {
  char value[1024];
  snprintf(value, sizeof value, "file:%s/%s", store, file);
  dds_qset_prop(qos, name, value);
}

static void set_library(dds_qos_t* qos, const char* what, const char* library, const char* function) {
  static const char* const parts[] = {"path", "init", "finalize"};
  for (int i = 0; i < 3; ++i) {
    char name[128], value[256];
    snprintf(name, sizeof name, "dds.sec.%s.library.%s", what, parts[i]);
    if (i == 0) {
      snprintf(value, sizeof value, "%s/libdds_security_%s.so", CYCLONE_PLUGINS, library);
    } else {
      snprintf(value, sizeof value, "%s_%s", parts[i], function);
    }
    dds_qset_prop(qos, name, value);
  }
}

static dds_qos_t* with_keys(const char* store, const char* cell) {
  dds_qos_t* qos = dds_create_qos();
  char file[512];
  set_library(qos, "auth", "auth", "authentication");
  set_library(qos, "access", "ac", "access_control");
  set_library(qos, "crypto", "crypto", "crypto");
  set_file(qos, "dds.sec.auth.identity_ca", store, "identity_ca.pem");
  set_file(qos, "dds.sec.access.permissions_ca", store, "permissions_ca.pem");
  set_file(qos, "dds.sec.access.governance", store, "governance.smime");
  snprintf(file, sizeof file, "cells/%s/peer/cert.pem", cell);
  set_file(qos, "dds.sec.auth.identity_certificate", store, file);
  snprintf(file, sizeof file, "cells/%s/peer/key.pem", cell);
  set_file(qos, "dds.sec.auth.private_key", store, file);
  snprintf(file, sizeof file, "cells/%s/peer/permissions.smime", cell);
  set_file(qos, "dds.sec.access.permissions", store, file);
  return qos;
}

static void try_to_command(dds_entity_t participant, const char* cell) {
  const dds_entity_t topic =
      dds_create_topic(participant, &telekerf_wire_CommandBlock_desc, "telekerf/command", NULL, NULL);
  dds_qos_t* in_cell = qos_of(cell, 0, 0);
  const dds_entity_t writer =
      topic < 0 ? topic : dds_create_writer(dds_create_publisher(participant, in_cell, NULL), topic, in_cell, NULL);
  dds_delete_qos(in_cell);
  printf("commands: %s\n", writer < 0 ? "refused" : "accepted");
}

int main(int argc, char** argv) {
  const int secured = argc == 6 && strcmp(argv[4], "keys") == 0;
  if (argc != 4 && argc != 5 && !secured) return 2;
  const uint16_t own_contract = (uint16_t)atoi(argv[3]);
  const char* role = argc == 5 ? argv[4] : "console";
  dds_qos_t* presence = secured                   ? with_keys(argv[5], argv[2])
                        : strcmp(role, "-") == 0 ? NULL
                                                 : announced(argv[2], own_contract, role, 7);
  const dds_entity_t participant = dds_create_participant((dds_domainid_t)atoi(argv[1]), presence, NULL);
  dds_delete_qos(presence);
  if (participant < 0) {
    fprintf(stderr, "no participant\n");
    return 1;
  }
  if (argc == 5) return command(participant, argv[2]);
  const dds_entity_t contours =
      dds_create_topic(participant, &telekerf_wire_Contour_desc, "telekerf/contour", NULL, NULL);
  const dds_entity_t states =
      dds_create_topic(participant, &telekerf_wire_StateBlock_desc, "telekerf/state", NULL, NULL);
  // A peer with keys may only listen.
  const dds_entity_t events =
      secured ? 0 : dds_create_topic(participant, &telekerf_wire_Event_desc, "telekerf/event", NULL, NULL);

  // The partition belongs to publisher and subscriber.
  dds_qos_t* in_cell = qos_of(argv[2], 0, 0);
  const dds_entity_t subscriber = dds_create_subscriber(participant, in_cell, NULL);
  const dds_entity_t publisher = dds_create_publisher(participant, in_cell, NULL);
  dds_qos_t* latched = qos_of(argv[2], 1, 1);
  dds_qos_t* reliable = qos_of(argv[2], 1, 0);
  const dds_entity_t contour_reader = dds_create_reader(subscriber, contours, latched, NULL);
  const dds_entity_t state_reader = dds_create_reader(subscriber, states, in_cell, NULL);
  const dds_entity_t event_writer = secured ? 0 : dds_create_writer(publisher, events, reliable, NULL);
  dds_delete_qos(in_cell);
  dds_delete_qos(latched);
  dds_delete_qos(reliable);

  void* sample = telekerf_wire_Contour__alloc();
  take_one(contour_reader, &sample, "contour");
  const telekerf_wire_Contour* contour = sample;
  double sum = 0.0;
  for (uint32_t i = 0; i < contour->points._length; ++i) {
    sum += contour->points._buffer[i].x_m - 2.0 * contour->points._buffer[i].y_m;
  }
  printf("contour %u %u %d %s %s %u %.17g\n", (unsigned)contour->contract, (unsigned)contour->id, contour->closed,
         contour->source, contour->mode, (unsigned)contour->points._length, sum);
  telekerf_wire_Contour_free(sample, DDS_FREE_ALL);

  sample = telekerf_wire_StateBlock__alloc();
  take_one(state_reader, &sample, "state");
  const telekerf_wire_StateBlock* state = sample;
  const uint16_t contract = print_state(state->octets._buffer, state->octets._length);
  telekerf_wire_StateBlock_free(sample, DDS_FREE_ALL);

  if (secured) {
    try_to_command(participant, argv[2]);
    dds_delete(participant);
    return 0;
  }
  telekerf_wire_Event event = {.contract = contract, .epoch = 7, .kind = 2, .value = 0.5, .text = "from elsewhere"};
  wait_for_reader(event_writer);
  dds_write(event_writer, &event);
  dds_wait_for_acks(event_writer, DDS_SECS(10));
  dds_delete(participant);
  return 0;
}
