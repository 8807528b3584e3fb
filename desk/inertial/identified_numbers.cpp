#include "inertial/identified_numbers.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/inverse_model.hpp"
#include "identify/add_setup.hpp"
#include "identify/combinations.hpp"
#include "identify/sign_width.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A combination of the unknowns that is told of, and the joint that shows most of it.
struct Told {
  IdentifiedNumber* number = nullptr;
  VectorXd of_unknowns;
  Index joint = 0;
};

double rotor_of(const RobotDescription& robot, std::size_t joint) {
  double inertia = 0;
  for (const RobotEffect& effect : robot.effects) {
    if (effect.joint == joint && !effect.of_motor) inertia += reflected_inertia_of(effect);
  }
  return inertia;
}

class FittedNumbers {
 public:
  FittedNumbers(const InertialFit& fit, const IdentifyRequest& request, Identification& result)
      : fit_(fit),
        request_(request),
        result_(result),
        base_(base_parameters(fit.file(), fit.base_request())),
        slopes_(slopes_at(fit.model(), fit.point())),
        priors_(priors_of(fit.model(), fit.share())),
        equations_(fit.reduced().weighted(fit.joint_weights())) {
    hold_what_is_at_an_end();
  }

  void put() {
    judge_unknowns();
    // Filled once and for all: what is told points into them.
    result_.links.resize(fit_.model().links.size());
    result_.base.resize(static_cast<std::size_t>(base_.count()));
    for (std::size_t i = 0; i < result_.links.size(); ++i) tell_link(i);
    tell_drives();
    for (Index i = 0; i < base_.count(); ++i) tell_base(i);
    if (request_.payload) tell_payload();
    estimate();
    result_.condition = condition();
  }

 private:
  [[nodiscard]] Index unknowns() const { return slopes_.cols(); }
  [[nodiscard]] Index first_linear() const {
    return static_cast<Index>(fit_.model().links.size()) * kInertialNumbers;
  }

  // Where a column of the design stands among the unknowns; -1: in a link.
  [[nodiscard]] Index unknown_of_column(Index column) const {
    const auto& linear = fit_.model().linear;
    const auto at = std::find(linear.begin(), linear.end(), column);
    return at == linear.end() ? -1 : first_linear() + (at - linear.begin());
  }

  void hold_what_is_at_an_end() {
    const ConsistentModel& model = fit_.model();
    for (std::size_t i = 0; i < model.linear.size(); ++i) {
      const double x = fit_.point().linear[static_cast<Index>(i)];
      const Prior& prior = model.priors[i];
      constexpr double kRounding = 1e-9;
      const double wide = kRounding * (1 + std::abs(x));
      if (x > prior.low + wide && x < prior.high - wide) continue;
      priors_[static_cast<std::size_t>(first_linear()) + i] = Prior::at(x);
    }
  }

  // How far the unknowns are open to the data, whatever was believed of the links: of them alone,
  // and with the recordings.
  void judge_unknowns() {
    constexpr double kOpen = 1;  // share
    std::vector<Prior> open = priors_of(fit_.model(), kOpen);
    MatrixXd information = equations_.columns * slopes_;
    for (Index i = 0; i < unknowns(); ++i) {
      if (priors_[static_cast<std::size_t>(i)].is_held()) information.col(i).setZero();
    }
    MatrixXd normal = information.transpose() * information;
    before_ = VectorXd::Zero(unknowns());
    const double squared = fit_.prior_weight() * fit_.prior_weight();
    for (Index i = 0; i < unknowns(); ++i) {
      const Prior& prior = open[static_cast<std::size_t>(i)];
      if (!prior.is_informative()) continue;
      before_[i] = prior.deviation * prior.deviation;
      normal(i, i) += squared / before_[i];
    }
    const VectorXd size = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = size.asDiagonal() * normal * size.asDiagonal();
    after_ =
        squared * (size.asDiagonal() * scaled.completeOrthogonalDecomposition().pseudoInverse() *
                   size.asDiagonal());
  }

