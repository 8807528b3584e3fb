#include "offnominal/sim/hidden/case.hpp"

#include <utility>

#include "offnominal/sim/hidden/closed_loop.hpp"
#include "offnominal/sim/hidden/data_fault.hpp"
#include "offnominal/sim/hidden/draw_robot.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;

constexpr double kHoldoutS = 15.0;
// Runs of a robot: what is drawn per run differs between them.
constexpr std::uint64_t kRecordingRun = 0, kHoldoutRun = 1, kGivenRun = 2;

LogFault log_fault(const Request& request) {
  return draw_log_fault(request.fault, Draws(request.seed, Stream::kDataFault));
}

Recording log_of(const Trace& trace, const Request& request, const Nominal& nominal,
                 std::uint64_t run) {
  Recording log{trace.t_s, trace.encoder_q, trace.commanded_nm};
  Draws noise(request.seed, Stream::kNoise, run);
  for (Index k = 0; k < log.t_s.size(); ++k) {
    for (Index j = 0; j < 2; ++j) {
      const double limit = nominal.joints[static_cast<std::size_t>(j)].torque_limit_nm;
      log.tau(k, j) += request.torque_noise_share * limit * noise.gaussian();
    }
  }
  // Draws of the robot's own fault come first in its stream; each run's bursts have another.
  return with_fault(std::move(log), log_fault(request),
                    Draws(request.seed, Stream::kDataFault, run + 1));
}

Recording run(const DrawnRobot& drawn, const Request& request, const Motion& motion,
              double duration_s, std::uint64_t run_index) {
  const std::vector<Contact> contacts =
      draw_contacts(drawn.robot, duration_s, Draws(request.seed, Stream::kContact, run_index));
  const Trace trace = run_closed_loop(drawn.robot, drawn.nominal, motion, contacts,
                                      {duration_s, request.sample_rate_hz, request.encoder_bits});
  return log_of(trace, request, drawn.nominal, run_index);
}

}  // namespace

Case make_case(const Request& request) {
  const DrawnRobot drawn = draw_robot(request);
  Case made;
  made.nominal = drawn.nominal;
  made.truth = drawn.truth;
  made.truth.fault_parameters = parameters(log_fault(request));
  made.recording = run(drawn, request, drawn_motion(request, drawn.centre_rad, Stream::kMotion),
                       request.duration_s, kRecordingRun);
  made.holdout =
      run(drawn, request, drawn_motion(request, drawn.centre_rad, Stream::kHoldoutMotion),
          kHoldoutS, kHoldoutRun);
  return made;
}

Recording record_motion(const Request& request, const Eigen::VectorXd& t_s,
                        const Eigen::MatrixXd& q_desired, std::uint64_t run_index) {
  const Motion motion = given_motion(t_s, q_desired);
  const double duration_s = t_s[t_s.size() - 1];
  return run(draw_robot(request), request, motion, duration_s, kGivenRun + run_index);
}

}  // namespace offnominal::sim::hidden
