// SPDX-License-Identifier: Apache-2.0
#include "common/bus/contour_subscriber.h"

#include <gtest/gtest.h>

#include "tests/unit/bus/cell.h"
#include "tests/unit/bus/samples.h"

namespace telekerf {
namespace {

struct Prepared {
  explicit Prepared(std::uint32_t contour, double with) : id(contour), scale(with) { ++living; }
  ~Prepared() { --living; }
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;
  std::uint32_t id;
  double scale;
  static inline std::atomic<int> living{0};
};

class Contours : public testing::Test {
 protected:
  void publish(std::uint32_t id) {
    samples::Random random(id);
    ContourMessage contour = samples::contour(random, 20);
    contour.id = id;
    ASSERT_TRUE(writer.write(contour));
  }
  bool sees(std::uint32_t id) {
    return soon([&] {
      const Prepared* const now = subscriber.current();
      return now != nullptr && now->id == id;
    });
  }

  Bus vision{settings("vision", Site::kSlave)};
  Bus slave{settings("slave", Site::kSlave)};
  Writer<ContourMessage> writer{vision};
  std::atomic<double> scale{1.0};
  std::atomic<bool> too_large{false};
  ContourSubscriber<Prepared> subscriber{slave, [&](const ContourMessage& contour) {
                                           if (too_large) throw StartupError("too large");
                                           return std::make_unique<Prepared>(contour.id, scale);
                                         }};
};

TEST_F(Contours, ManyComeAndFewStay) {
  EXPECT_EQ(subscriber.current(), nullptr);
  for (std::uint32_t id = 1; id <= 30; ++id) {
    publish(id);
    ASSERT_TRUE(sees(id));
    EXPECT_EQ(subscriber.message().id, id);
  }
  EXPECT_TRUE(soon([&] {
    (void)subscriber.current();
    return Prepared::living == 1;
  }));
}

TEST_F(Contours, ARebuildTakesTheNewestAgain) {
  publish(7);
  ASSERT_TRUE(sees(7));
  scale = 0.5;
  subscriber.request_rebuild();
  EXPECT_TRUE(soon([&] { return subscriber.current()->scale == 0.5; }));
  EXPECT_EQ(subscriber.current()->id, 7u);
  too_large = true;  // then what was in force stays, and nothing ends
  scale = 2.0;
  subscriber.request_rebuild();
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(subscriber.current()->scale, 0.5);
  EXPECT_FALSE(subscriber.refused());
}

TEST_F(Contours, ARefusedContourEndsItWithTheSentence) {
  too_large = true;
  publish(1);
  ASSERT_TRUE(soon([&] { return subscriber.refused(); }));
  EXPECT_EQ(subscriber.refusal(), "too large");
  EXPECT_EQ(subscriber.current(), nullptr);
}

}  // namespace
}  // namespace telekerf