  [[nodiscard]] bool is_determined(const VectorXd& of_unknowns) const {
    constexpr double kSharper = 5;
    const double before = of_unknowns.cwiseAbs2().dot(before_);
    const double after = of_unknowns.dot(after_ * of_unknowns);
    return before > 0 && after >= 0 && kSharper * kSharper * after < before;
  }

  void tell(IdentifiedNumber& number, VectorXd of_unknowns, Index joint) {
    number.determined = is_determined(of_unknowns);
    told_.push_back({&number, std::move(of_unknowns), joint});
  }

  // The joint on which a column of the design is seen most.
  [[nodiscard]] Index joint_of_column(Index column) const {
    Index joint = 0;
    const VectorXd energy = fit_.data().layout.energy(
        fit_.data().layout.weighted(fit_.columns().col(column), fit_.joint_weights()));
    energy.maxCoeff(&joint);
    return joint;
  }

  // Mass and place of the centre from ten numbers, and how they change with the unknowns.
  void tell_body(const InertialNumbers& before, const InertialNumbers& after,
                 const ConsistentModel::Link& link, IdentifiedNumber& mass,
                 std::array<IdentifiedNumber, 3>& centre) {
    const Index joint = joint_of_column(link.first + 4);
    const auto row = [&](Index number) {
      return VectorXd(slopes_.row(link.first + number).transpose());
    };
    mass.name = "mass";
    mass.unit = "kg";
    mass.before = before[0];
    mass.after = after[0];
    tell(mass, row(0), joint);
    constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto number = static_cast<Index>(axis) + 1;
      centre[axis].name = kAxes[axis];
      centre[axis].unit = "m";
      centre[axis].before = before[number] / before[0];
      centre[axis].after = after[number] / after[0];
      tell(centre[axis], (row(number) - centre[axis].after * row(0)) / after[0], joint);
    }
  }

  void tell_link(std::size_t i) {
    const ConsistentModel::Link& link = fit_.model().links[i];
    IdentifiedLink& told = result_.links[i];
    told.link = link.link;
    InertialNumbers before = InertialNumbers::Constant(kNaN);
    if (has_numbers(fit_.file(), link.link)) {
      before = inertial_numbers_of(fit_.file().joints[link.link].joint);
    }
    tell_body(before, inertial_numbers_of(result_.robot.joints[link.link].joint), link, told.mass,
              told.centre);
  }

  void tell_payload() {
    const ConsistentModel::Link& link = fit_.model().links[0];
    result_.payload = IdentifiedPayload{};
    const InertialNumbers carried = inertial_numbers_of(result_.robot.joints[link.link].joint) -
                                    inertial_numbers_of(fit_.file().joints[link.link].joint);
    tell_body(InertialNumbers::Constant(kNaN), carried, link, result_.payload->mass,
              result_.payload->place);
  }

  void tell_drives() {
    const Data& data = fit_.data();
    std::vector<std::pair<IdentifiedDrive, Index>> found;  // and its column
    for (std::size_t i = 0; i < fit_.design().kept.size(); ++i) {
      const NuisanceTerm& term =
          data.nuisance.terms[static_cast<std::size_t>(fit_.design().kept[i])];
      if (term.kind != NuisanceTerm::Kind::kKnownEffect) continue;
      const RobotEffect& effect = fit_.file().effects[term.effect];
      found.emplace_back(drive_of(effect.kind, term.parameter, effect.joint), i);
      IdentifiedNumber& number = found.back().first.number;
      number.before = effect.parameters[term.parameter];
      number.after = result_.robot.effects[term.effect].parameters[term.parameter];
    }
    std::size_t at = fit_.file().effects.size();  // new effects follow the file's
    const ModelFit model = fit_.model_fit();
    for (std::size_t i = 0; i < fit_.terms().size(); ++i) {
      const Term& term = fit_.terms()[i];
      const std::size_t parameter = parameter_of_coefficient(*term.effect, 0);
      found.emplace_back(
          drive_of(term.effect->kind(), parameter, static_cast<std::size_t>(term.joint)),
          fit_.design().first[i]);
      IdentifiedDrive& drive = found.back().first;
      drive.written = !is_nothing(term, model.coefficients[i]);
      if (drive.written) drive.number.after = result_.robot.effects[at++].parameters[parameter];
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first.joint < b.first.joint; });
    for (auto& [drive, column] : found) result_.drives.push_back(std::move(drive));
    for (std::size_t i = 0; i < found.size(); ++i) {
      IdentifiedDrive& drive = result_.drives[i];
      const Index unknown = unknown_of_column(found[i].second);
      tell(drive.number, VectorXd::Unit(unknowns(), unknown), static_cast<Index>(drive.joint));
      drive.number.determined = !priors_[static_cast<std::size_t>(unknown)].is_held();
    }
  }

  [[nodiscard]] IdentifiedDrive drive_of(EffectKind kind, std::size_t parameter,
                                         std::size_t joint) const {
    const EffectInfo& info = *info_of(kind);
    IdentifiedDrive drive{joint, kind, {}};
    drive.number.name = std::string(info.name) + "." + info.parameters[parameter].name;
    drive.number.unit =
        unit_of(info.parameters[parameter].quantity, fit_.file().joints[joint].joint.type);
    return drive;
  }

  // The column of the design of a number of the base; -1: no number of the fit.
  [[nodiscard]] Index column_of_number(Index number) const {
    const auto of_links = first_linear();
    if (number < of_links) {
      return fit_.model().links[static_cast<std::size_t>(number / kInertialNumbers)].first +
             number % kInertialNumbers;
    }
    const std::size_t joint =
        fit_.base_request().rotors[static_cast<std::size_t>(number - of_links)];
    for (std::size_t i = 0; i < fit_.design().kept.size(); ++i) {
      const NuisanceTerm& term =
          fit_.data().nuisance.terms[static_cast<std::size_t>(fit_.design().kept[i])];
      if (term.kind == NuisanceTerm::Kind::kKnownEffect &&
          fit_.file().effects[term.effect].kind == EffectKind::kRotorInertia &&
          !fit_.file().effects[term.effect].of_motor &&
          fit_.file().effects[term.effect].joint == joint) {
        return static_cast<Index>(i);
      }
    }
    for (std::size_t i = 0; i < fit_.terms().size(); ++i) {
      const Term& term = fit_.terms()[i];
      if (term.effect->kind() == EffectKind::kRotorInertia &&
          static_cast<std::size_t>(term.joint) == joint) {
        return fit_.design().first[i];
      }
    }
    return -1;
  }

  [[nodiscard]] double value_of(const RobotDescription& robot, Index number) const {
    const Index of_links = first_linear();
    if (number >= of_links) {
      return rotor_of(robot,
                      fit_.base_request().rotors[static_cast<std::size_t>(number - of_links)]);
    }
    const std::size_t link =
        fit_.model().links[static_cast<std::size_t>(number / kInertialNumbers)].link;
    if (&robot == &fit_.file() && !has_numbers(fit_.file(), link)) return kNaN;
    return inertial_numbers_of(robot.joints[link].joint)[number % kInertialNumbers];
  }

  void tell_base(Index row) {
    IdentifiedNumber& told = result_.base[static_cast<std::size_t>(row)];
    told.name = base_.names[static_cast<std::size_t>(row)];
    told.unit = base_.units[static_cast<std::size_t>(row)];
    told.before = 0;
    VectorXd of_unknowns = VectorXd::Zero(unknowns());
    for (Index number = 0; number < base_.combinations.cols(); ++number) {
      const double factor = base_.combinations(row, number);
      if (factor == 0) continue;
      told.before += factor * value_of(fit_.file(), number);
      told.after += factor * value_of(result_.robot, number);
      const Index column = column_of_number(number);
      if (column >= 0) of_unknowns += factor * slopes_.row(column).transpose();
    }
    const Index column = column_of_number(base_.leading[static_cast<std::size_t>(row)]);
    tell(told, std::move(of_unknowns), column >= 0 ? joint_of_column(column) : 0);
  }

  void estimate() {
    const auto& moves = fit_.base_request().moves;
    if (std::find(moves.begin(), moves.end(), char{1}) == moves.end()) {
      for (const Told& one : told_) one.number->why_no_interval = "no interval: nothing moves";
      return;
    }
    LinearModel model;
    model.priors = priors_;
    const MatrixXd columns = fit_.columns() * slopes_;
    for (Index i = 0; i < columns.cols(); ++i) model.columns.emplace_back(columns.col(i));
    const ModelFit fitted = fit_.model_fit();
    for (const Index joint : fit_.widths()) {
      model.columns.push_back(
          width_derivative(fit_.data(), fit_.made_with(), fit_.terms(), fitted, joint));
      model.priors.emplace_back();
    }
    std::vector<Combination> combinations;
    for (const Told& one : told_) {
      VectorXd whole = VectorXd::Zero(static_cast<Index>(model.columns.size()));
      whole.head(one.of_unknowns.size()) = one.of_unknowns;
      combinations.push_back({one.number->after, std::move(whole), one.joint});
    }
    const std::vector<Estimate> estimates = estimates_of(fit_.data(), fitted, model, combinations);
    for (std::size_t i = 0; i < told_.size(); ++i) {
      told_[i].number->ci95 = estimates[i].ci95;
      told_[i].number->why_no_interval = estimates[i].why_no_interval;
    }
    leave_open_what_no_motion_tells();
  }

  // How wide a rotor's interval is that no motion tells from its link says how far the link is
  // believed, and nothing of the recordings.
  void leave_open_what_no_motion_tells() {
    const auto& untold = fit_.untold_rotors();
    for (IdentifiedDrive& drive : result_.drives) {
      if (drive.kind != EffectKind::kRotorInertia) continue;
      if (std::find(untold.begin(), untold.end(), drive.joint) == untold.end()) continue;
      drive.number.determined = false;
      drive.number.ci95.reset();
      drive.number.why_no_interval = "as far as the link is believed";
    }
  }

  // Of what torques depend on, columns of length 1.
  [[nodiscard]] double condition() const {
    std::vector<Index> chosen;
    for (const Index leading : base_.leading) {
      const Index column = column_of_number(leading);
      if (column >= 0) chosen.push_back(column);
    }
    for (std::size_t i = 0; i < fit_.terms().size(); ++i) {
      if (fit_.terms()[i].effect->kind() == EffectKind::kRotorInertia) continue;
      chosen.push_back(fit_.design().first[i]);
    }
    MatrixXd columns = equations_.columns(Eigen::all, chosen);
    for (Index i = 0; i < columns.cols(); ++i) {
      const double length = columns.col(i).norm();
      if (length > 0) columns.col(i) /= length;
    }
    if (columns.cols() == 0) return kNaN;
    const VectorXd sizes = Eigen::JacobiSVD<MatrixXd>(columns).singularValues();
    const double least = sizes[sizes.size() - 1];
    if (columns.rows() < columns.cols() || !(least > 0)) {
      return std::numeric_limits<double>::infinity();
    }
    return sizes[0] / least;
  }

  const InertialFit& fit_;
  const IdentifyRequest& request_;
  Identification& result_;
  BaseParameters base_;
  MatrixXd slopes_;            // columns of the design to unknowns
  std::vector<Prior> priors_;  // of the unknowns
  ReducedRows::Equations equations_;
  VectorXd before_;  // variance of each unknown with nothing but the geometry
  MatrixXd after_;   // covariance with the recordings
  std::vector<Told> told_;
};

}  // namespace

void put_numbers(const InertialFit& fit, const IdentifyRequest& request, Identification& result) {
  FittedNumbers(fit, request, result).put();
}

}  // namespace offnominal::desk
