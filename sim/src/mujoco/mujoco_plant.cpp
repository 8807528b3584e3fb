#include "offnominal/sim/plants/mujoco_plant.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "mujoco_handle.hpp"

namespace offnominal::sim {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

using Numbers = Eigen::Map<Eigen::VectorXd>;

Matrix3d about_offset(double mass, const Vector3d& offset) {
  return mass * (offset.squaredNorm() * Matrix3d::Identity() - offset * offset.transpose());
}

MujocoInertial joined(const MujocoInertial& a, const MujocoInertial& b) {
  MujocoInertial sum;
  sum.mass = a.mass + b.mass;
  sum.centre = (a.mass * a.centre + b.mass * b.centre) / sum.mass;
  sum.tensor = a.tensor + about_offset(a.mass, a.centre - sum.centre) + b.tensor +
               about_offset(b.mass, b.centre - sum.centre);
  return sum;
}

MujocoInertial inertial_of(const mjModel& model, int body) {
  const mjtNum* const q = model.body_iquat + 4 * body;
  const Matrix3d turn = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  MujocoInertial inertial;
  inertial.mass = model.body_mass[body];
  inertial.centre = Eigen::Map<const Vector3d>(model.body_ipos + 3 * body);
  const Vector3d moments = Eigen::Map<const Vector3d>(model.body_inertia + 3 * body);
  inertial.tensor = turn * moments.asDiagonal() * turn.transpose();
  return inertial;
}

void put(const MujocoInertial& inertial, int body, mjModel& model) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(inertial.tensor);
  Matrix3d turn = axes.eigenvectors();
  if (turn.determinant() < 0) turn.col(0) = -turn.col(0);
  const Eigen::Quaterniond q(turn);
  model.body_mass[body] = inertial.mass;
  Eigen::Map<Vector3d>(model.body_ipos + 3 * body) = inertial.centre;
  Eigen::Map<Vector3d>(model.body_inertia + 3 * body) = axes.eigenvalues();
  Eigen::Map<Eigen::Vector4d>(model.body_iquat + 4 * body) << q.w(), q.x(), q.y(), q.z();
}

}  // namespace

struct MujocoPlant::Simulation {
  struct Payload {
    double mass = 0;
    Vector3d at = Vector3d::Zero();
  };

  struct Push {
    int body = 0;
    Vector3d force, at;
  };

  explicit Simulation(const mjModel& original, MujocoIntegrator integrator)
      : model(mj_copyModel(nullptr, &original)) {
    if (!model) throw std::runtime_error("MuJoCo: no memory for the model");
    const int joints = model->nv;
    model->opt.integrator = integrator == MujocoIntegrator::kEuler ? mjINT_EULER : mjINT_RK4;
    model->opt.disableflags |= mjDSBL_ACTUATION;
    // Inertias change: what it knows of bodies whose inertia lies along their frame holds no
    // longer.
    std::fill_n(model->body_simple, model->nbody, mjtByte{0});
    std::fill_n(model->body_sameframe, model->nbody, mjtByte{0});
    std::fill_n(model->dof_simplenum, joints, 0);
    for (int body = 0; body < model->nbody; ++body) links.push_back(inertial_of(*model, body));
    payloads.resize(static_cast<std::size_t>(joints));
    losses.assign(static_cast<std::size_t>(joints), 0.0);
    friction.assign(model->dof_frictionloss, model->dof_frictionloss + joints);
    data.reset(mj_makeData(model.get()));
    scratch.reset(mj_makeData(model.get()));
    if (!data || !scratch) throw std::runtime_error("MuJoCo: no memory for the state");
  }

  // Of a joint's link: what the file says, less what is lost, with the payload, if any.
  void put_link(std::size_t joint) {
    const int body = model->jnt_bodyid[joint];
    MujocoInertial link = links[static_cast<std::size_t>(body)];
    link.mass *= 1 - losses[joint];
    link.tensor *= 1 - losses[joint];
    const Payload& payload = payloads[joint];
    if (payload.mass != 0) link = joined(link, {payload.mass, payload.at, Matrix3d::Zero()});
    if (joint + 1 == payloads.size() && gained != 0) {
      const Vector3d centre = links[static_cast<std::size_t>(body)].centre;
      link = joined(link, {gained, centre, Matrix3d::Zero()});
    }
    put(link, body, *model);
    // What follows from masses: it is computed at the reference position, in a state of its own.
    mj_setConst(model.get(), scratch.get());
  }

