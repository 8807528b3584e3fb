#pragma once

#include <algorithm>
#include <cstddef>
#include <offnominal/controller/fault.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/hal/status.hpp>
#include <offnominal/joint_count.hpp>

// What the joints' feedback says of them, before anything is made of their numbers.

namespace offnominal::controller {

template <int N>
using FeedbackOf = PerJoint<N, hal::JointFeedback>;

// Of a frame: not what belongs to somebody else, and not the first records of a source, which are
// awaited.
[[nodiscard]] constexpr bool is_wrong(hal::Status status) {
  return status != hal::Status::kOk && status != hal::Status::kUnknownId &&
         status != hal::Status::kNotSynchronised;
}

// kNone, or the first joint's fault.
template <int N>
[[nodiscard]] Fault check_feedback(const FeedbackOf<N>& feedback) {
  for (const hal::JointFeedback& joint : feedback) {
    if (joint.encoder == hal::SourceState::kStale) return Fault::kEncoderSilent;
    if (joint.encoder == hal::SourceState::kError) return Fault::kEncoderUntrusted;
    if (joint.drive == hal::SourceState::kStale) return Fault::kDriveSilent;
    if (joint.drive == hal::SourceState::kError) return Fault::kDriveUntrusted;
    if ((joint.status.flags & (hal::kDriveFault | hal::kEncoderFault)) != 0) {
      return Fault::kDriveReported;
    }
  }
  return Fault::kNone;
}

template <int N>
[[nodiscard]] bool all_valid(const FeedbackOf<N>& feedback) {
  return std::all_of(feedback.begin(), feedback.end(), [](const hal::JointFeedback& joint) {
    return joint.encoder == hal::SourceState::kValid && joint.drive == hal::SourceState::kValid;
  });
}

template <int N>
[[nodiscard]] bool all_in_torque_mode(const FeedbackOf<N>& feedback) {
  return std::all_of(feedback.begin(), feedback.end(), [](const hal::JointFeedback& joint) {
    return joint.status.mode == hal::DriveMode::kTorque;
  });
}

}  // namespace offnominal::controller
