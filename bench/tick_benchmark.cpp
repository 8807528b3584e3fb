#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/monitor.hpp>
#include <string>
#include <vector>

#include "heap_counter.hpp"
#include "ratio_table.hpp"
#include "tick_alone.hpp"
#include "tick_rig.hpp"

// One control tick of the paper's two-link arm, beside its parts and beside the least that learning
// needs: one forward and gradient evaluation of the same network, written in plain Eigen. And ticks
// of larger arms: this unit holds all sizes, as a program for several robots does, and what that
// costs is the ratio of a tick here to the same one from a unit of its own (tick_alone.cpp).

namespace offnominal::bench {
namespace {

constexpr int kJoints = 2;
constexpr int kHidden = 35;

// Runs body(k) once per iteration and reports the heap calls of all iterations together.
template <typename Body>
void measure(benchmark::State& state, Body&& body) {
  std::size_t k = 0;
  std::uint64_t calls = 0;
  // The harness allocates outside of its loop only.
  const std::uint64_t before = heap_calls();
  for (auto _ : state) {
    body(k);
    k = (k + 1) % kSamples;
    calls = heap_calls() - before;
  }
  state.counters["heap_calls"] = static_cast<double>(calls);
}

template <int N, int L, typename Scalar>
void tick(benchmark::State& state, Scalar extra_torque, bool expect_adapting) {
  const auto rig = std::make_unique<TickRig<N, L, Scalar>>(extra_torque, expect_adapting);
  measure(state, [&](std::size_t k) {
    const Status status = rig->step(k);
    benchmark::DoNotOptimize(status);
    benchmark::DoNotOptimize(rig->output());
  });
}

void tick_of_unit(benchmark::State& state, std::unique_ptr<tick_alone::Ticks> (*ticks)()) {
  const std::unique_ptr<tick_alone::Ticks> alone = ticks();
  measure(state, [&](std::size_t k) { alone->step(k); });
}

template <typename Scalar>
void forward_and_gradient(benchmark::State& state) {
  constexpr int kInputs = kNetworkInputs<kJoints>;
  using Hidden = Eigen::Matrix<Scalar, kHidden, 1>;
  const auto start = initial_weights<kJoints, kHidden, Scalar>(1, kHidden, Scalar(0.1));
  const Eigen::Matrix<Scalar, kHidden, kInputs> w1 = start.w1.template topRows<kHidden>();
  const Eigen::Matrix<Scalar, kJoints, kHidden> w2 =
      Eigen::Matrix<Scalar, kJoints, kHidden>::Constant(Scalar(0.1));
  RigidBodyModel<kJoints, Scalar> model = make_model(arm<kJoints, Scalar>().chain);
  const auto run = samples<kJoints, Scalar>(model, Scalar(0));
  const Eigen::Matrix<Scalar, kJoints, 1> d(Scalar(0.3), Scalar(-0.2));
  Eigen::Matrix<Scalar, kHidden, kInputs> gradient_w1;
  Eigen::Matrix<Scalar, kJoints, kHidden> gradient_w2;
  Eigen::Matrix<Scalar, kJoints, 1> y;
  measure(state, [&](std::size_t k) {
    const auto z = network_input<kJoints, Scalar>(run[k].q, run[k].dq, run[k].tau);
    const Hidden pre = w1 * z;
    const Hidden sigma = (Scalar(0.5) * pre.array()).tanh();
    y.noalias() = w2 * sigma;
    const Hidden b = (w2.transpose() * d).array() * (Scalar(0.5) * (1 - sigma.array().square()));
    gradient_w1.noalias() = b * z.transpose();
    gradient_w2.noalias() = d * sigma.transpose();
    benchmark::DoNotOptimize(y);
    benchmark::DoNotOptimize(gradient_w1);
    benchmark::DoNotOptimize(gradient_w2);
  });
}

template <typename Scalar>
void dynamics(benchmark::State& state) {
  const RigidBodyModel<kJoints, Scalar> model = make_model(arm<kJoints, Scalar>().chain);
  const auto run = samples<kJoints, Scalar>(model, Scalar(0));
  ForwardDynamics<kJoints, Scalar> result;
  measure(state, [&](std::size_t k) {
    const Status status = forward_dynamics(model, run[k].q, run[k].dq, run[k].tau, 0.0, result);
    benchmark::DoNotOptimize(status);
    benchmark::DoNotOptimize(result);
  });
}

template <typename Function>
void add(const std::string& name, Function function) {
  benchmark::RegisterBenchmark(name.c_str(), function)->Repetitions(9)->ReportAggregatesOnly(true);
}

template <int N, int L, typename Scalar>
void add_ticks(const std::string& size) {
  add("tick_healthy" + size,
      [](benchmark::State& state) { tick<N, L, Scalar>(state, Scalar(0), false); });
  add("tick_adapting" + size,
      [](benchmark::State& state) { tick<N, L, Scalar>(state, Scalar(60), true); });
}

template <typename Scalar>
void add_all(const std::string& scalar) {
  add("forward_and_gradient/2x35" + scalar, forward_and_gradient<Scalar>);
  add("forward_dynamics/2x35" + scalar, dynamics<Scalar>);
  add_ticks<kJoints, kHidden, Scalar>("/2x35" + scalar);
  add_ticks<6, 35, Scalar>("/6x35" + scalar);
  add_ticks<7, 64, Scalar>("/7x64" + scalar);
}

// The same tick from a unit that holds nothing else, and what it is compared with.
struct Alone {
  const char* size;
  std::unique_ptr<tick_alone::Ticks> (*ticks)();
};
constexpr std::array<Alone, 4> kAlone{{{"/2x35/float", tick_alone::ticks_2x35_float},
                                       {"/2x35/double", tick_alone::ticks_2x35_double},
                                       {"/7x64/float", tick_alone::ticks_7x64_float},
                                       {"/7x64/double", tick_alone::ticks_7x64_double}}};

std::vector<RatioReporter::Reference> references() {
  std::vector<RatioReporter::Reference> all;
  for (const Alone& alone : kAlone) {
    const std::string size = alone.size;
    all.push_back({"tick_adapting" + size, "tick_adapting_alone" + size});
  }
  all.push_back({"/2x35/float", "forward_and_gradient/2x35/float"});
  all.push_back({"/2x35/double", "forward_and_gradient/2x35/double"});
  return all;
}

}  // namespace
}  // namespace offnominal::bench

int main(int argc, char** argv) {
  using namespace offnominal::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_all<float>("/float");
  add_all<double>("/double");
  for (const Alone& alone : kAlone) {
    add(std::string("tick_adapting_alone") + alone.size,
        [&alone](benchmark::State& state) { tick_of_unit(state, alone.ticks); });
  }
  RatioReporter reporter(references());
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_table();
  benchmark::Shutdown();
  return 0;
}
