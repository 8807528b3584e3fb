#include <gtest/gtest.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <kdl/tree.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>

#include "exchange/import_urdf.hpp"
#include "rigid_torque.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"
#include "urdfs.hpp"

// The imported chain against Orocos KDL's tree of the same file: every link of it, with its own
// inertia where it stands, and the joints beside the chain at rest where the import says it holds
// them.

namespace offnominal::test {
namespace {

KDL::Vector to_kdl(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

KDL::Frame to_kdl(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {KDL::Rotation::Quaternion(r.x, r.y, r.z, r.w), to_kdl(pose.position)};
}

KDL::RigidBodyInertia inertia_of(const urdf::Link& link) {
  if (link.inertial == nullptr) return KDL::RigidBodyInertia();
  const urdf::Inertial& given = *link.inertial;
  const KDL::RotationalInertia about_centre(given.ixx, given.iyy, given.izz, given.ixy, given.ixz,
                                            given.iyz);
  return to_kdl(given.origin) *
         KDL::RigidBodyInertia(given.mass, KDL::Vector::Zero(), about_centre);
}

KDL::Segment segment_of(const urdf::Link& link) {
  const urdf::Joint& joint = *link.parent_joint;
  const KDL::Frame place = to_kdl(joint.parent_to_joint_origin_transform);
  KDL::Joint moving(joint.name, KDL::Joint::None);
  const KDL::Vector axis = place.M * to_kdl(joint.axis);
  if (joint.type == urdf::Joint::PRISMATIC) {
    moving = KDL::Joint(joint.name, place.p, axis, KDL::Joint::TransAxis);
  } else if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS) {
    moving = KDL::Joint(joint.name, place.p, axis, KDL::Joint::RotAxis);
  }
  return KDL::Segment(link.name, moving, place, inertia_of(link));
}

KDL::Tree tree_below(const urdf::Link& base) {
  KDL::Tree tree(base.name);
  std::vector<const urdf::Link*> links{&base};
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (const auto& child : links[i]->child_links) {
      EXPECT_TRUE(tree.addSegment(segment_of(*child), links[i]->name)) << child->name;
      links.push_back(child.get());
    }
  }
  return tree;
}

class UrdfAgainstKdl : public testing::TestWithParam<UrdfCase> {};

TEST_P(UrdfAgainstKdl, GivesTheSameTorques) {
  const UrdfCase& of = GetParam();
  OFFNOMINAL_SKIP_WITHOUT(of);
  const auto imported = desk::exchange::import_urdf(of.text(), of.file.string(), of.chain());
  const auto rigid = without(imported.robot, [](const auto&) { return true; });
  ASSERT_EQ(rigid.joint_count(), of.joints);

  const auto model = urdf::parseURDFFile(of.file.string());
  ASSERT_NE(model, nullptr);
  const KDL::Tree tree = tree_below(*model->getLink(of.base));
  const auto& gravity = rigid.gravity_m_s2;
  KDL::TreeIdSolver_RNE newton_euler(tree, {gravity[0], gravity[1], gravity[2]});
  const unsigned count = tree.getNrOfJoints();
  KDL::JntArray q(count), dq(count), ddq(count), torque(count);
  for (const auto& [name, joint] : model->joints_) {
    // What the import says that it holds elsewhere than at 0.
    const auto segment = tree.getSegments().find(joint->child_link_name);
    if (segment == tree.getSegments().end() || joint->type != urdf::Joint::PRISMATIC) continue;
    q(segment->second.q_nr) = std::clamp(0.0, joint->limits->lower, joint->limits->upper);
  }
  std::mt19937_64 generator = seeded_generator();
  double worst = 0;
  for (int i = 0; i < repetitions(1000); ++i) {
    const MotionState state = random_state(generator, of.joints);
    std::vector<unsigned> place;
    for (std::size_t j = 0; j < imported.links.size(); ++j) {
      place.push_back(tree.getSegment(imported.links[j])->second.q_nr);
      q(place[j]) = state.q[j];
      dq(place[j]) = state.dq[j];
      ddq(place[j]) = state.ddq[j];
    }
    ASSERT_EQ(newton_euler.CartToJnt(q, dq, ddq, {}, torque), 0);
    std::vector<double> theirs;
    for (const unsigned at : place) theirs.push_back(torque(at));
    worst = std::max(worst, deviation(torque_of(rigid, state), theirs));
  }
  EXPECT_LE(worst, 1e-9);
  std::cout << "largest deviation: " << worst << '\n';
}

INSTANTIATE_TEST_SUITE_P(All, UrdfAgainstKdl, testing::ValuesIn(all_urdfs()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace offnominal::test
