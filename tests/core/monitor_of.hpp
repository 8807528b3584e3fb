#pragma once

#include <gtest/gtest.h>

#include "core/watched_arm.hpp"

namespace offnominal::test {

// A monitor of the watched arm, as created, in both precisions.
template <typename Scalar>
class MonitorOf : public testing::Test {
 protected:
  using Watched = typename WatchedArm<Scalar>::Watch;

  void SetUp() override { ASSERT_EQ(Watched::create(arm_config<Scalar>(), monitor), Status::kOk); }

  Watched monitor;
  typename Watched::State state;
  typename Watched::Output output;
};

using Scalars = testing::Types<float, double>;

}  // namespace offnominal::test
