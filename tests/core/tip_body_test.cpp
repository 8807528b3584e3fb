#include <gtest/gtest.h>

#include <offnominal/model/momentum.hpp>
#include <offnominal/model/tip_body.hpp>

#include "core/model/random_chain.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

// The oracle is the chain itself with such a body on its last link: the momentum form is linear in
// it.
TEST(TipBody, IsWhatABodyOnTheLastLinkAddsToTheMomentumForm) {
  std::mt19937_64 generator = seeded_generator();
  for (int run = 0; run < 100; ++run) {
    constexpr int kJoints = 6;
    using Six = Vector<kJoints, double>;
    const auto model = make_model(random_chain<kJoints, double>(generator));
    const Vector<kTipParameters, double> theta(uniform(generator, -1, 2), uniform(generator, -1, 1),
                                               uniform(generator, -1, 1),
                                               uniform(generator, -1, 1));
    auto loaded = model;
    loaded.bodies[kJoints - 1].link.mass += theta[0];
    loaded.bodies[kJoints - 1].link.first_moment += theta.tail<3>();
    const Six q = random_vector<kJoints, double>(generator, 3);
    const Six dq = random_vector<kJoints, double>(generator, 2);
    const auto at = joint_transforms(model, q);
    const auto with = momentum_form(loaded, at, dq);
    const auto without = momentum_form(model, at, dq);
    const auto form = tip_body_form(model, at, dq);
    const Six momentum = form.momentum.transpose() * theta;
    const Six pull = form.pull.transpose() * theta;
    EXPECT_LT(deviation(momentum, with.momentum - without.momentum), 1e-12) << "run " << run;
    EXPECT_LT(deviation(pull, with.pull - without.pull), 1e-12) << "run " << run;
  }
}

}  // namespace
}  // namespace offnominal::test