  void set_substep(double h_s) {
    if (model->opt.timestep == h_s) return;
    model->opt.timestep = h_s;
    for (int i = 0; i < model->nv; ++i) {
      // MuJoCo takes no time constant below two steps. The impedance leaves 1e-4 of a push at rest.
      model->dof_solref[mjNREF * i] = 2 * h_s;
      model->dof_solref[mjNREF * i + 1] = 1;
      const mjtNum impedance[mjNIMP]{0.9999, 0.9999, 0.001, 0.5, 2};
      std::copy_n(impedance, mjNIMP, model->dof_solimp + mjNIMP * i);
    }
  }

  // Faults as far as they have developed, and none that was there before; 0 of them: the plant
  // without.
  void put_faults(const std::vector<FaultEvent>& faults, double t_s, double share) {
    std::copy(friction.begin(), friction.end(), model->dof_frictionloss);
    double payload = 0;
    lost.assign(losses.size(), 0.0);
    for (const FaultEvent& fault : faults) {
      const double size = share * fault.size * fault.developed(t_s);
      if (fault.kind == FaultEventKind::kFrictionJump) {
        if (fault.is_active(t_s)) model->dof_frictionloss[fault.joint] += share * fault.size;
      } else if (fault.kind == FaultEventKind::kPayload) {
        payload += size;
      } else if (fault.kind == FaultEventKind::kMassLoss) {
        double& of_link = lost[static_cast<std::size_t>(std::max(fault.joint, 0))];
        of_link = 1 - (1 - of_link) * (1 - size);
      }
    }
    for (std::size_t joint = 0; joint < losses.size(); ++joint) {
      const bool carries = joint + 1 == losses.size() && payload != gained;
      if (!carries && lost[joint] == losses[joint]) continue;
      losses[joint] = lost[joint];
      if (carries) gained = payload;
      put_link(joint);
    }
  }

  // MuJoCo takes them at the centre of mass, which is where the last step found it.
  void put_pushes() {
    std::fill_n(data->xfrc_applied, 6 * model->nbody, 0.0);
    for (const Push& push : pushes) {
      const Vector3d centre = Eigen::Map<const Vector3d>(model->body_ipos + 3 * push.body);
      const Vector3d arm = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
                               data->xmat + 9 * push.body) *
                           (push.at - centre);
      Eigen::Map<Eigen::Matrix<double, 6, 1>>(data->xfrc_applied + 6 * push.body) << push.force,
          arm.cross(push.force);
    }
  }

  [[nodiscard]] bool has_run_away() const {
    return data->warning[mjWARN_BADQPOS].number > 0 || data->warning[mjWARN_BADQVEL].number > 0 ||
           data->warning[mjWARN_BADQACC].number > 0;
  }

  void put_state(const JointVector& q, const JointVector& dq, mjData& into) const {
    Numbers(into.qpos, model->nv) = q;
    Numbers(into.qvel, model->nv) = dq;
  }

  JointVector acceleration(const JointState& state, const JointVector& tau) const {
    put_state(state.q, state.dq, *scratch);
    Numbers(scratch->qacc_warmstart, model->nv).setZero();
    Numbers(scratch->qfrc_applied, model->nv) = tau;
    std::copy_n(data->xfrc_applied, 6 * model->nbody, scratch->xfrc_applied);
    mj_forward(model.get(), scratch.get());
    return Numbers(scratch->qacc, model->nv);
  }

  MujocoModelPointer model;
  MujocoDataPointer data;
  MujocoDataPointer scratch;
  std::vector<MujocoInertial> links;  // per body, as the file has them
  std::vector<Payload> payloads;
  std::vector<double> losses;    // share of each link, by faults
  std::vector<double> lost;      // room for what they are to be
  double gained = 0;             // on the last link, kg, by faults
  std::vector<double> friction;  // without faults
  std::vector<Push> pushes;
};

MujocoPlant::MujocoPlant(const MujocoModel& model, const MujocoSetup& setup)
    : simulation_(std::make_unique<Simulation>(*model.handle_->model, setup.integrator)),
      longest_substep_s_(setup.longest_substep_s),
      state_(setup.start),
      gear_torque_(JointVector::Zero(setup.start.q.size())) {
  const Index joints = simulation_->model->nv;
  if (setup.start.q.size() != joints || setup.start.dq.size() != joints) {
    throw std::invalid_argument("MuJoCo plant: a start of " + std::to_string(setup.start.q.size()) +
                                " joints, the model has " + std::to_string(joints));
  }
  if (!(setup.longest_substep_s > 0)) {
    throw std::invalid_argument("MuJoCo plant: longest_substep_s must be above 0");
  }
  take_faults(setup.faults);
  simulation_->put_state(state_.q, state_.dq, *simulation_->data);
  mj_kinematics(simulation_->model.get(), simulation_->data.get());
}

MujocoPlant::~MujocoPlant() = default;

