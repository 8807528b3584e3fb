#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/monitor.hpp>

#include "heap_counter.hpp"
#include "ratio_table.hpp"

// One control tick of the paper's two-link arm, beside its parts and beside the least that learning
// needs: one forward and gradient evaluation of the same network, written in plain Eigen.

namespace offnominal::bench {
namespace {

constexpr int kJoints = 2;
constexpr int kHidden = 35;
constexpr std::size_t kSamples = 1024;  // a power of two; about one second of the paper's motion

template <typename Scalar>
using PaperMonitor = Monitor<kJoints, kHidden, Scalar>;

void require(Status status) {
  if (status == Status::kOk) return;
  std::fprintf(stderr, "benchmark set-up failed: %s\n", name_of(status));
  std::exit(2);
}

template <typename Scalar>
MonitorConfig<kJoints, Scalar> paper_arm() {
  MonitorConfig<kJoints, Scalar> config;
  config.chain.gravity_m_s2 = {0, static_cast<Scalar>(-9.81), 0};
  for (Joint<Scalar>& joint : config.chain.joints) joint.centre_of_mass_m = {1, 0, 0};
  config.chain.joints[0].mass_kg = Scalar(0.5);
  config.chain.joints[1].mass_kg = 2;
  config.chain.joints[1].origin_m = {1, 0, 0};
  config.bound.kind = BoundKind::kScaledNorm;
  config.bound.scale = static_cast<Scalar>(4.4);
  config.bound.matrix = {2, -6, 0, 0};
  config.torque_signal = TorqueSignal::kHeld;
  config.max_compensation = {50, 50};
  return config;
}

// The paper's motion with the torque that the model asks for, plus `extra_torque` on both joints: 0
// leaves the estimator in its dead-zone, 60 N m keeps it adapting.
template <typename Scalar>
std::array<JointSample<kJoints, Scalar>, kSamples> samples(
    const RigidBodyModel<kJoints, Scalar>& model, Scalar extra_torque) {
  std::array<JointSample<kJoints, Scalar>, kSamples> result;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double t = 0.001 * static_cast<double>(k);
    const auto pair = [](double first, double second) {
      return Vector<kJoints, Scalar>(static_cast<Scalar>(first), static_cast<Scalar>(second));
    };
    result[k].q = pair(0.18 * std::sin(2 * t), 0.21 * std::sin(3 * t));
    result[k].dq = pair(0.36 * std::cos(2 * t), 0.63 * std::cos(3 * t));
    const Vector<kJoints, Scalar> ddq = pair(-0.72 * std::sin(2 * t), -1.89 * std::sin(3 * t));
    result[k].tau = inverse_dynamics(model, result[k].q, result[k].dq, ddq, Scalar(0));
    result[k].tau.array() += extra_torque;
  }
  return result;
}

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

template <typename Scalar>
void tick(benchmark::State& state, Scalar extra_torque, bool expect_adapting) {
  PaperMonitor<Scalar> monitor;
  require(PaperMonitor<Scalar>::create(paper_arm<Scalar>(), monitor));
  const auto run = samples<Scalar>(monitor.model(), extra_torque);
  typename PaperMonitor<Scalar>::State monitor_state;
  typename PaperMonitor<Scalar>::Output output;
  require(monitor.reset(run[0], monitor_state));
  for (std::size_t k = 1; k < kSamples; ++k) require(monitor.step(run[k], monitor_state, output));
  if (output.detector.latched != expect_adapting) require(Status::kNotInitialised);
  measure(state, [&](std::size_t k) {
    const Status status = monitor.step(run[k], monitor_state, output);
    benchmark::DoNotOptimize(status);
    benchmark::DoNotOptimize(output);
  });
}

template <typename Scalar>
void forward_and_gradient(benchmark::State& state) {
  constexpr int kInputs = kNetworkInputs<kJoints>;
  using Hidden = Eigen::Matrix<Scalar, kHidden, 1>;
  const auto start = initial_weights<kJoints, kHidden, Scalar>(1, kHidden, Scalar(0.1));
  const Eigen::Matrix<Scalar, kHidden, kInputs> w1 = start.w1.template topRows<kHidden>();
  const Eigen::Matrix<Scalar, kJoints, kHidden> w2 =
      Eigen::Matrix<Scalar, kJoints, kHidden>::Constant(Scalar(0.1));
  RigidBodyModel<kJoints, Scalar> model = make_model(paper_arm<Scalar>().chain);
  const auto run = samples<Scalar>(model, Scalar(0));
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
  const RigidBodyModel<kJoints, Scalar> model = make_model(paper_arm<Scalar>().chain);
  const auto run = samples<Scalar>(model, Scalar(0));
  ForwardDynamics<kJoints, Scalar> result;
  measure(state, [&](std::size_t k) {
    const Status status =
        forward_dynamics(model, run[k].q, run[k].dq, run[k].tau, Scalar(0), result);
    benchmark::DoNotOptimize(status);
    benchmark::DoNotOptimize(result);
  });
}

template <typename Scalar>
void register_all(const std::string& scalar) {
  const auto add = [&](const std::string& name, auto function) {
    benchmark::RegisterBenchmark((name + "/" + scalar).c_str(), function)
        ->Repetitions(9)
        ->ReportAggregatesOnly(true);
  };
  add("forward_and_gradient", forward_and_gradient<Scalar>);
  add("forward_dynamics", dynamics<Scalar>);
  add("tick_healthy", [](benchmark::State& state) { tick<Scalar>(state, Scalar(0), false); });
  add("tick_adapting", [](benchmark::State& state) { tick<Scalar>(state, Scalar(60), true); });
}

}  // namespace
}  // namespace offnominal::bench

int main(int argc, char** argv) {
  using namespace offnominal::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  register_all<float>("float");
  register_all<double>("double");
  RatioReporter reporter(
      {{"/float", "forward_and_gradient/float"}, {"/double", "forward_and_gradient/double"}});
  std::printf("two-link arm, %d hidden units, one Runge-Kutta step per tick\n", kHidden);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_table();
  benchmark::Shutdown();
  return 0;
}