void MujocoPlant::take_faults(const std::vector<FaultEvent>& faults) {
  const Index joints = simulation_->model->nv;
  std::vector<FaultEvent> acting;
  for (const FaultEvent& fault : faults) {
    const bool acts = fault.kind == FaultEventKind::kMassLoss ||
                      fault.kind == FaultEventKind::kPayload ||
                      fault.kind == FaultEventKind::kFrictionJump;
    if (!acts) continue;
    if (fault.joint >= joints || (fault.joint < 0 && fault.kind == FaultEventKind::kFrictionJump)) {
      throw std::invalid_argument("MuJoCo plant: a fault of joint " +
                                  std::to_string(fault.joint + 1) + ", the model has " +
                                  std::to_string(joints));
    }
    acting.push_back(fault);
  }
  faults_ = std::move(acting);
}

bool MujocoPlant::set_faults(const std::vector<FaultEvent>& faults) {
  take_faults(faults);
  // Until the next step, which develops them.
  simulation_->put_faults({}, 0, 0);
  return true;
}

void MujocoPlant::step(double t_s, const JointVector& tau, double period_s) {
  Simulation& now = *simulation_;
  mjModel& model = *now.model;
  mjData& data = *now.data;
  const int substeps = static_cast<int>(std::ceil(period_s / longest_substep_s_ - 1e-9));
  now.set_substep(period_s / substeps);
  Numbers applied(data.qfrc_applied, model.nv);
  for (int i = 0; i < substeps; ++i) {
    now.put_faults(faults_, t_s + i * model.opt.timestep, 1.0);
    applied = tau;
    now.put_pushes();
    mj_step(&model, &data);
    if (now.has_run_away()) {
      throw std::runtime_error(
          "MuJoCo plant: its motion has run away at t = " + std::to_string(t_s) + " s");
    }
  }
  state_ = {Numbers(data.qpos, model.nv), Numbers(data.qvel, model.nv)};
  gear_torque_ = tau + Numbers(data.qfrc_constraint, model.nv) +
                 Numbers(data.qfrc_passive, model.nv) -
                 Numbers(model.dof_armature, model.nv).cwiseProduct(Numbers(data.qacc, model.nv));
}

JointVector MujocoPlant::fault_function(double t_s, const JointVector& tau) const {
  if (faults_.empty()) return JointVector::Zero(state_.q.size());
  simulation_->put_faults(faults_, t_s, 1.0);
  const JointVector with = simulation_->acceleration(state_, tau);
  simulation_->put_faults(faults_, t_s, 0.0);
  JointVector difference = with - simulation_->acceleration(state_, tau);
  simulation_->put_faults(faults_, t_s, 1.0);
  return difference;
}

void MujocoPlant::set_friction_loss(Index joint, double level) {
  simulation_->friction.at(static_cast<std::size_t>(joint)) = level;
}

void MujocoPlant::set_damping(Index joint, double coefficient) {
  simulation_->model->dof_damping[joint] = coefficient;
}

void MujocoPlant::set_payload(Index joint, double mass_kg, const Vector3d& at_m) {
  const auto index = static_cast<std::size_t>(joint);
  simulation_->payloads.at(index) = {mass_kg, at_m};
  simulation_->put_link(index);
}

void MujocoPlant::push(Index joint, const Vector3d& force_n, const Vector3d& at_m) {
  const int body = simulation_->model->jnt_bodyid[joint];
  std::erase_if(simulation_->pushes, [&](const auto& one) { return one.body == body; });
  if (!force_n.isZero(0)) simulation_->pushes.push_back({body, force_n, at_m});
}

JointVector MujocoPlant::inverse_dynamics(const DesiredMotion& motion) const {
  mjModel& model = *simulation_->model;
  mjData& scratch = *simulation_->scratch;
  simulation_->put_state(motion.q, motion.dq, scratch);
  Numbers(scratch.qacc, model.nv) = motion.ddq;
  std::fill_n(scratch.xfrc_applied, 6 * model.nbody, 0.0);
  const int flags = model.opt.disableflags;
  model.opt.disableflags |= mjDSBL_FRICTIONLOSS | mjDSBL_LIMIT;
  mj_inverse(&model, &scratch);
  model.opt.disableflags = flags;
  return Numbers(scratch.qfrc_inverse, model.nv);
}

double MujocoPlant::energy_j() const {
  simulation_->put_state(state_.q, state_.dq, *simulation_->scratch);
  mjData& scratch = *simulation_->scratch;
  mj_fwdPosition(simulation_->model.get(), &scratch);
  mj_energyPos(simulation_->model.get(), &scratch);
  mj_energyVel(simulation_->model.get(), &scratch);
  return scratch.energy[0] + scratch.energy[1];
}

}  // namespace offnominal::sim
